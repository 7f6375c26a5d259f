// Displacements at times, along which a scene leads pins, obstacles and attachments.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <vector>

#include "object_reader.hpp"

namespace corotet::program {

/// A displacement at a time; linear in between.
struct PathPoint {
  double time;                ///< s
  Vec3<double> displacement;  ///< m
};

/// The displacement at time t, s: linear between the points, constant beyond the ends, zero without a point.
[[nodiscard]] Vec3<double> displacement_at(const std::vector<PathPoint>& path, double t);

/// The rows [t, dx, dy, dz] under "path"; notes rows that are none, and times that do not ascend.
[[nodiscard]] std::vector<PathPoint> read_path_points(ObjectReader& in);

}  // namespace corotet::program
