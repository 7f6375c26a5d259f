// Which points of a body may touch an obstacle in a step, and where.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/core/types.hpp>
#include <optional>

namespace corotet::inline v0_1::detail {

/// A point and an obstacle in a step.
struct ContactQuery {
  Vec3<double> start;        ///< of the point, in the world, m
  Vec3<double> end;          ///< where it may be after the step, m
  double h;                  ///< length of the step, s
  double margin;             ///< added to the obstacle, m
  double near_distance;      ///< points as near as this are contacts whatever their path, m
  double max_depenetration;  ///< speed at which a point that starts inside is led out, m/s
};

/// How far the point moves against the obstacle.
[[nodiscard]] inline Vec3<double> path_of(const ContactQuery& query, const Obstacle& obstacle) {
  return query.end - query.start - query.h * obstacle.velocity_at(query.start);
}

/// Where a path meets a surface, and what the surface is like there.
struct PathHit {
  Vec3<double> place;
  SurfaceDistance surface;
};

/// Where a point may come to touch: the distance `distance_at(place)` is followed along its path (sphere tracing: Hart
/// 1996), so that no speed leaps over a thin obstacle. The path is looked at up to `reach_factor` times its length.
/// `surface`: the distance at the start. Without a hit, sets `slack` to how far the point may end from `query.end` and
/// still miss the surface, m, if that is less.
template <class DistanceAt>
[[nodiscard]] std::optional<PathHit> follow_path(const ContactQuery& query, const Vec3<double>& path,
                                                 SurfaceDistance surface, double reach_factor,
                                                 const DistanceAt& distance_at, double& slack) {
  const double length = path.norm(), reach = reach_factor * length;
  if (surface.distance > reach + query.near_distance) {
    slack = (std::min)(slack, surface.distance - length);
    return std::nullopt;
  }
  if (surface.distance <= query.near_distance || reach <= surface.distance) return PathHit{query.start, surface};
  constexpr int max_samples = 64;
  constexpr double touching = 0.1;
  const Vec3<double> direction = path / length;
  double way = 0;
  for (int i = 0; i < max_samples && way < reach && surface.distance > touching * query.near_distance; ++i) {
    way = (std::min)(way + surface.distance, reach);
    surface = distance_at(query.start + way * direction);
  }
  // Samples may end before a path that grazes the surface does: then the plane at the last one is the contact.
  if (surface.distance > query.near_distance && !(way < reach)) {
    slack = (std::min)(slack, touching / 2 * query.near_distance);  // between samples, half the distance there
    return std::nullopt;
  }
  return PathHit{query.start + way * direction, surface};
}

/// The contact of a point with an obstacle, if its path may end there. `before`: the memory of the last step, or null.
/// For the others see follow_path.
[[nodiscard]] inline std::optional<PointContact> find_contact(const ContactQuery& query, const Obstacle& obstacle,
                                                              double reach_factor, const ContactMemory* before,
                                                              double& slack) {
  const auto distance_at = [&](const Vec3<double>& place) {
    SurfaceDistance surface = obstacle.distance(place);
    surface.distance -= query.margin;
    return surface;
  };
  SurfaceDistance surface = distance_at(query.start);
  if (before != nullptr) {  // a point that came in by one side of a thin obstacle leaves by that one
    const Vec3<double> normal = obstacle.to_world(before->normal);
    if (surface.normal.dot(normal) < -0.5)
      surface = {normal.dot(query.start - obstacle.pose().position - obstacle.to_world(before->place)), normal};
  }
  const auto hit = follow_path(query, path_of(query, obstacle), surface, reach_factor, distance_at, slack);
  if (!hit) return std::nullopt;

  PointContact contact;
  contact.reference = hit->place;
  contact.normal = hit->surface.normal;
  contact.start = query.start;
  contact.led = query.h * obstacle.velocity_at(query.start);
  contact.arm = query.start - obstacle.pose().position;
  contact.set_gap(hit->surface.distance, query.max_depenetration * query.h);
  if (before != nullptr) contact.take(*before);
  return contact;
}

/// What a contact carries on from the step that solved it. `gamma`: of the step, s. `share`: how much of the force the
/// multiplier takes over, 0 ... 1.
[[nodiscard]] inline ContactMemory memory_of(const PointContact& contact, const Obstacle& obstacle, double gamma,
                                             double share) {
  ContactMemory memory;
  memory.obstacle = contact.obstacle;
  memory.point = contact.point;
  memory.phase = contact.phase;
  memory.force = contact.normal.dot(contact.given) / gamma;
  memory.multiplier = (std::max)(0.0, (1 - share) * contact.multiplier_before + share * memory.force);
  memory.friction = contact.tangential_part(contact.given) / gamma;
  memory.normal = obstacle.to_frame(contact.normal);
  memory.place =
      obstacle.to_frame(contact.reference - contact.measured_gap * contact.normal - obstacle.pose().position);
  return memory;
}

}  // namespace corotet::inline v0_1::detail
