// A triangle surface: what is drawn, what bounds a volume, what is embedded in one.
#pragma once

#include <array>
#include <corotet/detail/core/types.hpp>
#include <string>
#include <vector>

namespace corotet::inline v0_1 {

/// Triangles over shared vertices, counter-clockwise seen from outside. In double, like MeshData.
struct SurfaceMesh {
  std::vector<Vec3<double>> positions;          ///< m
  std::vector<std::array<Index, 3>> triangles;  ///< 0-based vertex indices
  std::vector<Vec3<double>> normals;            ///< unit, one a vertex; empty where the source has none

  /// What the reader changed or left out, in words: "split 96 quadrilaterals", "ignored texture coordinates".
  std::vector<std::string> notes;
};

}  // namespace corotet::inline v0_1
