#include "contact_scene.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <corotet/detail/mesh/check_connectivity.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "file_key.hpp"

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

/// A number that has no default.
void required_number(ObjectReader& in, const char* key, double& value, const Range& range, const char* unit) {
  if (!in.has(key)) return in.problems().add(in.path_of(key), fmt::format("is missing; it {}, {}", range.text(), unit));
  in.number(key, value, range);
}

void read_half_space(ObjectReader& in, HalfSpace& shape) {
  in.vector("normal", shape.normal);
  if (shape.normal.isZero())
    in.problems().add(in.path_of("normal"), "must not be zero: it points out of the solid, and [0, 0, 1] is a floor's");
  in.number("offset", shape.offset);
}

void read_sphere(ObjectReader& in, Sphere& shape) { required_number(in, "radius", shape.radius, Range::above(0), "m"); }

void read_box_shape(ObjectReader& in, OrientedBox& shape) {
  if (!in.has("half_extents"))
    return in.problems().add(in.path_of("half_extents"), "is missing; it must be three numbers > 0, m");
  shape.half_extents = Vec3<double>::Ones();
  in.vector("half_extents", shape.half_extents);
  const Vec3<double>& h = shape.half_extents;
  if (!(h.minCoeff() > 0))
    in.problems().add(in.path_of("half_extents"),
                      fmt::format("must be three numbers > 0, is [{}, {}, {}]", h[0], h[1], h[2]));
}

void read_capsule(ObjectReader& in, Capsule& shape) {
  required_number(in, "radius", shape.radius, Range::above(0), "m");
  required_number(in, "half_height", shape.half_height, Range::from(0), "m, of the segment along z");
}

/// The one shape that an obstacle must have; nothing, after noting a problem, otherwise.
void read_shape(ObjectReader& in, const std::string& path, const fs::path& folder, ObstacleEntry& entry) {
  std::vector<std::string> found;
  const auto take = [&](const char* key) {
    if (in.has(key)) found.emplace_back(key);
    return in.has(key);
  };
  if (take("half_space"))
    in.object("half_space", [&](ObjectReader& r) { read_half_space(r, entry.shape.emplace<HalfSpace>()); });
  if (take("sphere")) in.object("sphere", [&](ObjectReader& r) { read_sphere(r, entry.shape.emplace<Sphere>()); });
  if (take("box")) in.object("box", [&](ObjectReader& r) { read_box_shape(r, entry.shape.emplace<OrientedBox>()); });
  if (take("capsule")) in.object("capsule", [&](ObjectReader& r) { read_capsule(r, entry.shape.emplace<Capsule>()); });
  if (take("mesh")) entry.shape = read_file_key(in, "mesh", folder).value_or("");
  if (found.empty()) in.problems().add(path, "needs a shape: half_space, sphere, box, capsule or mesh");
  if (found.size() > 1)
    in.problems().add(
        path, fmt::format("has {} shapes, {}: write an obstacle for each", found.size(), fmt::join(found, " and ")));
}

void read_pose(ObjectReader& in, Pose& pose) {
  in.vector("position", pose.position);
  in.quaternion("rotation", pose.rotation);
  constexpr double written = 1e-2;  // numbers of a few digits are meant as a unit quaternion
  if (const double length = pose.rotation.norm(); !(std::abs(length - 1) < written))
    in.problems().add(
        in.path_of("rotation"),
        fmt::format("must be a unit quaternion [w, x, y, z], [1, 0, 0, 0] for none; its length is {}", length));
}

void check_motion(ObjectReader& in, const ObstacleEntry& entry) {
  const auto refuse = [&](const char* key, const char* reason) { in.problems().add(in.path_of(key), reason); };
  const bool is_free = entry.options.mass > 0;
  if (is_free && std::holds_alternative<HalfSpace>(entry.shape))
    refuse("mass", "a half_space has no centre of mass: leave mass out, or take a box");
  if (is_free && !entry.path.empty()) refuse("path", "an obstacle with a mass moves freely: leave out path or mass");
  if (in.has("velocity") && !entry.path.empty())
    refuse("velocity", "the path leads the obstacle: leave out velocity or path");
}

void read_obstacle(const Json& value, const std::string& path, const fs::path& folder, Problems& problems,
                   std::vector<ObstacleEntry>& obstacles) {
  ObjectReader in(value, path, problems);
  if (!value.is_object()) return;
  ObstacleEntry& entry = obstacles.emplace_back();
  read_shape(in, path, folder, entry);
  in.object("pose", [&](ObjectReader& pose) { read_pose(pose, entry.options.pose); });
  in.number("friction", entry.options.friction, Range::from(0));
  in.number("mass", entry.options.mass, Range::from(0));
  in.vector("velocity", entry.options.velocity);
  in.vector("angular_velocity", entry.options.angular_velocity);
  entry.path = read_path_points(in);
  check_motion(in, entry);
  in.refuse_others();
}

void read_attachment(const Json& value, const std::string& path, Problems& problems,
                     std::vector<AttachmentEntry>& attachments) {
  ObjectReader in(value, path, problems);
  if (!value.is_object()) return;
  AttachmentEntry& entry = attachments.emplace_back();
  if (!in.has("nearest")) problems.add(in.path_of("nearest"), "is missing: [x, y, z], m");
  in.vector("nearest", entry.nearest);
  if (entry.nearest.cwiseAbs().maxCoeff() > corotet::detail::max_coordinate)
    problems.add(in.path_of("nearest"), "lies too far away: no distance to the body can be computed");
  entry.to = entry.nearest;
  in.vector("to", entry.to);
  in.number("stiffness", entry.options.stiffness, Range::above(0));
  in.number("damping", entry.options.damping, Range::from(0));
  entry.path = read_path_points(in);
  in.refuse_others();
}

}  // namespace

void read_contact(ObjectReader& in, ContactScene& contact) {
  in.object("contact", [&](ObjectReader& options) {
    options.choice(
        "points", contact.points,
        {{"boundary", TouchingPoints::boundary}, {"surface", TouchingPoints::surface}, {"none", TouchingPoints::none}});
    options.number("friction", contact.options.friction, Range::from(0));
    options.number("margin", contact.options.margin, Range::from(0));
    options.integer("passes", contact.options.passes, 1);
    options.number("max_depenetration", contact.options.max_depenetration, Range::above(0));
    options.integer("max_contacts_per_point", contact.options.max_contacts_per_point, 1);
  });
  if (contact.points == TouchingPoints::surface && !in.has("surface"))
    in.problems().add(in.path_of("contact.points"),
                      "\"surface\" takes the vertices under the key \"surface\", which is missing: add it, or take "
                      "\"boundary\"");
  in.list("attachments", [&](const Json& entry, const std::string& where) {
    read_attachment(entry, where, in.problems(), contact.attachments);
  });
}

void read_obstacles(ObjectReader& in, const fs::path& folder, std::vector<ObstacleEntry>& obstacles) {
  in.list("obstacles", [&](const Json& entry, const std::string& where) {
    read_obstacle(entry, where, folder, in.problems(), obstacles);
  });
}

}  // namespace corotet::program
