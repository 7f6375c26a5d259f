// The obstacles of a scene while it runs.
#pragma once

#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <vector>

#include "contact_scene.hpp"
#include "scene.hpp"

namespace corotet::program {

/// Obstacles that are led along their paths, or move freely.
class ObstacleRun {
 public:
  /// Those of the scene at time 0. Throws a Failure that names each mesh that cannot be one.
  explicit ObstacleRun(const Scene& scene);
  ObstacleRun(const ObstacleRun&) = delete;
  ObstacleRun& operator=(const ObstacleRun&) = delete;
  ~ObstacleRun() = default;

  /// For the bodies, which refer to them.
  [[nodiscard]] Obstacles& obstacles() { return obstacles_; }
  [[nodiscard]] const Obstacles& obstacles() const { return obstacles_; }

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
  std::vector<ObstacleEntry> entries_;
  std::vector<SurfaceMesh> meshes_;  // one an obstacle, empty where its shape is no mesh
  Obstacles obstacles_;
};

}  // namespace corotet::program
