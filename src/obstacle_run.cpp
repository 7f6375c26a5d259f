#include "obstacle_run.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <filesystem>
#include <type_traits>
#include <utility>
#include <variant>

#include "obstacle_surface.hpp"
#include "problems.hpp"

namespace corotet::program {

namespace fs = std::filesystem;

ObstacleRun::ObstacleRun(const Scene& scene) : entries_(scene.obstacles), meshes_(entries_.size()) {
  Problems problems(scene.file.string());
  obstacles_.gravity = scene.gravity;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    ObstacleOptions options = entries_[i].options;
    options.pose.position += displacement_at(entries_[i].path, 0);
    std::visit(
        [&](const auto& shape) {
          if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, fs::path>)
            problems.add(fmt::format("obstacles[{}].mesh", i), "mesh obstacles are not in this version");
          else
            obstacles_.add(shape, options);
        },
        entries_[i].shape);
  }
  problems.stop_if_any();
}

void ObstacleRun::begin_step(double t, double h) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const ObstacleEntry& entry = entries_[i];
    if (entry.path.empty()) continue;
    Obstacle& obstacle = obstacles_[static_cast<Index>(i)];
    obstacle.velocity = (entry.options.pose.position + displacement_at(entry.path, t) - obstacle.pose().position) / h;
  }
  obstacles_.begin_step(h);
}

ObstacleRun::Drawing ObstacleRun::draw(const Vec3<double>& centre, double size) const {
  Drawing drawing;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Obstacle& obstacle = obstacles_[static_cast<Index>(i)];
    const SurfaceMesh part = std::visit(
        [&](const auto& shape) -> SurfaceMesh {
          using Shape = std::decay_t<decltype(shape)>;
          if constexpr (std::is_same_v<Shape, fs::path>)
            return meshes_[i];
          else if constexpr (std::is_same_v<Shape, HalfSpace>)
            return surface_of(shape, obstacle.to_frame(centre - obstacle.pose().position), size);
          else
            return surface_of(shape);
        },
        entries_[i].shape);
    const Index first = size_of(drawing.surface.positions);
    for (const Vec3<double>& x : part.positions)
      drawing.surface.positions.push_back(obstacle.pose().position + obstacle.to_world(x));
    for (const auto& [a, b, c] : part.triangles) {
      drawing.surface.triangles.push_back({first + a, first + b, first + c});
      drawing.obstacle.push_back(static_cast<Index>(i));
    }
  }
  return drawing;
}

}  // namespace corotet::program
