// Sums over the vertices of a body.
#pragma once

#include <corotet/detail/core/types.hpp>

#include "simulation.hpp"

namespace corotet::program {

/// m, in world coordinates.
[[nodiscard]] inline Vec3<double> centre_of_mass(const Simulation& body, Index vertices) {
  Vec3<double> sum = Vec3<double>::Zero();
  double mass = 0;
  for (Index v = 0; v < vertices; ++v) {
    sum += body.vertex_mass(v) * body.position(v);
    mass += body.vertex_mass(v);
  }
  return sum / mass;
}

/// kg m/s.
[[nodiscard]] inline Vec3<double> linear_momentum(const Simulation& body, Index vertices) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (Index v = 0; v < vertices; ++v) sum += body.vertex_mass(v) * body.velocity(v);
  return sum;
}

/// About a point, kg m^2/s.
[[nodiscard]] inline Vec3<double> angular_momentum(const Simulation& body, Index vertices, const Vec3<double>& about) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (Index v = 0; v < vertices; ++v) sum += body.vertex_mass(v) * (body.position(v) - about).cross(body.velocity(v));
  return sum;
}

}  // namespace corotet::program
