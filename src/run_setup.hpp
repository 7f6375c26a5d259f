// Putting a scene's state, pins and forces into a simulation.
#pragma once

#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <vector>

#include "run_input.hpp"
#include "scene.hpp"
#include "simulation.hpp"

namespace corotet::program {

/// Gives the simulation its initial state, its forces and its pins. Returns how many vertices are pinned. Throws a
/// Failure for numbers that are infinite in the simulation's precision.
Index set_up(Simulation& simulation, const Scene& scene, const RunInput& input);

/// What the simulation touches and is tied to: after a surface was bound.
struct ContactSetup {
  Index points = 0;  ///< that may touch an obstacle; 0: the body touches none
  std::vector<PointOnBody> attached;
};
/// Lets the body touch the obstacles, which must outlive the simulation, and ties its attachments. Throws a Failure for
/// a body whose points cannot touch.
[[nodiscard]] ContactSetup set_up_contact(Simulation& simulation, const Scene& scene, Obstacles& obstacles);

/// Leads the attachments through a step of h s that ends at time `t`, s.
void lead_attachments(Simulation& simulation, const Scene& scene, double t, double h);

/// Where a point is: `position(vertex)`, m.
template <class Position>
[[nodiscard]] Vec3<double> place_of(const PointOnBody& point, const Position& position) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (std::size_t a = 0; a < point.vertices.size(); ++a) sum += point.weights[a] * position(point.vertices[a]);
  return sum;
}

/// Sends the pins to where they shall be at time `t`, s.
void move_pins(Simulation& simulation, const RunInput& input, double t);

}  // namespace corotet::program
