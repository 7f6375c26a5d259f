// A mesh as it comes from a file, a mesher or a program: unchecked arrays. TetMesh::create checks it.
#pragma once

#include <concepts>
#include <corotet/detail/core/types.hpp>
#include <string>
#include <vector>

namespace corotet::inline v0_1 {

/// The position nearest to `x`, the first of equals. Looks at each.
template <std::floating_point Scalar>
[[nodiscard]] Index nearest_position(const std::vector<Vec3<Scalar>>& positions, const Vec3<Scalar>& x) {
  Index nearest = 0;
  for (Index v = 1; v < size_of(positions); ++v)
    if ((positions[at(v)] - x).squaredNorm() < (positions[at(nearest)] - x).squaredNorm()) nearest = v;
  return nearest;
}

/// Vertices and elements before validation, always in double: a reader does not know in which precision the mesh will
/// be used.
struct MeshData {
  std::vector<Vec3<double>> positions;  ///< rest positions, m
  std::vector<Index>
      connectivity;           ///< `nodes_per_element` 0-based vertex indices for each element, in Tet4/Tet10 order
  int nodes_per_element = 4;  ///< 4 or 10
  std::vector<int> regions;   ///< one tag an element (physical group, attribute, material set), or empty

  /// What the reader changed or left out, in words: "ignored 312 triangles", "vertex numbers start at 1".
  std::vector<std::string> notes;

  /// Number of positions.
  [[nodiscard]] Index vertex_count() const { return size_of(positions); }
  /// Number of elements.
  [[nodiscard]] Index element_count() const { return size_of(connectivity) / nodes_per_element; }
};

}  // namespace corotet::inline v0_1
