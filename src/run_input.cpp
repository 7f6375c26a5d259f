#include "run_input.hpp"

#include <fmt/core.h>

#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/io/read_surface.hpp>
#include <corotet/detail/mesh/io/text_scanner.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <filesystem>
#include <string>
#include <utility>

#include "loads.hpp"
#include "problems.hpp"

namespace corotet::program {
namespace {

/// One vector a line for each of `vertices`.
Result<Field<double>> read_vectors(const std::filesystem::path& path, Index vertices) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return bytes.error();
  const std::string name = path.string();
  detail::TextScanner in(*bytes, name, {.comment = '#'});
  Field<double> vectors;
  vectors.reserve(at(vertices));
  while (in.ok() && !in.at_end()) {
    const double x = in.number("a coordinate"), y = in.number_on_line("a coordinate"),
                 z = in.number_on_line("a coordinate");
    vectors.emplace_back(x, y, z);
    if (in.ok() && !in.at_line_end()) in.fail("expected three numbers a line, found more");
  }
  if (!in.ok()) return in.error();
  if (size_of(vectors) != vertices)
    return Error{ErrorCode::malformed_file, name,
                 fmt::format("it has {} lines of numbers, the mesh has {} vertices", vectors.size(), vertices)};
  return vectors;
}

/// `Box`: has the corners `least` and `most`.
template <class Box>
std::vector<Index> vertices_in(const MeshData& mesh, const Box& box) {
  std::vector<Index> inside;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3<double>& x = mesh.positions[at(v)];
    if (x.cwiseMax(box.least) == x && x.cwiseMin(box.most) == x) inside.push_back(v);
  }
  return inside;
}

void take_order(const Scene& scene, RunInput& input) {
  const int order = input.mesh.nodes_per_element == 4 ? 1 : 2;
  if (scene.order == 1 && order == 2) {
    input.notes.push_back(
        "\"order\": 1: the mesh's 10-node elements are taken as 4-node ones, their mid-edge vertices are dropped");
    input.mesh = lower_order(std::move(input.mesh));
  }
  if (scene.order == 2) input.mesh = raise_order(std::move(input.mesh));
}

/// Pins, forces, probes and the initial state, matched to input.mesh.
void match(const Scene& scene, RunInput& input, Problems& problems) {
  for (std::size_t i = 0; i < scene.pins.size(); ++i) {
    const PinBox& pin = scene.pins[i];
    input.pins.push_back({vertices_in(input.mesh, pin), pin.path});
    if (input.pins.back().vertices.empty())
      problems.add(fmt::format("pins[{}].box", i), "no vertex lies in it (rest positions, m)");
  }
  for (const Vec3<double>& point : scene.probes) input.probes.push_back(nearest_position(input.mesh.positions, point));
  const Index vertices = input.mesh.vertex_count();
  if (scene.initial_positions)
    input.positions = problems.take("initial.positions", read_vectors(*scene.initial_positions, vertices));
  if (scene.initial_velocities)
    input.velocities = problems.take("initial.velocities", read_vectors(*scene.initial_velocities, vertices));
  if (scene.forces.empty() && !scene.initial_velocity && !scene.initial_angular_velocity) return;

  const std::vector<double> volume = vertex_volumes(input.mesh);
  if (!scene.forces.empty()) input.forces.emplace(at(vertices), Vec3<double>::Zero());
  for (std::size_t i = 0; i < scene.forces.size(); ++i) {
    const ForceBox& force = scene.forces[i];
    const std::vector<Index> inside = vertices_in(input.mesh, force);
    if (inside.empty())
      problems.add(fmt::format("forces[{}].box", i), "no vertex lies in it (rest positions, m)");
    else if (!add_force(input.mesh, volume, inside, force, *input.forces))
      problems.add(fmt::format("forces[{}].torque", i), "all vertices in the box lie on its axis: they have no lever");
  }
  if (scene.initial_velocity || scene.initial_angular_velocity)
    input.velocities = rigid_velocities(input.positions.value_or(input.mesh.positions), volume,
                                        scene.initial_velocity.value_or(Vec3<double>::Zero()),
                                        scene.initial_angular_velocity.value_or(Vec3<double>::Zero()));
}

}  // namespace

RunInput match_input(const Scene& scene, MeshData mesh) {
  Problems problems(scene.file.string(), scene.key_prefix);
  RunInput input;
  input.mesh = std::move(mesh);
  match(scene, input, problems);
  problems.stop_if_any();
  return input;
}

RunInput read_input(const Scene& scene) {
  Problems problems(scene.file.string(), scene.key_prefix);
  RunInput input;
  const auto take_notes = [&](const std::filesystem::path& path, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) input.notes.push_back(path.string() + ": " + note);
  };
  if (scene.surface) input.surface = problems.take("surface", read_surface(*scene.surface));
  if (input.surface) take_notes(*scene.surface, input.surface->notes);
  auto mesh = problems.take("mesh", read_mesh(scene.mesh));
  if (!mesh) {
    problems.stop_if_any();
    return input;
  }
  input.mesh = std::move(*mesh);
  take_notes(scene.mesh, input.mesh.notes);
  take_order(scene, input);

  match(scene, input, problems);
  problems.stop_if_any();
  return input;
}

}  // namespace corotet::program
