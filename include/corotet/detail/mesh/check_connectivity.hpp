// The least that code on unchecked meshes and surfaces needs before it may follow an index or compute with a position.
#pragma once

#include <corotet/detail/core/number_text.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstddef>
#include <span>
#include <string>

namespace corotet::inline v0_1::detail {

/// Whole elements of 4 or 10 nodes, and indices in range. Weaker than TetMesh::create, so that a mesh which that
/// refuses can still be measured and drawn.
inline Result<void> check_connectivity(const MeshData& mesh) {
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

/// Indices in range.
inline Result<void> check_triangles(const SurfaceMesh& surface) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const Index v : surface.triangles[t])
      if (v < 0 || v >= size_of(surface.positions))
        return Error{ErrorCode::index_out_of_range, "triangle " + std::to_string(t),
                     "it names vertex " + std::to_string(v) + " of " + std::to_string(surface.positions.size())};
  return {};
}

/// m. Cubes of differences, which are volumes, stay within double's range.
inline constexpr double max_coordinate = 1e100;

/// Finite positions no farther out than `largest` along any axis; an error names the vertex as `name` and its number.
inline Result<void> check_positions(std::span<const Vec3<double>> positions, const char* name,
                                    double largest = max_coordinate) {
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!positions[v].allFinite() || positions[v].cwiseAbs().maxCoeff() > largest)
      return Error{ErrorCode::non_finite_value, std::string(name) + " " + std::to_string(v),
                   "its position is not a finite number of magnitude " + number_text(largest) + " at most"};
  return {};
}

}  // namespace corotet::inline v0_1::detail
