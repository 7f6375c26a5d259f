// Bodies that nothing holds.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

/// Spins about z and flies, `turns` revolutions. The block is `length` long; its stiffness grows with the speed
/// squared, so that the strain is that of E = 5e5 Pa at h omega = 0.1: rho omega^2 length^2 / E = 0.072 for 1 m, 0.0115
/// for 0.4 m.
CaseResult spin(const Configuration& configuration, double length, double h_omega, double turns) {
  Scene scene = configuration.scene();
  scene.material.young *= h_omega * h_omega / 0.01;
  MeshData mesh = block(configuration.order);
  for (Vec3<double>& x : mesh.positions) x *= length;
  TestBody trial(scene, std::move(mesh));
  const double omega = h_omega / scene.dt;
  const Vec3<double> centre = trial.centre();
  const Vec3<double> flight = length * omega * Vec3<double>(0.3, 0.1, 0.2);
  trial.push([&](Index v) { return flight + Vec3<double>(0, 0, omega).cross(trial.rest(v) - centre); });
  const Vec3<double> spin_before = trial.angular_momentum(), momentum_before = trial.momentum();
  const double radius = trial.inertia_radius();
  double inflation = 1;
  trial.run(static_cast<int>(std::ceil(2 * std::numbers::pi * turns / h_omega)), [&] {
    inflation = std::max(inflation, trial.inertia_radius() / radius);
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  const double kept = trial.angular_momentum().dot(spin_before) / spin_before.squaredNorm();
  verdict.at_least("angular momentum kept", kept, 0.99);
  verdict.at_most("angular momentum gained", kept - 1, 0.01);
  verdict.at_most("momentum changed", (trial.momentum() - momentum_before).norm() / momentum_before.norm(),
                  configuration.in_double() ? 1e-9 : 1e-4);
  verdict.note("radius", inflation);
  return verdict;
}

/// Two halves of unlike stiffness and density fly apart and cannot.
CaseResult unlike_halves(const Configuration& configuration, bool stiff_is_heavy) {
  TestBody trial(configuration.scene(), block(configuration.order));
  const MeshData& mesh = trial.mesh();
  std::vector<Material> materials;
  std::vector<bool> of_stiff(mesh.positions.size(), false);
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const Index* nodes = mesh.connectivity.data() + std::ptrdiff_t{e} * mesh.nodes_per_element;
    double x = 0;
    for (int k = 0; k < 4; ++k) x += mesh.positions[at(nodes[k])].x() / 4;
    const bool stiff = x > 0.5;
    materials.push_back({stiff ? 1e9 : 1e3, configuration.ratio.poisson, stiff == stiff_is_heavy ? 1e4 : 1.0});
    if (stiff)
      for (int k = 0; k < mesh.nodes_per_element; ++k) of_stiff[at(nodes[k])] = true;
  }
  CaseResult verdict;
  const Result<void> status = trial.body().set_materials(materials);
  verdict.expect(status.ok(), "the materials are refused");
  trial.push([&](Index v) { return of_stiff[at(v)] ? Vec3<double>(1, 0.5, 0) : Vec3<double>(0, 0, 0.2); });
  const Vec3<double> before = trial.momentum();
  trial.run(300);
  trial.report_to(verdict);
  verdict.note("most iterations", trial.counts().max_iterations);
  verdict.at_most("steps with a solve at its limit of iterations", trial.counts().at_iteration_limit, 0);
  verdict.note("steps short of the tolerance", trial.counts().unconverged);
  verdict.at_most("momentum changed", (trial.momentum() - before).norm() / before.norm(),
                  configuration.in_double() ? 1e-9 : 1e-4);
  return verdict;
}

}  // namespace

void add_free_cases(std::vector<Case>& cases) {
  for (const auto& [text, h_omega] : {std::pair{".02", 0.02}, std::pair{".1", 0.1}, std::pair{".5", 0.5}})
    for (const int turns : {1, 10})
      cases.push_back(
          {fmt::format("spin-{}-{}", text, turns),
           fmt::format("free block of 0.4 m flies and spins, h omega = {}, {} turn{}", text, turns,
                       turns == 1 ? "" : "s"),
           "angular momentum kept within 1 %, momentum to rounding (1e-9, float 1e-4); radius reported", Solvers::all,
           ratios(Ratios::all),
           [h_omega = h_omega, turns](const Configuration& c, const Effort&) { return spin(c, 0.4, h_omega, turns); }});
  cases.push_back({"spin-soft", "the same of 1 m, six times as soft against its spin, h omega = 0.1, 10 turns",
                   "angular momentum kept within 1 %, momentum to rounding (1e-9, float 1e-4); radius reported",
                   Solvers::all, ratios(Ratios::all),
                   [](const Configuration& c, const Effort&) { return spin(c, 1, 0.1, 10); }});
  for (const bool heavy : {true, false})
    cases.push_back({heavy ? "ratio-heavy" : "ratio-light",
                     fmt::format("free block, E 1e3 | 1e9 Pa, density {} kg/m^3, halves pushed apart",
                                 heavy ? "1 | 1e4" : "1e4 | 1"),
                     "300 steps: no solve reaches its limit of iterations, momentum kept (1e-9, float 1e-4); solves "
                     "that rounding stops are reported",
                     Solvers::all, ratios(Ratios::all),
                     [heavy](const Configuration& c, const Effort&) { return unlike_halves(c, heavy); }});
}

}  // namespace corotet::program::stress
