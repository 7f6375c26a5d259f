#include "run_setup.hpp"

#include <algorithm>
#include <vector>

#include "problems.hpp"

namespace corotet::program {

Index set_up(Simulation& simulation, const Scene& scene, const RunInput& input) {
  Problems problems(scene.file.string(), scene.key_prefix);  // numbers that are infinite in float
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

ContactSetup set_up_contact(Simulation& simulation, const Scene& scene, Obstacles& obstacles) {
  Problems problems(scene.file.string(), scene.key_prefix);
  ContactSetup contact;
  if (scene.touches_obstacles()) {
    problems.check("contact.points", simulation.touch(obstacles, scene.contact));
    contact.points = simulation.contact_terms().contact_points();
  }
  problems.stop_if_any();
  if (!scene.contact.attachments.empty()) contact.attached = simulation.attach(scene.contact.attachments);
  return contact;
}

void lead_attachments(Simulation& simulation, const Scene& scene, double t, double h) {
  for (std::size_t i = 0; i < scene.contact.attachments.size(); ++i) {
    const AttachmentEntry& entry = scene.contact.attachments[i];
    const Vec3<double> before = displacement_at(entry.path, t - h), now = displacement_at(entry.path, t);
    simulation.contact_terms().lead_attachment(static_cast<Index>(i), entry.to + now, (now - before) / h);
  }
}

void move_pins(Simulation& simulation, const RunInput& input, double t) {
  for (const PinnedVertices& pins : input.pins) {
    const Vec3<double> displacement = displacement_at(pins.path, t);
    for (const Index v : pins.vertices) simulation.move_pin(v, displacement);
  }
}

}  // namespace corotet::program
