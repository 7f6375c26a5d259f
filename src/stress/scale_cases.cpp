// Short and long steps, small and large bodies, bodies far away.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

/// Of all displacements, in the Euclidean norm.
double relative_difference(const Field<double>& u, const Field<double>& reference) {
  double difference = 0, size = 0;
  for (std::size_t v = 0; v < u.size(); ++v) {
    difference += (u[v] - reference[v]).squaredNorm();
    size += reference[v].squaredNorm();
  }
  return std::sqrt(difference / size);
}

/// A block of 1 cm sags by a tenth of its length. Critically damped: it is at rest after some 20 ms.
CaseResult settle(const Configuration& configuration, double h) {
  Scene scene = configuration.scene();
  scene.dt = h;
  scene.damping.mass = 2000;
  scene.gravity = {0, 0, -2000};
  MeshData mesh = block(configuration.order);
  for (Vec3<double>& x : mesh.positions) x *= 0.01;
  const auto shape_after = [&](double dt, int steps, CaseResult& verdict) {
    scene.dt = dt;
    TestBody trial(scene, mesh);
    trial.pin(at_left_end);
    trial.run(steps);
    trial.report_to(verdict);
    Field<double> shape;
    for (Index v = 0; v < trial.vertices(); ++v) shape.push_back(trial.body().displacement(v));
    return shape;
  };
  CaseResult verdict, of_reference;
  const Field<double> shape = shape_after(h, std::max(60, static_cast<int>(0.04 / h)), verdict),
                      reference = shape_after(2e-3, 100, of_reference);
  verdict.at_most("difference from the shape at h = 2e-3 s", relative_difference(shape, reference), 1e-3);
  return verdict;
}

/// Displacements after a second of falling, with the body's least corner at `corner`.
Field<double> fall(const Configuration& configuration, const Vec3<double>& corner, double gravity,
                   CaseResult& verdict) {
  Scene scene = configuration.scene();
  scene.gravity = {0, 0, -gravity};
  scene.solver.tolerance = 1e-5;  // so that it does not hide a difference
  MeshData mesh = bar(configuration.order);
  for (Vec3<double>& x : mesh.positions) x += corner;
  TestBody trial(scene, std::move(mesh));
  trial.pin([&](const Vec3<double>& x) { return at_left_end(x - corner - Vec3<double>(1e-6, 0, 0)); });
  trial.run(60);
  trial.report_to(verdict);
  Field<double> displacements;
  for (Index v = 0; v < trial.vertices(); ++v) displacements.push_back(trial.body().displacement(v));
  return displacements;
}

CaseResult far_away(const Configuration& configuration, double distance) {
  CaseResult verdict;
  const auto here = Vec3<double>::Zero();
  const Vec3<double> there(distance, -0.7 * distance, 0.3 * distance);
  constexpr double gravity = 9.81;
  const Field<double> near = fall(configuration, here, gravity, verdict),
                      far = fall(configuration, there, gravity, verdict);
  const auto difference = [&](const Field<double>& other) { return relative_difference(other, near); };
  double rounding = 0;  // what the last bits of gravity make of themselves
  if (!configuration.in_double())
    for (const int bits : {-2, -1, 1, 2})
      rounding = std::max(rounding, difference(fall(configuration, here, gravity * (1 + bits * 0x1p-23), verdict)));
  verdict.at_most("difference from the same at the origin", difference(far), std::clamp(2 * rounding, 1e-4, 1e-3));
  if (!configuration.in_double()) verdict.note("at the origin, gravity changed by its last bits", rounding);
  return verdict;
}

/// Sags and swings as one of 1 m, 5e5 Pa and 1000 kg/m^3 does, with times in proportion to size sqrt(rho / E).
Field<double> sized(const Configuration& configuration, double size, double young, double density,
                    CaseResult& verdict) {
  Scene scene = configuration.scene();
  const double time = size * std::sqrt(density / 1000 * 5e5 / young);
  scene.dt *= time;
  scene.material.young = young;
  scene.material.density = density;
  scene.gravity = {0, 0, -9.81 * size / (time * time)};
  scene.solver.tolerance = 1e-5;
  MeshData mesh = bar(configuration.order);
  for (Vec3<double>& x : mesh.positions) x *= size;
  TestBody trial(scene, std::move(mesh));
  trial.pin([&](const Vec3<double>& x) { return at_left_end(x / size); });
  trial.run(60);
  trial.report_to(verdict);
  Field<double> displacements;
  for (Index v = 0; v < trial.vertices(); ++v) displacements.push_back(trial.body().displacement(v) / size);
  return displacements;
}

CaseResult sizes(const Configuration& configuration) {
  CaseResult verdict;
  const Field<double> reference = sized(configuration, 1, 5e5, 1000, verdict);
  double worst = 0;
  for (const double size : {1e-3, 1e3})
    for (const double young : {1e2, 1e12})
      for (const double density : {1e-1, 1e5}) {
        const Field<double> found = sized(configuration, size, young, density, verdict);
        const double difference = relative_difference(found, reference);
        if (!(difference <= worst)) worst = difference;
      }
  const auto [lambda, mu] = lame(configuration.scene().material);
  const double rounding = configuration.in_double() ? 0 : 60 * 0x1p-24 * lambda / mu;  // of 60 steps
  verdict.at_most("worst difference from the body of 1 m", worst, std::max(1e-4, rounding));
  return verdict;
}

}  // namespace

void add_scale_cases(std::vector<Case>& cases) {
  for (const auto& [text, h] : {std::pair{"1e-5", 1e-5}, std::pair{"1e-4", 1e-4}, std::pair{"1e-3", 1e-3},
                                std::pair{".01", 0.01}, std::pair{".1", 0.1}, std::pair{"1", 1.0}})
    cases.push_back({fmt::format("step-{}", text), fmt::format("block of 1 cm sags by 1 mm, h = {} s", text),
                     "finite, at rest in the same shape as with h = 2e-3 s within 1e-3 of it",
                     h < 1e-4 ? Solvers::two : Solvers::all, ratios(h < 1e-4 ? Ratios::three : Ratios::all),
                     [h = h](const Configuration& c, const Effort&) { return settle(c, h); }});
  for (const auto& [text, distance] : {std::pair{"1e4", 1e4}, std::pair{"1e6", 1e6}})
    cases.push_back({fmt::format("far-{}", text), fmt::format("bar swings for 1 s at {} m from the origin", text),
                     "the displacement at the origin within 1e-4 of it; float: or twice what the last bits of gravity "
                     "change, and 1e-3 at most",
                     Solvers::all, ratios(Ratios::all),
                     [distance = distance](const Configuration& c, const Effort&) { return far_away(c, distance); }});
  cases.push_back({"sizes", "bar swings for 60 steps: 1 mm and 1 km, E 1e2 and 1e12 Pa, 0.1 and 1e5 kg/m^3",
                   "the displacement of the bar of 1 m, 5e5 Pa, 1000 kg/m^3 within 1e-4 of it, in proportion; "
                   "float: or 60 roundings times lambda / mu",
                   Solvers::all, ratios(Ratios::three),
                   [](const Configuration& c, const Effort&) { return sizes(c); }});
}

}  // namespace corotet::program::stress
