// The obstacles of a scene while it runs.
#pragma once

#include <corotet/detail/contact/mesh_collider.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "contact_scene.hpp"
#include "problems.hpp"
#include "scene.hpp"

namespace corotet::program {

/// Obstacles that are led along their paths, or move freely.
class ObstacleRun {
 public:
  /// Those of the scene at time 0. Throws a Failure that names each mesh that encloses no solid.
  explicit ObstacleRun(const Scene& scene);
  ObstacleRun(const ObstacleRun&) = delete;
  ObstacleRun& operator=(const ObstacleRun&) = delete;
  ~ObstacleRun() = default;

  /// For the bodies, which refer to them.
  [[nodiscard]] Obstacles& obstacles() { return obstacles_; }
  [[nodiscard]] const Obstacles& obstacles() const { return obstacles_; }

  /// What was changed or left out while meshes were read.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  /// Where obstacle number i is: the pose of the frame in which the scene gives its shape.
  [[nodiscard]] Pose pose(Index i) const;

  /// Before the bodies' step of h s that ends at time t, s: gives those with a path their velocities, and lets gravity
  /// pull at the free ones.
  void begin_step(double t, double h);
  /// After it: moves all.
  void advance(double h) { obstacles_.advance(h); }

  /// Their surfaces as they are now, and of each triangle the number of its obstacle. A half-space is drawn as a square
  /// of its plane below `centre` with edges of 2 `size`, m.
  struct Drawing {
    SurfaceMesh surface;
    std::vector<Index> obstacle;
  };
  [[nodiscard]] Drawing draw(const Vec3<double>& centre, double size) const;

 private:
  /// A mesh as it is drawn, in the frame of its file.
  struct MeshShape {
    SurfaceMesh surface;
    MeshCollider collider;
  };
  /// Nothing, after noting a problem, for a file that holds no solid.
  [[nodiscard]] std::optional<MeshShape> read_mesh_shape(std::size_t entry, Problems& problems);

  std::vector<ObstacleEntry> entries_;
  std::vector<std::optional<MeshShape>> meshes_;  // one an obstacle, if its shape is a mesh
  std::vector<std::string> notes_;
  Obstacles obstacles_;
};

}  // namespace corotet::program
