// The least that code on unchecked MeshData needs before it may follow an index.
#pragma once

#include <corotet/core/result.hpp>
#include <corotet/core/types.hpp>
#include <corotet/mesh/mesh_data.hpp>
#include <string>

namespace corotet::detail {

/// Whole elements of 4 or 10 nodes, and indices in range. Weaker than TetMesh::create, so that a mesh which that
/// refuses can still be measured and drawn.
inline Status check_connectivity(const MeshData& mesh) {
  const int nodes = mesh.nodes_per_element;
  if (nodes != 4 && nodes != 10)
    return Error{ErrorCode::invalid_argument, "mesh",
                 "its elements have " + std::to_string(nodes) + " nodes, only 4 and 10 are known"};
  if (mesh.connectivity.size() % at(nodes) != 0) {
    return Error{ErrorCode::invalid_argument, "mesh",
                 "connectivity has " + std::to_string(mesh.connectivity.size()) + " entries, not a multiple of " +
                     std::to_string(nodes)};
  }
  for (std::size_t i = 0; i < mesh.connectivity.size(); ++i) {
    const Index v = mesh.connectivity[i];
    if (v < 0 || at(v) >= mesh.positions.size()) {
      return Error{ErrorCode::index_out_of_range, "element " + std::to_string(i / at(nodes)),
                   "it names vertex " + std::to_string(v) + ", but the mesh has " +
                       std::to_string(mesh.positions.size()) + " vertices"};
    }
  }
  return {};
}

}  // namespace corotet::detail
