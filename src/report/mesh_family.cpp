#include "mesh_family.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/raise_order.hpp>
#include <numeric>
#include <utility>

#include "../failure.hpp"
#include "../loads.hpp"
#include "../local_origin.hpp"
#include "red_refinement.hpp"

namespace corotet::program {
namespace {

double volume_of(const MeshData& mesh) {
  const std::vector<double> volumes = vertex_volumes(mesh);
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

void add_level(MeshFamily& family, std::string name, MeshData linear) {
  const double size = std::cbrt(volume_of(linear) / std::max<Index>(linear.element_count(), 1));
  family.levels.push_back({std::move(name), size, std::move(linear), {}});
}

std::string name_of(const std::array<Index, 3>& cells) { return fmt::format("{}x{}x{}", cells[0], cells[1], cells[2]); }

Index element_count(const BlockOptions& block) {
  return block.cells[0] * block.cells[1] * block.cells[2] * (block.split == BlockSplit::kuhn6 ? 6 : 5);
}

/// Whether a mid-edge vertex lies off the middle of its edge.
bool has_curved_edges(const MeshData& mesh) {
  if (mesh.nodes_per_element != 10) return false;
  for (std::size_t first = 0; first + 10 <= mesh.connectivity.size(); first += 10)
    for (std::size_t k = 0; k < 6; ++k) {
      const auto x = [&](std::size_t i) { return mesh.positions[at(mesh.connectivity[first + i])]; };
      const Vec3<double> a = x(tet_edges[k].a), b = x(tet_edges[k].b);
      if ((x(4 + k) - (a + b) / 2).norm() > 1e-6 * (a - b).norm()) return true;
    }
  return false;
}

}  // namespace

MeshData MeshFamily::mesh(int level, int order) const {
  MeshData mesh = (*this)[level].linear;
  return order == 2 ? raise_order(std::move(mesh)) : mesh;
}

MeshFamily make_family(const BlockOptions& block, const std::vector<std::array<Index, 3>>& cells) {
  MeshFamily family;
  for (const auto& count : cells) {
    BlockOptions options = block;
    options.cells = count;
    options.order = 1;
    add_level(family, name_of(count), require(make_block(options)));
    family.levels.back().cells = count;
  }
  return family;
}

std::optional<BlockOptions> find_grid(const MeshData& linear) {
  const auto [least, most] = Bounds::of(linear);
  BlockOptions block{.corner = least, .size = most - least};
  if (!(block.size.minCoeff() > 0)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> places;
    places.reserve(linear.positions.size());
    for (const Vec3<double>& x : linear.positions) places.push_back(x[axis]);
    std::sort(places.begin(), places.end());
    const double tolerance = 1e-6 * block.size[axis];
    const auto last =
        std::unique(places.begin(), places.end(), [&](double a, double b) { return std::abs(a - b) <= tolerance; });
    places.erase(last, places.end());
    const auto cells = static_cast<Index>(places.size()) - 1;
    for (Index i = 0; i <= cells; ++i)
      if (std::abs(places[at(i)] - (least[axis] + block.size[axis] * i / cells)) > 2 * tolerance) return std::nullopt;
    block.cells[at(axis)] = cells;
  }
  const auto [nx, ny, nz] = block.cells;
  if ((double{1} + nx) * (double{1} + ny) * (double{1} + nz) != double(linear.vertex_count())) return std::nullopt;
  if (std::abs(volume_of(linear) / (block.size.x() * block.size.y() * block.size.z()) - 1) > 1e-6) return std::nullopt;
  block.split = BlockSplit::kuhn6;
  if (linear.element_count() == element_count(block)) return block;
  block.split = BlockSplit::alternating5;
  return block;
}

MeshFamily make_family(const MeshData& mesh, Index max_elements) {
  MeshFamily family;
  MeshData linear = lower_order(mesh);
  if (const std::optional<BlockOptions> grid = find_grid(linear); grid && linear.regions.empty()) {
    // Halves and doubles of the number of cells; a grid that can be made no coarser is not listed twice.
    std::vector<std::array<Index, 3>> cells;
    for (const double factor : {0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0}) {
      BlockOptions scaled = *grid;
      for (Index& n : scaled.cells) n = std::max<Index>(1, static_cast<Index>(std::lround(n * factor)));
      if (factor < 1 && scaled.cells == grid->cells) continue;
      if (!cells.empty() && scaled.cells == cells.back()) continue;
      if (factor > 1 && element_count(scaled) > max_elements) break;
      if (factor == 1) family.own = size_of(cells);
      cells.push_back(scaled.cells);
    }
    const int own = family.own;
    family = make_family(*grid, cells);
    family.own = own;
    family.levels[at(own)].linear = std::move(linear);  // the very mesh, in its own order
    return family;
  }
  if (has_curved_edges(mesh)) family.notes = "edges of the mesh are curved: the study takes them as straight";
  add_level(family, "mesh", std::move(linear));
  for (int halvings = 2; family.levels.back().linear.element_count() <= max_elements / 8; halvings *= 2)
    add_level(family, fmt::format("mesh/{}", halvings), refine_red(family.levels.back().linear));
  return family;
}

}  // namespace corotet::program
