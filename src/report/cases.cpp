#include "cases.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace corotet::program {
namespace {

constexpr double standard_gravity = 9.81;  // m/s^2

Scene scene_of(const char* name) {
  Scene scene;
  scene.file = fmt::format("(case {})", name);
  scene.mesh = name;
  return scene;
}

/// Vertices at x = 0, all of which are pinned, in boxes wide enough for any of the cases.
PinBox end_at_zero() { return {{-1e-9, -10, -10}, {1e-9, 10, 10}, {}}; }

void keep_coarser(Study& study) {
  for (auto* levels : {&study.tet4_levels, &study.tet10_levels})
    if (levels->size() > 2) levels->pop_back();
  study.reference_level = std::max({study.reference_level - 1, study.sample_level, study.tet10_levels.back() + 1});
  study.dts.resize(std::min<std::size_t>(study.dts.size(), 3));
}

/// A beam along x of square section, its axis at y = z = 0, held at x = 0.
Study beam(const char* name, const char* title, double thickness, const std::vector<std::array<Index, 3>>& cells) {
  Study study;
  study.name = name;
  study.title = title;
  study.scene = scene_of(name);
  study.scene.pins = {end_at_zero()};
  study.meshes = make_family({.corner = {0, -thickness / 2, -thickness / 2}, .size = {1, thickness, thickness}}, cells);
  study.dts = {study.scene.dt};
  study.integrators = {study.scene.integrator};
  study.probes = {{1, 0, 0}};
  return study;
}

/// Ten times as long as thick, at rest.
Study slender_beam(const char* name, const char* title) {
  Study study = beam(name, title, 0.1, {{5, 1, 1}, {10, 1, 1}, {20, 2, 2}, {40, 4, 4}, {60, 6, 6}, {80, 8, 8}});
  study.at_rest = true;
  study.duration = study.sample_interval = 0.5;
  study.tet4_levels = {1, 2, 3, 4, 5};
  study.tet10_levels = {0, 1, 2};
  study.base_level = 1;
  study.reference_level = 3;
  study.sample_level = 2;
  return study;
}

constexpr double slender_inertia = 1e-4 / 12;  // second moment of area of 0.1 x 0.1 m, m^4

double drop(const RunResult& run) { return -run.probes.back()[0].z(); }
double shortening(const RunResult& run) { return -run.probes.back()[0].x(); }

Study self_weight(const char* name, double poisson, double expected_shortening, double expected_drop) {
  Study study = slender_beam(name, "A beam hangs under its own weight, at rest");
  study.title += fmt::format(" (L/h = 10, q = 8, ν = {})", poisson);
  const double weight = 1000 * standard_gravity * 0.01;  // N/m
  study.scene.material = {weight / (8 * slender_inertia), poisson, 1000};
  const char* source = "3D corotational solid, independent program, ± 5e-4";
  study.closed_forms = {{"drop of the tip / L", source, expected_drop, drop},
                        {"shortening / L", source, expected_shortening, shortening}};
  return study;
}

Study tip_load() {
  Study study = slender_beam("tip_load", "A beam bends under a load at its tip, at rest (L/h = 10, k = 4, ν = 0)");
  study.scene.material = {1e6, 0, 1000};
  study.scene.gravity.setZero();
  study.scene.forces = {{{1 - 1e-9, -1, -1}, {1 + 1e-9, 1, 1}, {0, 0, -4 * 1e6 * slender_inertia}, {0, 0, 0}}};
  const char* source = "elastica, Bisshopp & Drucker 1945; without shear and thickness: 3D differs by about 1 %";
  study.closed_forms = {{"drop of the tip / L", source, 0.66996418, drop},
                        {"shortening / L", source, 0.32894124, shortening}};
  return study;
}

Study torsion() {
  Study study = slender_beam("torsion", "A square bar is twisted by 0.1 rad, at rest (L/a = 10, ν = 0.3)");
  constexpr double twist = 0.1, young = 1e6, poisson = 0.3, section = 0.1405770150 * 1e-4;  // J = 0.1406 a^4, m^4
  study.scene.material = {young, poisson, 1000};
  study.scene.gravity.setZero();
  const double torque = twist * young / (2 * (1 + poisson)) * section;
  study.scene.forces = {{{1 - 1e-9, -1, -1}, {1 + 1e-9, 1, 1}, {0, 0, 0}, {torque, 0, 0}}};
  // The middle half, which both ends are too far from to matter (Saint-Venant).
  study.probes = {{0.75, 0.05, 0}, {0.75, -0.05, 0}, {0.25, 0.05, 0}, {0.25, -0.05, 0}};
  study.closed_forms = {
      {"twist of the middle half, rad", "Saint-Venant, J = 0.1405770150 a^4", twist / 2, [](const RunResult& run) {
         const Field<double>& u = run.probes.back();
         const auto angle = [&](std::size_t p) {
           const Vec3<double> d = u[p] - u[p + 1];
           return std::atan2(d.z(), 0.1 + d.y());
         };
         return angle(0) - angle(2);
       }}};
  return study;
}

/// The beam that the peers were measured on.
Study swing() {
  Study study = beam("swing", "A beam falls from rest and swings (L/h = 5, the peers' beam, 1 s)", 0.2,
                     {{5, 1, 1}, {6, 1, 1}, {10, 1, 1}, {10, 2, 2}, {20, 4, 4}, {40, 8, 8}});
  study.dts = {1.0 / 60, 1.0 / 30, 1.0 / 120, 1.0 / 240};
  study.integrators = {IntegratorKind::implicit_euler, IntegratorKind::bdf2};
  study.duration = 1;
  study.tet4_levels = {0, 3, 4, 5};
  study.tet10_levels = {0, 1, 2, 3};
  study.base_level = 1;
  study.reference_level = 4;
  study.sample_level = 3;
  return study;
}

Study free_spin() {
  Study study;
  study.name = "free_spin";
  study.title = "A free cube spins (0.4 m, hω = 0.1 at 1/60 s, one revolution)";
  study.scene = scene_of("free_spin");
  study.scene.gravity.setZero();
  study.scene.initial_angular_velocity = Vec3<double>(0, 0, 6);
  study.meshes = make_family({.corner = {-0.2, -0.2, -0.2}, .size = {0.4, 0.4, 0.4}},
                             {{1, 1, 1}, {2, 2, 2}, {4, 4, 4}, {8, 8, 8}});
  study.dts = {1.0 / 60, 1.0 / 30, 1.0 / 120, 1.0 / 240};
  study.duration = 31.0 / 30;
  study.probes = {{0.2, 0.2, 0.2}};
  study.tet4_levels = {0, 1, 2, 3};
  study.tet10_levels = {0, 1};
  study.base_level = 0;
  study.reference_level = 2;
  study.sample_level = 1;
  study.closed_forms = {{"angular momentum / that at the start", "conserved", 1, [](const RunResult& run) {
                           return run.angular_momentum_last.dot(run.angular_momentum_first) /
                                  run.angular_momentum_first.squaredNorm();
                         }}};
  return study;
}

Study block() {
  Study study;
  study.name = "block";
  study.title = "A cube on a fixed base sags (1 m, E = 3e4 Pa, ν = 0.3, 0.5 s)";
  study.scene = scene_of("block");
  study.scene.material = {3e4, 0.3, 1000};
  study.scene.pins = {{{-1, -1, -1e-9}, {2, 2, 1e-9}, {}}};
  study.meshes = make_family({}, {{2, 2, 2}, {4, 4, 4}, {8, 8, 8}, {16, 16, 16}});
  study.dts = {1.0 / 60, 1.0 / 30, 1.0 / 120, 1.0 / 240};
  study.duration = 0.5;
  study.probes = {{0, 0, 1}};
  study.tet4_levels = {0, 1, 2, 3};
  study.tet10_levels = {0, 1};
  study.base_level = 1;
  study.reference_level = 2;
  study.sample_level = 1;
  study.sizes = true;
  return study;
}

}  // namespace

std::vector<Study> default_studies(bool quick) {
  std::vector<Study> studies{self_weight("self_weight", 0.3, 0.27661, 0.64665),
                             self_weight("self_weight_nu0", 0, 0.27882, 0.64853),
                             swing(),
                             tip_load(),
                             torsion(),
                             free_spin(),
                             block()};
  if (quick)
    for (Study& study : studies) keep_coarser(study);
  return studies;
}

Study study_of(const Scene& scene, const RunInput& input, bool quick) {
  Study study;
  study.name = scene.file.stem().string();
  study.title = scene.file.string();
  study.scene = scene;
  study.own_order = input.mesh.nodes_per_element == 10 ? 2 : 1;
  const Index own_elements = input.mesh.element_count();
  study.meshes = make_family(input.mesh, std::max<Index>(8 * own_elements, quick ? 500 : 20000));
  if (scene.initial_positions || scene.initial_velocities) {  // one line a vertex: no other mesh has them
    study.meshes.levels = {study.meshes[study.meshes.own]};
    study.meshes.own = 0;
    study.meshes.notes = "the scene's initial state is a file for the vertices of its mesh: no other mesh is tried";
  }
  const int own = study.meshes.own, last = study.meshes.count() - 1;
  study.sample_level = own;
  while (study.sample_level > 0 && study.meshes[study.sample_level].linear.vertex_count() > 1500) --study.sample_level;
  study.base_level = own;
  study.reference_level = last;
  for (int level = 0; level <= last; ++level) study.tet4_levels.push_back(level);
  for (int level = 0; level < std::max(last, 1); ++level) study.tet10_levels.push_back(level);

  study.dts = {scene.dt, 2 * scene.dt, scene.dt / 2, scene.dt / 4};
  const int steps = std::max(2, scene.steps / 2 * 2);
  // About thirty samples, each a whole number of the longest steps apart.
  const int every = 2 * std::max(1, steps / 60);
  study.sample_interval = every * scene.dt;
  const int samples = steps / every;
  study.duration = samples * study.sample_interval;

  study.probes = scene.probes;
  if (study.probes.empty()) {
    const Field<double>& points = input.mesh.positions;
    std::vector<bool> pinned(points.size(), false);
    Vec3<double> held = Vec3<double>::Zero();
    Index count = 0;
    for (const PinnedVertices& pins : input.pins)
      for (const Index v : pins.vertices) {
        held += points[at(v)];
        ++count;
      }
    if (count > 0) held /= count;
    study.probes.push_back(*std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return (a - held).squaredNorm() < (b - held).squaredNorm();
    }));
  }
  return study;
}

}  // namespace corotet::program
