#include "run_setup.hpp"

#include <algorithm>
#include <vector>

#include "problems.hpp"

namespace corotet::program {

Index set_up(Simulation& simulation, const Scene& scene, const RunInput& input) {
  Problems problems(scene.file.string());  // numbers that are infinite in float
  if (input.positions) problems.check("initial.positions", simulation.set_positions(*input.positions));
  if (input.velocities) problems.check("initial.velocities", simulation.set_velocities(*input.velocities));
  problems.stop_if_any();
  if (input.forces) simulation.set_forces(*input.forces);
  std::vector<bool> pinned(input.mesh.positions.size(), false);
  for (const PinnedVertices& pins : input.pins) {
    for (const Index v : pins.vertices) {
      simulation.pin(v);
      pinned[at(v)] = true;
    }
  }
  return static_cast<Index>(std::count(pinned.begin(), pinned.end(), true));
}

void move_pins(Simulation& simulation, const RunInput& input, double t) {
  for (const PinnedVertices& pins : input.pins) {
    const Vec3<double> displacement = pins.displacement(t);
    for (const Index v : pins.vertices) simulation.move_pin(v, displacement);
  }
}

}  // namespace corotet::program
