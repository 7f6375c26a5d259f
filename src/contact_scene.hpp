// What a scene says of contact: points of the body, obstacles, attachments. docs/scene.md describes the keys.
#pragma once

#include <corotet/detail/contact/attachment.hpp>
#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <filesystem>
#include <variant>
#include <vector>

#include "led_path.hpp"
#include "object_reader.hpp"

namespace corotet::program {

/// Points of the body that touch obstacles.
enum class TouchingPoints { boundary, surface, none };

/// One entry of `obstacles`.
struct ObstacleEntry {
  /// The last is a closed triangle mesh, by its file.
  std::variant<HalfSpace, Sphere, OrientedBox, Capsule, std::filesystem::path> shape;
  ObstacleOptions options;
  std::vector<PathPoint> path;  ///< of the pose's position; empty: not led by a path
};

/// One entry of `attachments`.
struct AttachmentEntry {
  Vec3<double> nearest = Vec3<double>::Zero();  ///< names the point of the body that is nearest to it at rest, m
  Vec3<double> to = Vec3<double>::Zero();       ///< where the spring pulls it, m
  AttachmentOptions options;
  std::vector<PathPoint> path;  ///< of `to`
};

/// How a body touches obstacles, and what it is tied to.
struct ContactScene {
  TouchingPoints points = TouchingPoints::boundary;
  ContactOptions options;
  std::vector<AttachmentEntry> attachments;
};

/// Reads the keys `contact` and `attachments` of a body.
void read_contact(ObjectReader& in, ContactScene& contact);

/// Reads the key `obstacles`. `folder`: that of the scene's file.
void read_obstacles(ObjectReader& in, const std::filesystem::path& folder, std::vector<ObstacleEntry>& obstacles);

}  // namespace corotet::program
