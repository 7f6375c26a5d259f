// What a mesh lost of the surface that it was made from: thin parts, pieces, tunnels.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/closest_point.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Topology of a triangle surface. For closed surfaces without self-contact: euler = 2 (components - tunnels).
struct SurfaceTopology {
  Index components = 0;  ///< connected over edges and vertices
  Index euler = 0;       ///< vertices - edges + triangles, of vertices in use

  bool operator==(const SurfaceTopology&) const = default;
};

/// Indices must be in range; `vertex_count` is the length of the array that they point into.
[[nodiscard]] inline SurfaceTopology surface_topology(const std::vector<std::array<Index, 3>>& triangles,
                                                      std::size_t vertex_count) {
  std::vector<Index> parent(vertex_count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index v) {
    while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];  // halve the path
    return v;
  };
  std::vector<bool> used(vertex_count, false);
  std::vector<std::pair<Index, Index>> edges;
  edges.reserve(3 * triangles.size());
  for (const std::array<Index, 3>& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
      edges.emplace_back(low, high);
      used[at(t[i])] = true;
      const Index a = root(low), b = root(high);
      parent[at((std::max)(a, b))] = (std::min)(a, b);
    }
  std::sort(edges.begin(), edges.end());
  const auto edge_count = std::unique(edges.begin(), edges.end()) - edges.begin();
  SurfaceTopology out;
  Index vertices = 0;
  for (Index v = 0; v < static_cast<Index>(vertex_count); ++v) {
    if (!used[at(v)]) continue;
    ++vertices;
    if (root(v) == v) ++out.components;
  }
  out.euler = vertices - static_cast<Index>(edge_count) + size_of(triangles);
  return out;
}

/// Adds notes about what the mesh of `surface`, made with lattice cubes of `size` (m), lost.
inline Result<void> note_perforation(MeshData& mesh, const SurfaceMesh& surface, double size) {
  const Result<BoundarySurface> boundary = extract_boundary(mesh);
  if (!boundary) return boundary.error();
  const SurfaceTopology want = surface_topology(surface.triangles, surface.positions.size());
  const SurfaceTopology have = surface_topology(boundary->triangles, mesh.positions.size());
  if (want != have)
    mesh.notes.push_back("perforated: the surface has " + std::to_string(want.components) +
                         " pieces and Euler number " + std::to_string(want.euler) + ", the mesh's boundary " +
                         std::to_string(have.components) + " and " + std::to_string(have.euler) +
                         "; smaller cubes keep thin parts");

  std::vector<Box> boxes;
  for (const std::array<Index, 3>& t : boundary->triangles) {
    Box& box = boxes.emplace_back();
    for (const Index v : t) box.add(mesh.positions[at(v)]);
  }
  const BoxTree tree(boxes);
  std::vector<bool> used(surface.positions.size(), false);
  for (const std::array<Index, 3>& t : surface.triangles)
    for (const Index v : t) used[at(v)] = true;
  Index lost = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const NearestPrimitive nearest = tree.nearest(surface.positions[v], [&](Index i) {
      const auto& [a, b, c] = boundary->triangles[at(i)];
      return closest_on_triangle(mesh.positions[at(a)], mesh.positions[at(b)], mesh.positions[at(c)],
                                 surface.positions[v])
          .squared_distance;
    });
    if (nearest.squared_distance > size * size) ++lost;
  }
  if (lost > 0)
    mesh.notes.push_back(std::to_string(lost) + " of " + std::to_string(surface.positions.size()) +
                         " surface vertices lie farther than a lattice cube from the mesh: parts of it are too thin");
  return {};
}

}  // namespace corotet::inline v0_1::detail
