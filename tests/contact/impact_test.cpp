// Bodies that fall, fly and bounce: nothing goes through, and no energy comes from nowhere.
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/scene.hpp"

namespace corotet::contact_impact_test {
namespace {

using namespace contact_scene;

struct Bounce {
  double rebound;     // speed after it to that before
  double max_energy;  // to that before
};

/// A bar of 20 cells along its way meets a wall with its end at 1 m/s; nu = 0: a wave in one dimension.
Bounce bounce(const Method& method, double young, double h) {
  SceneOptions options;
  options.block.size = {0.2, 0.2, 1};
  options.block.cells = {method.cells(4), method.cells(4), method.cells(20)};
  options.material = {.young = young, .poisson = 0, .density = 1000};
  options.contact.friction = 0;
  auto scene = make_scene(method, options);
  scene->obstacles.add(HalfSpace{});
  scene->throw_with(constant({0, 0, -1}));
  const double start = scene->kinetic_energy(), transit = 2 / std::sqrt(young / 1000);
  double most = 0;
  for (double t = 0; t < 4 * transit + 20 * h; t += h) {
    EXPECT_TRUE(scene->step(h).accepted());
    most = std::max(most, (scene->kinetic_energy() + scene->elastic_energy()) / start);
  }
  EXPECT_EQ(scene->report().touching, 0);
  return {scene->mean_velocity().z(), most};
}

/// What backward Euler keeps of the speed with exact contact, found by a solution of the complementarity problem of
/// the same bar; BDF2 keeps more. The continuum keeps all.
TEST(ContactImpact, ABarBouncesAsItsIntegratorLetsIt) {
  const Bounce soft = bounce(euler, 5e5, 0.004), stiff = bounce(euler, 5e7, 0.004);
  EXPECT_NEAR(soft.rebound, 0.6629, 0.02);
  EXPECT_NEAR(stiff.rebound, 0.1523, 0.02);
  const Bounce second = bounce(bdf2, 5e5, 0.004), coarse = bounce(bdf2, 5e5, 1.0 / 60);
  EXPECT_GT(second.rebound, 0.85);
  EXPECT_GT(coarse.rebound, 0.55);
  const Bounce quadratic = bounce({Kind::double_tet10_euler, true}, 5e5, 0.004);
  EXPECT_NEAR(quadratic.rebound, 0.6629, 0.02);
  for (const Bounce& b : {soft, stiff, second, coarse, quadratic}) {
    EXPECT_LE(b.max_energy, 1 + 1e-6);
    EXPECT_LE(b.rebound, 1);
  }
}

/// Turned so that it falls onto a corner, which is `height` above the floor.
Map on_corner(double height) {
  const Mat3<double> turn = rotation_by({0, 0.5, 0}) * rotation_by({0.4, 0, 0});
  double low = 0;
  for (int corner = 0; corner < 8; ++corner)
    low = std::min(low, V(turn * (0.2 * V(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1))).z());
  return [turn, low, height](const V& x) -> V { return turn * (x - V::Constant(0.2)) + V(0, 0, height - low); };
}

/// A cube that falls onto a corner comes to rest. In no step does its mechanical energy gain more than a small part of
/// m g L: that of straight lines in a stiff body that turns, in which there is elastic energy that is none.
TEST(ContactImpact, ACubeFallsOnItsCornerAndRests) {
  for (const Method& method : {euler, Method{Kind::double_tet10_euler, false}})
    for (const auto& [young, most] : {std::pair(5e5, 0.03), std::pair(5e7, 0.03), std::pair(1e9, 0.6)}) {
      auto scene = on_floor(method, cube(method, 4, young));
      scene->place(on_corner(0.3));
      const double unit = scene->total_mass() * g * 0.4;
      double before = scene->mechanical_energy(), gain = 0;
      const double start = before;
      for (int i = 0; i < 300; ++i) {
        ASSERT_TRUE(scene->step().accepted());
        const double now = scene->mechanical_energy();
        gain = std::max(gain, now - before);
        EXPECT_LT(now, start + 0.01 * unit) << "step " << i;
        before = now;
      }
      EXPECT_LT(gain, most * unit) << young;
      EXPECT_LT(scene->fastest(), 1e-3) << young;
      EXPECT_NEAR(scene->report().normal_force, scene->total_mass() * g, 1e-3 * scene->total_mass() * g);
      EXPECT_LT(scene->report().deepest, 1e-5);
    }
}

/// A hundred metres a second onto a plate of 2 mm: a thousand times its thickness in a step. Springs give way by more
/// than that at first, but points know from which side they came.
TEST(ContactImpact, NothingGoesThroughAThinPlate) {
  for (const double young : {5e5, 1e9})
    for (const Method& method : {euler, Method{Kind::double_tet10_euler, false}, bdf2}) {
      SceneOptions options = cube(method, 4, young);
      options.block.size = V::Constant(0.2);
      auto scene = make_scene(method, options);
      scene->set_gravity({0, 0, -g});
      scene->obstacles.add(OrientedBox{{50, 50, 0.001}});
      scene->place(moved_by({0, 0, 0.7}));
      scene->throw_with(constant({0, 0, -100}));
      double deepest = 0;
      for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(scene->step().accepted()) << young << ", step " << i;
        deepest = std::max(deepest, scene->report().deepest);
      }
      for (Index v = 0; v < scene->vertex_count(); ++v)
        EXPECT_GT(scene->position(v).z(), -0.001) << name_of(method) << ", " << young << ", vertex " << v;
      EXPECT_LT(deepest, 0.1);  // half of the body
    }
}

/// A body that starts far inside the floor is led out at max_depenetration: 1 m/s. A stiff one and a soft one.
TEST(ContactImpact, ABodyThatStartsDeepLeavesSlowly) {
  for (const double young : {5e5, 5e7})
    for (const Method& method : {euler, Method{Kind::double_tet10_euler, true}}) {
      auto scene = on_floor(method, cube(method, 3, young));
      scene->place(moved_by({0, 0, -0.15}));
      double fastest = 0;
      for (int i = 0; i < 240; ++i) {
        ASSERT_TRUE(scene->step().accepted());
        fastest = std::max(fastest, scene->mean_velocity().z());
      }
      EXPECT_LT(fastest, 1.1) << young;
      EXPECT_GT(fastest, 0.5) << young;
      EXPECT_LT(scene->report().deepest, 1e-6);
      EXPECT_LT(scene->fastest(), 1e-3);
    }
}

/// A ball of a warped cube.
SceneOptions ball(const Method& method, double radius, Index cells, double young) {
  SceneOptions options = cube(method, cells, young);
  options.block.corner = V::Constant(-radius);
  options.block.size = V::Constant(2 * radius);
  options.warp = [](const V& p) -> V {
    const double r = p.norm();
    return r > 0 ? V(p * (p.cwiseAbs().maxCoeff() / r)) : p;
  };
  return options;
}

/// A ball that rolls without sliding goes on: after a second with as much of its speed.
TEST(ContactImpact, ABallRollsOn) {
  constexpr double radius = 0.2, speed = 2;
  for (const double young : {5e5, 5e6}) {
    auto scene = make_scene(euler, ball(euler, radius, 8, young));
    scene->obstacles.add(HalfSpace{{0, 0, 1}, -radius});
    scene->set_gravity({0, 0, -g});
    scene->run(1);
    const V centre = scene->centre();
    scene->throw_with([&](const V& x) -> V { return V(speed, 0, 0) + V(0, speed / radius, 0).cross(x - centre); });
    scene->run(1);
    EXPECT_GT(scene->mean_velocity().x(), 0.95 * speed) << young;
    EXPECT_LT(scene->mean_velocity().x(), 1.05 * speed) << young;
    EXPECT_LT(std::fabs(scene->mean_velocity().y()), 0.05 * speed) << young;
    EXPECT_NEAR(scene->centre().x() - centre.x(), speed, 0.1 * speed);
  }
}

/// A soft ball that falls on each shape is pierced by none: obstacles that are wider than its points are apart.
TEST(ContactImpact, NoShapePiercesASoftBall) {
  const auto expect_whole = [](const auto& shape, double top, const char* name) {
    for (const Method& method : {euler, Method{Kind::float_tet10_bdf2, false}}) {
      auto scene = make_scene(method, ball(method, 0.2, 5, 5e4));
      scene->set_gravity({0, 0, -g});
      scene->obstacles.add(shape);
      scene->obstacles.add(HalfSpace{{0, 0, 1}, -1});
      scene->place(moved_by({0.01, 0.02, top + 0.3}));
      double deepest = 0;
      bool has_touched = false;
      for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(scene->step().accepted()) << name;
        for (Index v = 0; v < scene->vertex_count(); ++v)
          deepest = std::max(deepest, -scene->obstacles[0].distance(scene->position(v)).distance);
        has_touched = has_touched || scene->report().touching > 0;
      }
      EXPECT_TRUE(has_touched) << name;
      EXPECT_LT(deepest, 0.01 * 0.4) << name << ", " << name_of(method);
    }
  };
  expect_whole(HalfSpace{{0.2, 0, 1}, 0}, 0, "half-space");
  expect_whole(Sphere{0.2}, 0.2, "sphere");
  expect_whole(OrientedBox{{0.3, 0.15, 0.1}}, 0.1, "box");
  expect_whole(Capsule{0.15, 0.1}, 0.25, "capsule");
  expect_whole(
      [](const V& p) -> SurfaceDistance {  // a hill on the ground
        const SurfaceDistance hill = Sphere{0.2}(p), ground = HalfSpace{{0, 0, 1}, -0.1}(p);
        return hill.distance < ground.distance ? hill : ground;
      },
      0.2, "functor");
}

}  // namespace
}  // namespace corotet::contact_impact_test
