// Ten thousand steps: energy that grows, drift and jitter show in the end.
#include <algorithm>
#include <cmath>
#include <corotet/detail/rotation/quaternion.hpp>
#include <numbers>
#include <vector>

#include "case.hpp"
#include "energy_watch.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

/// A bar five times as long as thick slips by a whole turn when it is turned this far, on any mesh: some elements turn
/// inside out, the law gives way, and the bar rests with a turn left in it. Up to 1.75 turns it does not.
constexpr double slipping_turns = 2;

/// Falls under gravity and swings. The scale is the kinetic energy of its first swing.
CaseResult swing(const Configuration& configuration, int steps) {
  Scene scene = configuration.scene();
  scene.gravity = {0, 0, -9.81};
  TestBody trial(scene, coarse_bar(configuration.order));
  trial.pin(at_left_end);
  EnergyWatch energy(trial.energy());
  double scale = 0;
  trial.run(steps, [&] {
    energy.see(trial.energy());
    scale = std::max(scale, trial.kinetic_energy());
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("rise of the energy, of the swing's", energy.rise() / scale, 1e-3);
  return verdict;
}

CaseResult spin_long(const Configuration& configuration, int steps) {
  const Scene scene = configuration.scene();
  TestBody trial(scene, coarse_block(configuration.order));
  const Vec3<double> centre = trial.centre();
  trial.push([&](Index v) { return Vec3<double>(0, 0, 0.1 / scene.dt).cross(trial.rest(v) - centre); });
  const double at_first = trial.energy(), momentum = trial.angular_momentum().norm();
  EnergyWatch energy(at_first);
  double highest = at_first;
  const auto see = [&] {
    energy.see(trial.energy());
    highest = std::max(highest, trial.energy());
    return false;
  };
  trial.run(100, see);
  EnergyWatch later(trial.energy());
  trial.run(steps - 100, [&] {
    later.see(trial.energy());
    return see();
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("rise of the energy", energy.rise() / at_first, 1e-3);
  verdict.note("above that at the start", highest / at_first - 1);
  verdict.note("after 100 steps", later.rise() / at_first);
  verdict.note("angular momentum kept", trial.angular_momentum().norm() / momentum);
  return verdict;
}

/// Comes to rest under gravity, damped (2/s M); then it must stay there.
CaseResult rest(const Configuration& configuration, int steps) {
  Scene scene = configuration.scene();
  scene.gravity = {0, 0, -9.81};
  scene.damping.mass = 2;
  TestBody trial(scene, coarse_block(configuration.order));
  trial.pin(at_left_end);
  trial.run(1200);
  Field<double> settled;
  for (Index v = 0; v < trial.vertices(); ++v) settled.push_back(trial.body().displacement(v));
  double drift = 0, jitter = 0;
  trial.run(steps, [&] {
    jitter = std::max(jitter, trial.max_speed() * scene.dt);
    for (Index v = 0; v < trial.vertices(); ++v)
      drift = std::max(drift, (trial.body().displacement(v) - settled[at(v)]).norm());
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("drift, of the size", drift, 1e-6);
  verdict.at_most("motion in a step, of the size", jitter, 1e-6);
  return verdict;
}

/// One end is led around: turned to and fro, and sheared by half the length. Then it is held at rest again.
CaseResult lead(const Configuration& configuration, int steps, double turns) {
  const Scene scene = configuration.settling_scene();
  TestBody trial(scene, twisted_bar(configuration.order));
  trial.pin(at_left_end);
  const auto right = trial.pin(at_right_end);
  int inverted = 0;
  for (int i = 1; i <= steps; ++i) {
    const double t = 2 * std::numbers::pi * i / steps;
    for (const Index v : right) {
      const Vec3<double> arm(0, trial.rest(v).y(), trial.rest(v).z());
      const Vec3<double> shear(0, 0.5 * std::sin(2 * t), 0.25 * (1 - std::cos(3 * t)));
      trial.body().move_pin(
          v, rotation_by(2 * std::numbers::pi * turns * std::sin(t) * Vec3<double>::UnitX()) * arm - arm + shear);
    }
    if (!trial.step()) break;
    if (trial.last().inverted_elements > 0) ++inverted;
  }
  const double at_stop = trial.energy();
  EnergyWatch energy(at_stop);
  trial.run(600, [&] {
    energy.see(trial.energy());
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("rise of the energy after the pins stop, J", energy.rise(), 1e-3 * std::max(1.0, at_stop));
  verdict.at_most("motion in a step, of the size", trial.max_speed() * scene.dt, 1e-6);
  if (turns < slipping_turns)
    verdict.at_most("rms to rest", trial.rms_to_rest(), 1e-3);
  else
    verdict.note("rms to rest", trial.rms_to_rest());
  verdict.note("steps with inverted elements", inverted);
  verdict.note("inverted in the end", trial.last().inverted_elements);
  verdict.note("inside out at a corner", trial.folded_elements());
  return verdict;
}

CaseResult lead_1(const Configuration& configuration, int steps) { return lead(configuration, steps, 1.5); }
CaseResult lead_2(const Configuration& configuration, int steps) { return lead(configuration, steps, slipping_turns); }

}  // namespace

void add_endurance_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* name, const char* set_up, const char* criterion,
                       CaseResult (*run)(const Configuration&, int)) {
    cases.push_back({name, set_up, criterion, Solvers::two, ratios(Ratios::three),
                     [run](const Configuration& c, const Effort& effort) { return run(c, effort.long_steps); }});
  };
  add("long-swing", "bar held at one end falls and swings, no damping, 10,000 steps",
      "energy never rises above what it was by more than 1e-3 of the swing's", swing);
  add("long-spin", "free block spins, h omega = 0.1, 10,000 steps", "energy never rises by more than 1e-3 of it",
      spin_long);
  add("long-rest", "block at rest under gravity, damping 2/s M, 10,000 steps",
      "drift and motion in a step <= 1e-6 of its length", rest);
  add("long-lead-1",
      "bar, one end turned +-1.5 turns and sheared by half its length in 10,000 steps, then held for 600",
      "finite; then energy does not rise by 1e-3 of it, or 1e-3 J if that is more, motion in a step <= 1e-6 m, rms to "
      "rest <= 1e-3 m",
      lead_1);
  add("long-lead-2", "the same with +-2 turns, after which a bar may keep a whole turn",
      "finite; then energy does not rise by 1e-3 of it, or 1e-3 J if that is more, motion in a step <= 1e-6 m; rms to "
      "rest reported",
      lead_2);
}

}  // namespace corotet::program::stress
