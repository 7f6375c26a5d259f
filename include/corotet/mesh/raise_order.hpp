// Converting between 4-node and 10-node meshes, and dropping vertices that no element uses.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>
#include <corotet/element/reference_element.hpp>
#include <corotet/mesh/mesh_data.hpp>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// The same straight-sided mesh with a vertex added in the middle of each edge. Corner vertices keep their indices; the
/// new ones follow, ordered by their edges. Indices must be in range (TetMesh::create checks). A 10-node mesh is
/// returned as it is.
[[nodiscard]] COROTET_COLD inline MeshData raise_order(MeshData mesh) {
  if (mesh.nodes_per_element != 4) return mesh;
  struct EdgeUse {
    std::pair<Index, Index> ends;
    std::size_t slot;  // where in the new connectivity the mid-edge vertex goes
  };
  const auto elements = static_cast<std::size_t>(mesh.element_count());
  std::vector<Index> connectivity(elements * 10);
  std::vector<EdgeUse> uses;
  uses.reserve(elements * 6);
  for (std::size_t e = 0; e < elements; ++e) {
    const Index* corners = mesh.connectivity.data() + 4 * e;
    std::copy_n(corners, 4, connectivity.begin() + static_cast<std::ptrdiff_t>(10 * e));
    for (std::size_t k = 0; k < 6; ++k)
      uses.push_back({std::minmax(corners[tet_edges[k].a], corners[tet_edges[k].b]), 10 * e + 4 + k});
  }
  std::sort(uses.begin(), uses.end(),
            [](const EdgeUse& p, const EdgeUse& q) { return p.ends != q.ends ? p.ends < q.ends : p.slot < q.slot; });
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (i == 0 || uses[i].ends != uses[i - 1].ends)
      mesh.positions.push_back((mesh.positions[at(uses[i].ends.first)] + mesh.positions[at(uses[i].ends.second)]) / 2);
    connectivity[uses[i].slot] = mesh.vertex_count() - 1;
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
