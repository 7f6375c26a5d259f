// Bodies that touch obstacles: hard, fast, deep, squeezed, under great weights.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "../failure.hpp"
#include "case.hpp"
#include "test_body.hpp"

namespace corotet::program::stress {
namespace {

constexpr double standard_g = 9.81;  // m/s^2
constexpr double edge = 0.4;         // of the cube, m

/// Its least corner at 0, cut as finely in vertices with either element.
MeshData brick(int order, const Vec3<double>& size, std::array<Index, 3> cells) {
  if (order == 2)
    for (Index& n : cells) n = (n + 1) / 2;
  return require(make_block({.size = size, .cells = cells, .order = order}));
}
MeshData cube(int order) { return brick(order, Vec3<double>::Constant(edge), {4, 4, 4}); }

/// With weight. The second order formula keeps slow motion: with it, bodies are damped.
Scene heavy_scene(const Configuration& configuration, double young) {
  Scene scene = configuration.scene();
  scene.material.young = young;
  scene.gravity = {0, 0, -standard_g};
  if (configuration.stepping == Stepping::bdf2) scene.damping.mass = 2;
  return scene;
}

double mass_of(TestBody& trial) { return trial.body().facts().mass; }

/// At the end: nothing moves, the floor carries the weight, nothing is inside.
void expect_rest(TestBody& trial, double weight, CaseResult& verdict) {
  verdict.at_most("speed at the end, m/s", trial.max_speed(), 1e-3);
  verdict.at_most("force less the weight, of it", std::fabs(trial.contact().normal_force / weight - 1), 1e-3);
  verdict.at_most("depth at the end, of the size", trial.contact().deepest / edge, 1e-5);
}

/// Moves so that the lowest vertex is `height` above z = 0, after a turn about the centre.
void place_above(TestBody& trial, const Mat3<double>& turn, double height) {
  const Vec3<double> centre = trial.centre();
  double low = 0;
  for (Index v = 0; v < trial.vertices(); ++v) low = std::min(low, (turn * (trial.rest(v) - centre)).z());
  trial.place([&](Index v) {
    return Vec3<double>(turn * (trial.rest(v) - centre) + Vec3<double>(centre.x(), centre.y(), height - low));
  });
}

const Mat3<double>& onto_corner() {
  static const Mat3<double> turn = rotation_by({0, 0.5, 0}) * rotation_by({0.4, 0, 0});
  return turn;
}

/// Falls, tumbles and rests. `spin`: rad/s about y.
CaseResult fall(const Configuration& configuration, double young, double spin) {
  TestBody trial(heavy_scene(configuration, young), cube(configuration.order));
  trial.touch({.friction = 0.5});
  trial.obstacles.add(HalfSpace{});
  place_above(trial, onto_corner(), 0.3);
  const Vec3<double> centre = trial.centre();
  if (spin > 0)
    trial.push(
        [&](Index v) { return Vec3<double>(Vec3<double>(0, spin, 0).cross(trial.body().position(v) - centre)); });
  const double unit = mass_of(trial) * standard_g * edge, start = trial.energy();
  double highest = start, deepest = 0;
  trial.run(480, [&] {
    highest = std::max(highest, trial.energy());
    deepest = std::max(deepest, trial.contact().deepest);
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("energy above that at the start, of m g L", (highest - start) / unit, 0.03);
  verdict.at_most("deepest, of the size", deepest / edge, 0.1);
  expect_rest(trial, mass_of(trial) * standard_g, verdict);
  return verdict;
}

/// Two walls come together to `part` of the length and part again.
CaseResult squeeze(const Configuration& configuration, double young, double part) {
  Scene scene = configuration.settling_scene();
  scene.material.young = young;
  TestBody trial(scene, cube(configuration.order));
  trial.touch({.friction = 0.5});
  for (const double side : {1.0, -1.0})
    trial.obstacles.add(OrientedBox{{0.1, 1, 1}}, {.pose = {.position = {side > 0 ? -0.1 : edge + 0.1, 0, 0}}});
  double deepest = 0;
  const auto lead = [&](double speed, double seconds) {
    trial.obstacles[0].velocity = {speed, 0, 0};
    trial.obstacles[1].velocity = {-speed, 0, 0};
    trial.run(static_cast<int>(seconds * 60), [&] {
      deepest = std::max(deepest, trial.contact().deepest);
      return false;
    });
  };
  CaseResult verdict;
  lead((1 - part) * edge / 2, 1);
  lead(0, 4);
  verdict.at_most("deepest while walls move, of the size", deepest / edge, 0.02);
  verdict.at_most("depth between walls at rest, of the size", trial.contact().deepest / edge, 1e-5);
  verdict.at_most("inverted elements", trial.last().inverted_elements, 0);
  lead(-(1 - part) * edge / 2, 1.2);
  lead(0, 2);
  trial.report_to(verdict);
  verdict.at_most("largest strain at the end", trial.last().max_strain, 1e-3);
  return verdict;
}

/// A thousand times the thickness of the plate in a step.
CaseResult strike_plate(const Configuration& configuration, double young) {
  constexpr double thickness = 0.002, speed = 100;
  TestBody trial(heavy_scene(configuration, young),
                 brick(configuration.order, Vec3<double>::Constant(edge / 2), {4, 4, 4}));
  trial.touch({.friction = 0.5});
  trial.obstacles.add(OrientedBox{{50, 50, thickness / 2}});
  place_above(trial, Mat3<double>::Identity(), 0.7);
  trial.push([](Index) { return Vec3<double>(0, 0, -speed); });
  const double start = trial.energy();
  double highest = start;
  trial.run(60, [&] {
    highest = std::max(highest, trial.energy());
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  int through = 0;
  for (Index v = 0; v < trial.vertices(); ++v)
    if (trial.body().position(v).z() < -thickness / 2) ++through;
  verdict.at_most("vertices through the plate", through, 0);
  verdict.at_most("energy above that at the start, of it", highest / start - 1, 1e-3);
  return verdict;
}

/// A free rigid box lies on a cube on a floor.
CaseResult carry(const Configuration& configuration, double mass_ratio) {
  // The heavy one presses the cube by 4 %.
  TestBody trial(heavy_scene(configuration, mass_ratio > 1 ? 1e8 : 5e5), cube(configuration.order));
  trial.touch({.friction = 0.5});
  trial.obstacles.gravity = {0, 0, -standard_g};
  trial.obstacles.add(HalfSpace{});
  const double mass = mass_ratio * mass_of(trial), height = edge + 0.1;
  trial.obstacles.add(OrientedBox{{0.25, 0.25, 0.1}},
                      {.pose = {.position = {edge / 2, edge / 2, height}}, .mass = mass});
  const Obstacle& box = trial.obstacles[1];
  trial.run(600);
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("speed of the box, m/s", box.velocity.norm(), 1e-3);
  verdict.at_most("box off its axis, of the size",
                  std::hypot(box.pose().position.x() - edge / 2, box.pose().position.y() - edge / 2) / edge, 0.01);
  verdict.at_least("height of the box, of that at rest", box.pose().position.z() / height, 0.9);
  const double borne = (box.load().impulse / trial.dt()).z();
  verdict.at_most("force on the box less its weight, of it", std::fabs(borne / (mass * standard_g) - 1), 1e-3);
  return verdict;
}

/// The floor, a ball, a box and a capsule anywhere, led or free, and a cube that flies in among them.
CaseResult random_shapes(const Configuration& configuration, int scenes) {
  CaseResult verdict;
  std::mt19937 engine(1);
  const auto uniform = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(engine()) / 4294967296.0;
  };
  const auto vector = [&](double size) {
    return Vec3<double>{uniform(-size, size), uniform(-size, size), uniform(-size, size)};  // in this order
  };
  double deepest = 0, fastest = 0;
  for (int k = 0; k < scenes; ++k) {
    Scene scene = heavy_scene(configuration, std::pow(10, uniform(4, 8)));
    TestBody trial(scene, brick(configuration.order, Vec3<double>::Constant(edge), {3, 3, 3}));
    trial.touch({.friction = uniform(0, 1.5)});
    trial.obstacles.gravity = scene.gravity;
    trial.obstacles.add(HalfSpace{});
    const auto some = [&] {
      return ObstacleOptions{.pose = {Vec3<double>{uniform(-0.4, 0.8), uniform(-0.4, 0.8), uniform(0, 0.6)},
                                      quaternion_of(rotation_by(vector(3)))},
                             .velocity = vector(0.5),
                             .angular_velocity = vector(2),
                             .friction = uniform(-1, 1),
                             .mass = uniform(0, 1) < 0.5 ? 0 : std::pow(10, uniform(0, 3))};
    };
    trial.obstacles.add(Sphere{uniform(0.05, 0.2)}, some());
    trial.obstacles.add(OrientedBox{{0.1, 0.2, uniform(0.02, 0.2)}}, some());
    trial.obstacles.add(Capsule{uniform(0.03, 0.1), 0.2}, some());
    place_above(trial, rotation_by(vector(3)), 0.6);
    const Vec3<double> velocity = vector(2) - Vec3<double>(0, 0, 3), spin = vector(4), centre = trial.centre();
    trial.push([&](Index v) { return Vec3<double>(velocity + spin.cross(trial.body().position(v) - centre)); });
    trial.run(60, [&] {
      for (Index v = 0; v < trial.vertices(); ++v) deepest = std::max(deepest, -trial.body().position(v).z());
      fastest = std::max(fastest, trial.max_speed());
      return false;
    });
    trial.report_to(verdict);
  }
  verdict.at_most("deepest in the floor, of the size", deepest / edge, 0.05);
  verdict.at_most("fastest, m/s", fastest, 100);
  return verdict;
}

/// Half of the body begins in the floor.
CaseResult start_deep(const Configuration& configuration, double young) {
  TestBody trial(heavy_scene(configuration, young), cube(configuration.order));
  trial.touch({.friction = 0.5});
  trial.obstacles.add(HalfSpace{});
  place_above(trial, Mat3<double>::Identity(), -edge / 2);
  double fastest = 0;
  const double mass = mass_of(trial);
  trial.run(480, [&] {
    fastest = std::max(fastest, trial.momentum().z() / mass);
    return false;
  });
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("speed out of the floor, m/s", fastest, 1.2);
  expect_rest(trial, mass * standard_g, verdict);
  return verdict;
}

/// A rod is led across a cube that is held below: in at one side and out at the other.
CaseResult lead_through(const Configuration& configuration) {
  Scene scene = configuration.settling_scene();
  TestBody trial(scene, cube(configuration.order));
  trial.touch({.friction = 0.5});
  trial.pin([](const Vec3<double>& x) { return x.z() < 1e-9; });
  // Across y.
  const Index rod = trial.obstacles.add(Capsule{0.06, 1},
                                        {.pose = {.position = {-0.2, edge / 2, 0.3},
                                                  .rotation = quaternion_of(rotation_by({std::numbers::pi / 2, 0, 0}))},
                                         .velocity = {0.8, 0, 0}});
  double fastest = 0;
  trial.run(60, [&] {
    fastest = std::max(fastest, trial.max_speed());
    return false;
  });
  trial.obstacles[rod].enabled = false;
  trial.run(300);
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("fastest, m/s", fastest, 100);
  verdict.at_most("rms to rest, m", trial.rms_to_rest(), 1e-3);
  return verdict;
}

Scene slab_scene(const Configuration& configuration, double slope) {
  Scene scene = configuration.settling_scene();
  scene.material.young = 5e6;
  scene.gravity = {standard_g * std::sin(slope), 0, -standard_g * std::cos(slope)};
  return scene;
}

/// Without friction nothing brakes a slab, and nothing turns it.
CaseResult slide_freely(const Configuration& configuration) {
  Scene scene = slab_scene(configuration, 0);
  scene.damping.mass = 0;  // which would brake it
  TestBody trial(scene, brick(configuration.order, {0.4, 0.4, 0.1}, {4, 4, 2}));
  trial.touch({.friction = 0});
  trial.obstacles.add(HalfSpace{});
  trial.push([](Index) { return Vec3<double>(2, 1, 0); });
  trial.run(180);
  CaseResult verdict;
  trial.report_to(verdict);
  const Vec3<double> change = trial.momentum() / mass_of(trial) - Vec3<double>(2, 1, 0);
  verdict.at_most("change of the speed along the floor, m/s", std::hypot(change.x(), change.y()), 1e-4);
  return verdict;
}

/// On a slope of 0.95 of its friction, 2.
CaseResult hold_on_slope(const Configuration& configuration) {
  TestBody trial(slab_scene(configuration, std::atan(1.9)), brick(configuration.order, {0.4, 0.4, 0.1}, {4, 4, 2}));
  trial.touch({.friction = 2});
  trial.obstacles.add(HalfSpace{});
  trial.run(480);
  const Vec3<double> before = trial.centre();
  trial.run(60);
  CaseResult verdict;
  trial.report_to(verdict);
  verdict.at_most("creep, m/s", (trial.centre() - before).norm(), 1e-5);
  return verdict;
}

}  // namespace

void add_contact_cases(std::vector<Case>& cases) {
  const auto add_with = [&](Solvers solvers, std::string name, std::string set_up, const char* criterion, auto run) {
    cases.push_back({std::move(name), std::move(set_up), criterion, solvers, ratios(Ratios::three), std::move(run)});
  };
  const auto add = [&](std::string name, std::string set_up, const char* criterion, auto run) {
    add_with(Solvers::all, std::move(name), std::move(set_up), criterion, std::move(run));
  };
  // Direct solvers cannot move free obstacles.
  const auto add_free = [&](std::string name, std::string set_up, const char* criterion, auto run) {
    add_with(Solvers::iterative, std::move(name), std::move(set_up), criterion, std::move(run));
  };
  constexpr std::array stiffnesses{std::pair{"5e5", 5e5}, std::pair{"5e7", 5e7}, std::pair{"1e9", 1e9}};
  constexpr const char* rests =
      "energy never above that at the start by 0.03 m g L, depth <= 0.1 L; after 480 steps <= 1e-3 m/s, the floor's "
      "force is the weight within 1e-3, depth <= 1e-5 L";
  for (const auto& [text, young] : stiffnesses)
    add(fmt::format("contact-corner-{}", text), fmt::format("cube falls 0.3 m onto its corner, E = {} Pa", text), rests,
        [young = young](const Configuration& c, const Effort&) { return fall(c, young, 0); });
  add("contact-spin", "the same at 5e6 Pa, spinning at 20 rad/s", rests,
      [](const Configuration& c, const Effort&) { return fall(c, 5e6, 20); });
  for (const auto& [text, young] : stiffnesses) {
    const double part = young > 1e8 ? 0.95 : 0.7;
    add(fmt::format("contact-squeeze-{}", text),
        fmt::format("walls squeeze a cube to {} of its length and part, E = {} Pa", part, text),
        "depth <= 0.02 L while walls move, 1e-5 L after 4 s at rest, nothing inverted; free again, strain <= 1e-3",
        [young = young, part](const Configuration& c, const Effort&) { return squeeze(c, young, part); });
  }
  for (const auto& [text, young] : {stiffnesses[0], stiffnesses[2]})
    add(fmt::format("contact-plate-{}", text),
        fmt::format("cube of 0.2 m meets a plate of 2 mm at 100 m/s, E = {} Pa", text),
        "no vertex goes through, energy does not rise by 1e-3 of it",
        [young = young](const Configuration& c, const Effort&) { return strike_plate(c, young); });
  for (const auto& [text, ratio] : {std::pair{"heavy", 1e3}, std::pair{"light", 1e-3}})
    add_free(
        fmt::format("contact-crate-{}", text),
        fmt::format("free rigid box of {} times the mass of a cube lies on it, on a floor", ratio),
        "600 steps: the box rests, <= 1e-3 m/s, within 0.01 L of its axis and a tenth of its height; its force is its "
        "weight within 1e-3",
        [ratio = ratio](const Configuration& c, const Effort&) { return carry(c, ratio); });
  add_free("contact-random", "cubes of E 1e4 to 1e8 fly among balls, boxes and capsules, led and free, anywhere",
           "finite, depth in the floor <= 0.05 L, <= 100 m/s", [](const Configuration& c, const Effort& effort) {
             return random_shapes(c, std::max(2, effort.seeds / 20));
           });
  for (const auto& [text, young] : {stiffnesses[0], stiffnesses[2]})
    add(fmt::format("contact-deep-{}", text), fmt::format("half of a cube begins in the floor, E = {} Pa", text),
        "leaves it at <= 1.2 m/s; after 480 steps as contact-corner",
        [young = young](const Configuration& c, const Effort&) { return start_deep(c, young); });
  add("contact-led", "rod of 12 cm is led across a cube of 40 cm that is held below, and taken away",
      "finite, <= 100 m/s; then rms to rest <= 1e-3 m",
      [](const Configuration& c, const Effort&) { return lead_through(c); });
  add("contact-slide-0", "slab slides on a floor without friction, 180 steps", "keeps its speed within 1e-4 m/s",
      [](const Configuration& c, const Effort&) { return slide_freely(c); });
  add("contact-slide-2", "slab on a slope of tangent 1.9 with friction 2, 540 steps", "creeps at <= 1e-5 m/s",
      [](const Configuration& c, const Effort&) { return hold_on_slope(c); });
}

}  // namespace corotet::program::stress
