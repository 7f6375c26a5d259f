// Converting between 4-node and 10-node meshes, and dropping vertices that no element uses.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// The same straight-sided mesh with a vertex added in the middle of each edge. Corner vertices keep their indices; the
/// new ones follow, ordered by their edges. Indices must be in range (TetMesh::create checks). A 10-node mesh is
/// returned as it is.
[[nodiscard]] COROTET_COLD inline MeshData raise_order(MeshData mesh) {
  if (mesh.nodes_per_element != 4) return mesh;
  const auto elements = static_cast<std::size_t>(mesh.element_count());
  std::vector<Index> connectivity(elements * 10);
  // The uses of edges as lists, one for each vertex that is the lesser end: the other end, and where in the new
  // connectivity the mid-edge vertex goes.
  constexpr Index none = -1;
  std::vector<Index> first(mesh.positions.size(), none), next, other, slot;
  for (std::size_t e = elements; e-- > 0;) {
    const Index* corners = mesh.connectivity.data() + 4 * e;
    for (std::size_t c = 0; c < 4; ++c) connectivity[10 * e + c] = corners[c];
    for (std::size_t k = 6; k-- > 0;) {
      const Index a = corners[tet_edges[k].a], b = corners[tet_edges[k].b];
      next.push_back(std::exchange(first[at(a < b ? a : b)], size_of(next)));
      other.push_back(a < b ? b : a);
      slot.push_back(static_cast<Index>(10 * e + 4 + k));
    }
  }
  std::vector<Index> ends;
  for (Index v = 0; v < size_of(first); ++v) {
    ends.clear();
    for (Index use = first[at(v)]; use != none; use = next[at(use)]) ends.push_back(other[at(use)]);
    detail::sort_and_unite(ends);
    const Index begin = mesh.vertex_count();
    for (const Index end : ends) mesh.positions.push_back((mesh.positions[at(v)] + mesh.positions[at(end)]) / 2);
    for (Index use = first[at(v)]; use != none; use = next[at(use)])
      connectivity[at(slot[at(use)])] =
          begin + static_cast<Index>(std::lower_bound(ends.begin(), ends.end(), other[at(use)]) - ends.begin());
  }
  mesh.connectivity = std::move(connectivity);
  mesh.nodes_per_element = 10;
  return mesh;
}

/// Drops the vertices that no element uses and renumbers the rest in order; says so in `notes`. Indices out of range
/// are left for TetMesh::create to report.
[[nodiscard]] COROTET_COLD inline MeshData remove_unreferenced(MeshData mesh) {
  constexpr Index unused = -1;
  std::vector<Index> renumbered(mesh.positions.size(), unused);
  const auto in_range = [&](Index v) { return v >= 0 && v < mesh.vertex_count(); };
  for (const Index v : mesh.connectivity) {
    if (!in_range(v)) return mesh;
    renumbered[at(v)] = 0;
  }
  Index kept = 0;
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == unused) continue;
    mesh.positions[at(kept)] = mesh.positions[v];
    renumbered[v] = kept++;
  }
  const Index dropped = mesh.vertex_count() - kept;
  if (dropped == 0) return mesh;
  mesh.positions.resize(at(kept));
  for (Index& v : mesh.connectivity) v = renumbered[at(v)];
  mesh.notes.push_back("dropped " + std::to_string(dropped) + " vertices that belong to no element");
  return mesh;
}

/// The same mesh without its mid-edge vertices: curved edges become straight. A 4-node mesh is returned as it is.
[[nodiscard]] COROTET_COLD inline MeshData lower_order(MeshData mesh) {
  if (mesh.nodes_per_element != 10) return mesh;
  std::vector<Index> corners;
  corners.reserve(mesh.connectivity.size() / 10 * 4);
  for (std::size_t first = 0; first + 10 <= mesh.connectivity.size(); first += 10)
    for (std::size_t c = 0; c < 4; ++c) corners.push_back(mesh.connectivity[first + c]);
  mesh.connectivity = std::move(corners);
  mesh.nodes_per_element = 4;
  return remove_unreferenced(std::move(mesh));
}

}  // namespace corotet::inline v0_1
