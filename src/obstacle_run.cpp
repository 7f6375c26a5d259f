#include "obstacle_run.hpp"

#include <fmt/core.h>

#include <corotet/detail/mesh/io/read_surface.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <cstddef>
#include <filesystem>
#include <type_traits>
#include <utility>
#include <variant>

#include "obstacle_surface.hpp"
#include "problems.hpp"

namespace corotet::program {

namespace fs = std::filesystem;

namespace {

/// Whether the moments of inertia of this mass, kg, are positive numbers in double.
template <class Shape>
bool has_moments(const Shape& shape, double mass) {
  if constexpr (requires { shape.inertia(); }) {
    const Vec3<double> moments = mass * shape.inertia();
    return moments.allFinite() && moments.minCoeff() > 0;
  } else {
    return false;
  }
}

}  // namespace

ObstacleRun::ObstacleRun(const Scene& scene) : entries_(scene.obstacles), meshes_(entries_.size()) {
  Problems problems(scene.file.string());
  obstacles_.gravity = scene.gravity;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    ObstacleOptions options = entries_[i].options;
    options.pose.position += displacement_at(entries_[i].path, 0);
    const auto add = [&](const auto& shape) {
      if (options.mass > 0 && !has_moments(shape, options.mass))
        problems.add(fmt::format("obstacles[{}].mass", i),
                     "the moments of inertia of so much in this shape are 0 or infinite: it cannot move freely");
      else
        obstacles_.add(shape, options);
    };
    std::visit(
        [&](const auto& shape) {
          if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, fs::path>) {
            meshes_[i] = read_mesh_shape(i, problems);
            if (!meshes_[i]) return;
            options.pose = meshes_[i]->collider.obstacle_pose(options.pose);
            add(meshes_[i]->collider);
          } else {
            add(shape);
          }
        },
        entries_[i].shape);
  }
  problems.stop_if_any();
}

std::optional<ObstacleRun::MeshShape> ObstacleRun::read_mesh_shape(std::size_t entry, Problems& problems) {
  const std::string key = fmt::format("obstacles[{}].mesh", entry);
  const fs::path& file = std::get<fs::path>(entries_[entry].shape);
  auto surface = problems.take(key, read_surface(file));
  if (!surface) return std::nullopt;
  for (const std::string& note : surface->notes) notes_.push_back(file.string() + ": " + note);
  const bool is_free = entries_[entry].options.mass > 0;
  auto collider = is_free ? MeshCollider::create_centred(*surface) : MeshCollider::create(*surface);
  if (!collider) {
    problems.add(key, file.string() + ": " + collider.error().message());
    return std::nullopt;
  }
  if (collider->was_inside_out()) {
    notes_.push_back(file.string() + ": its triangles are wound clockwise seen from outside and have been turned");
    for (auto& triangle : surface->triangles) std::swap(triangle[1], triangle[2]);
  }
  return MeshShape{*std::move(surface), *std::move(collider)};
}

Pose ObstacleRun::pose(Index i) const {
  const auto& mesh = meshes_[at(i)];
  return mesh ? mesh->collider.mesh_pose(obstacles_[i].pose()) : obstacles_[i].pose();
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
    const Pose frame = pose(static_cast<Index>(i));
    const Mat3<double> rotation = rotation_of(frame.rotation);
    const SurfaceMesh part = std::visit(
        [&](const auto& shape) -> SurfaceMesh {
          using Shape = std::decay_t<decltype(shape)>;
          if constexpr (std::is_same_v<Shape, fs::path>)
            return meshes_[i]->surface;
          else if constexpr (std::is_same_v<Shape, HalfSpace>)
            return surface_of(shape, rotation.transpose() * (centre - frame.position), size);
          else
            return surface_of(shape);
        },
        entries_[i].shape);
    const Index first = size_of(drawing.surface.positions);
    for (const Vec3<double>& x : part.positions) drawing.surface.positions.push_back(frame.position + rotation * x);
    for (const auto& [a, b, c] : part.triangles) {
      drawing.surface.triangles.push_back({first + a, first + b, first + c});
      drawing.obstacle.push_back(static_cast<Index>(i));
    }
  }
  return drawing;
}

}  // namespace corotet::program
