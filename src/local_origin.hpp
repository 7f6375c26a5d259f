// Where the coordinates of a body begin, so that float keeps its digits.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <type_traits>

namespace corotet::program {

/// The least and the greatest coordinates of a mesh with at least one vertex, m.
struct Bounds {
  Vec3<double> least, most;

  [[nodiscard]] static Bounds of(const MeshData& mesh) {
    Bounds box{mesh.positions.front(), mesh.positions.front()};
    for (const Vec3<double>& x : mesh.positions) {
      box.least = box.least.cwiseMin(x);
      box.most = box.most.cwiseMax(x);
    }
    return box;
  }
};

/// The origin for TetMesh::create: the centre of a mesh that lies farther from 0 than it is large, if it is kept in
/// float; otherwise 0, and then positions are the file's own.
template <class Scalar>
[[nodiscard]] Vec3<double> local_origin(const MeshData& mesh) {
  if (!std::is_same_v<Scalar, float> || mesh.positions.empty()) return Vec3<double>::Zero();
  const auto [least, most] = Bounds::of(mesh);
  Vec3<double> centre = least + (most - least) / 2;
  if (centre.allFinite() && centre.norm() > (most - least).norm()) return centre;
  return Vec3<double>::Zero();
}

}  // namespace corotet::program
