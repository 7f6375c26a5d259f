// A mesh in elements half as large.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <cstddef>
#include <utility>

namespace corotet::program {

/// Splits each straight tetrahedron of a 4-node mesh at the middles of its edges into eight: four at its corners and
/// four around the shortest diagonal of the octahedron between them (Bey 1995, "Tetrahedral grid refinement"; he picks
/// the diagonal by number, the shortest keeps the shapes at least as good). Regions are inherited, eight times each.
[[nodiscard]] inline MeshData refine_red(MeshData mesh) {
  const std::vector<int> regions = std::exchange(mesh.regions, {});
  mesh = raise_order(lower_order(std::move(mesh)));
  std::vector<Index> connectivity;
  connectivity.reserve(mesh.connectivity.size() / 10 * 32);
  for (std::size_t first = 0; first + 10 <= mesh.connectivity.size(); first += 10) {
    const Index* node = mesh.connectivity.data() + first;
    const auto middle = [&](std::size_t a, std::size_t b) {
      for (std::size_t k = 0; k < tet_edges.size(); ++k)
        if ((tet_edges[k].a == a && tet_edges[k].b == b) || (tet_edges[k].a == b && tet_edges[k].b == a))
          return node[4 + k];
      return Index{-1};
    };
    const auto add = [&](Index a, Index b, Index c, Index d) { connectivity.insert(connectivity.end(), {a, b, c, d}); };
    const auto length2 = [&](Index a, Index b) {
      return (mesh.positions[at(a)] - mesh.positions[at(b)]).squaredNorm();
    };
    for (std::size_t a = 0; a < 4; ++a) {  // each corner keeps its place in the order, and with it the winding
      std::array<Index, 4> corner{};
      for (std::size_t b = 0; b < 4; ++b) corner[b] = a == b ? node[a] : middle(a, b);
      add(corner[0], corner[1], corner[2], corner[3]);
    }
    // The octahedron's diagonals join the middles of opposite edges; the other four middles go around each in a ring.
    constexpr std::array<std::array<std::size_t, 4>, 3> diagonals{{{0, 2, 1, 3}, {0, 1, 2, 3}, {0, 3, 1, 2}}};
    std::size_t shortest = 0;
    const auto end = [&](std::size_t r, std::size_t k) { return middle(diagonals[r][2 * k], diagonals[r][2 * k + 1]); };
    for (std::size_t r = 1; r < 3; ++r)
      if (length2(end(r, 0), end(r, 1)) < length2(end(shortest, 0), end(shortest, 1))) shortest = r;
    std::array<Index, 4> ring{};
    std::size_t filled = 0;
    for (std::size_t r = 0; r < 3; ++r)
      if (r != shortest) {
        ring[filled] = end(r, 0);
        ring[filled + 2] = end(r, 1);
        ++filled;
      }
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<Index, 4> tet{end(shortest, 0), end(shortest, 1), ring[k], ring[(k + 1) % 4]};
      const auto x = [&](std::size_t i) { return mesh.positions[at(tet[i])]; };
      const auto volume = [&](auto&& p) { return (p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0)); };
      const auto parent = [&](std::size_t i) { return mesh.positions[at(node[i])]; };
      if (volume(x) * volume(parent) < 0) std::swap(tet[2], tet[3]);
      add(tet[0], tet[1], tet[2], tet[3]);
    }
  }
  mesh.connectivity = std::move(connectivity);
  mesh.nodes_per_element = 4;
  for (const int region : regions) mesh.regions.insert(mesh.regions.end(), 8, region);
  return mesh;
}

}  // namespace corotet::program
