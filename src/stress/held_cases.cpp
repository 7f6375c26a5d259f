// Bodies that are held stretched, hang by their weight, or are twisted.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <numbers>

#include "../failure.hpp"
#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

const Ratio ratio_0{"nu=0", 0, VolumetricStrain::pointwise}, ratio_3{"nu=.3", 0.3, VolumetricStrain::pointwise};

CaseResult hold_stretched(const Configuration& configuration, double stretch) {
  TestBody trial(configuration.settling_scene(), bar(configuration.order));
  trial.pin(at_left_end);
  const auto right = trial.pin(at_right_end);
  const double side = 1 - configuration.ratio.poisson * (stretch - 1);
  trial.place([&](Index v) { return trial.rest(v).cwiseProduct(Vec3<double>(stretch, side, side)); });
  for (const Index v : right) trial.body().move_pin(v, {stretch - 1, 0, 0});
  trial.run(600);
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("speed, m/s", trial.max_speed(), 1e-3);
  verdict.note("inverted", trial.last().inverted_elements);
  return verdict;
}

/// The bar's axis is along gravity, rho g L / E = 0.2: it grows by 0.1 m.
CaseResult hang(const Configuration& configuration, double h) {
  Scene scene = configuration.settling_scene();
  scene.dt = h;
  scene.gravity = {9.81, 0, 0};
  scene.material.young = scene.material.density * 9.81 / 0.2;
  TestBody trial(scene,
                 require(make_block({.size = {1, 0.1, 0.1}, .cells = {20, 1, 1}, .order = configuration.order})));
  trial.pin(at_left_end);
  trial.run(std::max(100, static_cast<int>(10 / h)));
  double jump = 0;  // of the tip between the last steps
  const Index tip = nearest_position(trial.mesh().positions, Vec3<double>(1, 0.1, 0.1));
  Vec3<double> before = trial.body().displacement(tip);
  trial.run(10, [&] {
    jump = std::max(jump, (trial.body().displacement(tip) - before).norm());
    before = trial.body().displacement(tip);
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("jump of the tip between steps, m", jump, 1e-3);
  verdict.at_most("error of the elongation, m", std::abs(before.x() - 0.1), 1e-3);
  return verdict;
}

/// Ends turned against each other by `turns` each within 2 s, held for 4 s, then one of them is let go.
CaseResult twist(const Configuration& configuration, double turns) {
  TestBody trial(configuration.settling_scene(), bar(configuration.order));
  const auto left = trial.pin(at_left_end), right = trial.pin(at_right_end);
  constexpr int turning = 120, holding = 240;
  double flicker = 0;
  for (int i = 1; i <= turning + holding; ++i) {
    const double angle = 2 * std::numbers::pi * turns * std::min(i, turning) / turning;
    for (const auto& [end, sign] : {std::pair{&left, -1}, std::pair{&right, 1}})
      for (const Index v : *end) {
        const Vec3<double> arm(0, trial.rest(v).y(), trial.rest(v).z());
        trial.body().move_pin(v, rotation_by(sign * angle * Vec3<double>::UnitX()) * arm - arm);
      }
    const double before = trial.last().max_rotation;
    if (!trial.step()) break;
    if (i > turning + holding - 30) flicker = std::max(flicker, std::abs(trial.last().max_rotation - before));
  }
  const double speed = trial.max_speed();
  const Index inverted = trial.last().inverted_elements;
  for (const Index v : right) trial.body().release(v);
  trial.run(1200);
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("flicker of R when held, rad", flicker, 1e-2);
  verdict.at_most("speed when held, m/s", speed, 1e-3);
  verdict.note("inverted when held", inverted);
  verdict.at_most("rms to rest when released", trial.rms_to_rest(), 1e-3);
  return verdict;
}

}  // namespace

void add_held_cases(std::vector<Case>& cases) {
  struct Stretch {
    const char* name;
    double factor;
    Ratio ratio;
  };
  for (const Stretch& s :
       {Stretch{"stretch-2", 2, ratio_3}, Stretch{"stretch-3", 3, ratio_3}, Stretch{"stretch-4", 4, ratio_3},
        Stretch{"stretch-5", 5, ratio_0}, Stretch{"stretch-8", 8, ratio_0}})
    cases.push_back({s.name,
                     fmt::format("bar held at {} times its length, {}", s.factor, s.ratio.name),
                     "after 10 s no vertex is faster than 1e-3 m/s",
                     Solvers::all,
                     {s.ratio},
                     [factor = s.factor](const Configuration& c, const Effort&) { return hold_stretched(c, factor); }});
  for (const auto& [name, h] :
       {std::pair{"hang-60", 1.0 / 60}, std::pair{"hang-.1", 0.1}, std::pair{"hang-.3", 0.3}, std::pair{"hang-1", 1.0}})
    cases.push_back({name,
                     fmt::format("bar of 1 x 0.1 x 0.1 m hangs along its length, rho g L / E = 0.2, h = {:.3g} s", h),
                     "after 10 s and 100 steps: tip still within 1e-3 m, elongation 0.1 m within 1e-3 m",
                     Solvers::all,
                     {ratio_0},
                     [h = h](const Configuration& c, const Effort&) { return hang(c, h); }});
  for (const int turns : {1, 2})
    cases.push_back(
        {fmt::format("twist-{}", turns), fmt::format("bar's ends turned by +-{} turns, held, one released", turns),
         "finite; held: R still within 1e-2 rad, speed <= 1e-3 m/s; 20 s after release rms to rest <= 1e-3 m",
         Solvers::all, ratios(Ratios::three),
         [turns](const Configuration& c, const Effort&) { return twist(c, turns); }});
}

}  // namespace corotet::program::stress
