// Putting a scene's state, pins and forces into a simulation.
#pragma once

#include <corotet/detail/core/types.hpp>

#include "run_input.hpp"
#include "scene.hpp"
#include "simulation.hpp"

namespace corotet::program {

/// Gives the simulation its initial state, its forces and its pins. Returns how many vertices are pinned. Throws a
/// Failure for numbers that are infinite in the simulation's precision.
Index set_up(Simulation& simulation, const Scene& scene, const RunInput& input);

/// Sends the pins to where they shall be at time `t`, s.
void move_pins(Simulation& simulation, const RunInput& input, double t);

}  // namespace corotet::program
