// Laws that hold in any scene with contact, in random ones: and what a scene must not depend on.
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "contact/scene.hpp"
#include "support/random.hpp"

namespace corotet::contact_random_test {
namespace {

using namespace contact_scene;

class ContactRandom : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactRandom, all_methods, by_name);

/// A cube of any stiffness, position and speed among obstacles of any shape and motion.
std::unique_ptr<Scene> some_scene(const Method& method, testing::Random& random, bool keeps_angular_momentum = true) {
  SceneOptions options = cube(method, 3, std::pow(10, random.uniform(4, 8)));
  options.contact.friction = random.uniform(0, 1.5);
  options.keeps_angular_momentum = keeps_angular_momentum;
  options.material.poisson = random.uniform(0, 0.45);
  auto scene = on_floor(method, options);
  const auto some_pose = [&] {
    return ObstacleOptions{.pose = {V(random.uniform(-0.4, 0.8), random.uniform(-0.4, 0.8), random.uniform(0, 0.6)),
                                    quaternion_of(random.rotation())},
                           .velocity = random.vector(0.5),
                           .angular_velocity = random.vector(2),
                           .friction = random.uniform(-1, 1),
                           .mass = random.uniform() < 0.5 ? 0 : std::pow(10, random.uniform(0, 3))};
  };
  scene->obstacles.add(Sphere{random.uniform(0.05, 0.2)}, some_pose());
  scene->obstacles.add(OrientedBox{{0.1, 0.2, random.uniform(0.02, 0.2)}}, some_pose());
  scene->obstacles.add(Capsule{random.uniform(0.03, 0.1), 0.2}, some_pose());
  const Mat3<double> turn = random.rotation();
  scene->place(
      [&](const V& x) -> V { return turn * (x - V::Constant(0.2)) + V(0.2, 0.2, random.uniform(0.9, 0.9001)); });
  const V velocity = random.vector(2) - V(0, 0, 3), spin = random.vector(4);
  const V centre = scene->centre();
  scene->throw_with([&](const V& x) -> V { return velocity + spin.cross(x - centre); });
  return scene;
}

/// No touch pulls, none is outside the cone of friction; states stay finite. (Where a body keeps its angular momentum,
/// the spin that a step lacks is shared with its contacts, whatever these may bear.)
TEST_P(ContactRandom, NoTouchPullsOrLeavesItsCone) {
  testing::Random random(1);
  int touches = 0, sliding = 0;
  double worst_pull = 0, worst_cone = 0;
  for (int k = 0; k < 8; ++k) {
    auto scene = some_scene(method(), random, false);
    const auto friction_of = [&](Index obstacle) {
      const double own = scene->obstacles[obstacle].friction;
      return own >= 0 ? own : scene->friction;
    };
    for (int i = 0; i < 40; ++i) {
      const StepReport report = scene->step();
      ASSERT_TRUE(report.accepted()) << "scene " << k << ", step " << i << ": " << report.advice();
      double largest = 0;
      for (const Touch& touch : scene->touches()) largest = std::max(largest, touch.impulse.norm());
      for (const Touch& touch : scene->touches()) {
        ++touches;
        sliding += touch.slides;
        EXPECT_NEAR(touch.normal.norm(), 1, 1e-9);
        const double normal = touch.normal.dot(touch.impulse);
        const double tangential = (touch.impulse - normal * touch.normal).norm();
        worst_pull = std::max(worst_pull, -normal / largest);
        worst_cone = std::max(worst_cone, (tangential - friction_of(touch.obstacle) * normal) / largest);
      }
    }
    EXPECT_LT(scene->fastest(), 100);
  }
  EXPECT_GT(touches, 300);
  EXPECT_GT(sliding, 100);
  EXPECT_LT(worst_pull, 1e-9);
  EXPECT_LT(worst_cone, 1e-9);
}

/// At the end of each step no vertex is deep inside the floor, however it came down.
TEST_P(ContactRandom, NothingSinksIntoTheFloor) {
  testing::Random random(2);
  double deepest = 0;
  for (int k = 0; k < 3; ++k) {
    auto scene = some_scene(method(), random);
    for (Index o = 1; o < scene->obstacles.size(); ++o) scene->obstacles[o].enabled = false;
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(scene->step().accepted());
      for (Index v = 0; v < scene->vertex_count(); ++v) deepest = std::max(deepest, -scene->position(v).z());
    }
  }
  EXPECT_LT(deepest, 0.02 * 0.4);
}

/// The world turned, with all in it: the same motion, turned.
TEST_P(ContactRandom, NoDirectionIsSpecial) {
  testing::Random random(3);
  const Mat3<double> turn = rotation_by({0, 0, 1.1}) * rotation_by({0.8, 0, 0});
  const auto run = [&](const Mat3<double>& q) {
    SceneOptions options = cube(method(), 3, 1e6);
    options.tolerance = 1e-7;
    auto scene = make_scene(method(), options);
    scene->set_gravity(q * V(0, 0, -g));
    scene->obstacles.add(HalfSpace{q * V(0.3, 0, 1), 0});
    scene->place([&](const V& x) -> V { return q * (x + V(0, 0, 0.05)); });
    scene->run(0.4);
    return V(q.transpose() * scene->centre());
  };
  const V straight = run(Mat3<double>::Identity()), turned = run(turn);
  EXPECT_LT((straight - turned).norm(), method().is_float() ? 1e-3 : 1e-4);
}

/// A body of two pieces that do not touch, on one floor: each moves as alone, bit for bit.
TEST_P(ContactRandom, PiecesOnOneFloorMoveAsAlone) {
  BlockOptions near{.corner = {0, 0, 0.02}, .size = {0.3, 0.3, 0.3}, .cells = {2, 2, 2}};
  BlockOptions far{.corner = {1, 0, 0.1}, .size = {0.2, 0.4, 0.2}, .cells = {1, 2, 1}};
  const auto scene_of = [&](const BlockOptions& first, std::vector<BlockOptions> others) {
    SceneOptions options;
    options.block = first;
    options.pieces = std::move(others);
    options.material.young = 1e6;
    auto scene = on_floor(method(), options);
    scene->throw_with([](const V& x) -> V { return x.x() < 0.7 ? V(1, 0, 0) : V(0, -1, 0.5); });
    return scene;
  };
  auto both = scene_of(near, {far}), first = scene_of(near, {}), second = scene_of(far, {});
  ASSERT_EQ(both->vertex_count(), first->vertex_count() + second->vertex_count());
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(both->step().accepted() && first->step().accepted() && second->step().accepted());
    int different = 0;
    for (Index v = 0; v < both->vertex_count(); ++v) {
      const V x = both->rest(v);
      const Scene& alone = x.x() < 0.7 ? *first : *second;
      Index same = 0;
      while ((alone.rest(same) - x).norm() > 1e-6) ++same;
      different += both->position(v) != alone.position(same) || both->velocity(v) != alone.velocity(same);
    }
    ASSERT_EQ(different, 0) << "step " << i;
    EXPECT_EQ(both->touches().size(), first->touches().size() + second->touches().size());
    EXPECT_EQ(both->report().touching, first->report().touching + second->report().touching);
    EXPECT_EQ(both->report().passes, std::max(first->report().passes, second->report().passes));
    EXPECT_NEAR(both->report().normal_force, first->report().normal_force + second->report().normal_force, 1e-9);
  }
}

/// A block loses its floor in the ways that there are, and falls as a free one does.
TEST_P(ContactRandom, WithoutItsFloorABlockFalls) {
  for (int way = 0; way < 3; ++way) {
    auto scene = on_floor(method(), cube(method(), 2, 5e6));
    scene->run(0.5);
    EXPECT_GT(scene->report().touching, 0);
    const double before = scene->mean_velocity().z();
    if (way == 0) scene->obstacles[0].enabled = false;
    if (way == 1) scene->obstacles[0].set_pose({.position = {0, 0, -10}});
    if (way == 2) {
      scene->place(moved_by({0, 0, 5}));
      scene->reset_contacts();
    }
    scene->run(0.1);
    EXPECT_EQ(scene->report().touching, 0) << way;
    EXPECT_TRUE(scene->touches().empty());
    const double speed = scene->mean_velocity().z();
    // BDF2 takes a force that is suddenly gone for one that ends half a step later.
    const double late = method().is_bdf2() ? g * frame_time / 2 : 0;
    EXPECT_LT(speed, before - 0.1 * g + late + 2e-3) << way;
    EXPECT_GT(speed, before - 0.1 * g - 2e-3) << way;
    if (way > 0) continue;
    scene->obstacles[0].enabled = true;  // it is pushed out gently
    scene->run(2);
    EXPECT_NEAR(scene->report().normal_force, scene->total_mass() * g, 0.02 * scene->total_mass() * g);
  }
}

}  // namespace
}  // namespace corotet::contact_random_test
