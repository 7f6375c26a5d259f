// Bodies and rigid ones that move freely: carried, pushed, struck; nothing of their momenta is lost.
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/scene.hpp"

namespace corotet::contact_free_obstacle_test {
namespace {

using namespace contact_scene;

class ContactFree : public ByMethod {};
INSTANTIATE_TEST_SUITE_P(Methods, ContactFree, all_methods, by_name);

/// A rigid box on a column, nu = 0, presses it by m g h / (E A); the column weighs 128 kg, the box from a thousandth of
/// that to a thousand times as much.
TEST_P(ContactFree, ABoxOnAColumnPressesItByItsWeight) {
  for (const auto& [mass, young] : {std::pair(0.128, 5e5), std::pair(40.0, 5e5), std::pair(128e3, 1e9)}) {
    SCOPED_TRACE(mass);
    // In float, Newton's method ends where the rounding of the column's positions hides what such a box lacks.
    if (method().newton && method().is_float() && mass < 1) continue;
    SceneOptions options;
    options.block.size = {0.4, 0.4, 0.8};
    options.block.cells = {method().cells(2), method().cells(2), method().cells(4)};
    options.material = {.young = young, .poisson = 0, .density = 1000};
    auto scene = make_scene(method(), options);
    scene->obstacles.gravity = {0, 0, -g};
    scene->pin_where([](const V& x) { return x.z() < 1e-6; });
    scene->obstacles.add(OrientedBox{{0.25, 0.25, 0.1}}, {.pose = {.position = {0.2, 0.2, 0.9}}, .mass = mass});
    scene->run(mass > 1e3 ? 10 : 5);
    const double expected = mass * g * 0.8 / (young * 0.16);
    const double sag = 0.9 - scene->obstacles[0].pose().position.z();
    EXPECT_NEAR(sag, expected, 1e-4 * expected + (method().is_float() ? 1e-6 : 1e-9));
    EXPECT_LT(scene->obstacles[0].velocity.norm(), 1e-4);
    EXPECT_NEAR(scene->report().normal_force, mass * g, 1e-3 * mass * g);
  }
}

/// Points of contact may be carried by pinned vertices and others: what couples them to a crate moves no pin.
TEST_P(ContactFree, PinsThatCarryPointsStayUnderABox) {
  SceneOptions options = cube(method(), 2, 2e5);
  options.skin = 8;
  auto scene = make_scene(method(), options);
  scene->set_gravity({0, 0, -g});
  scene->obstacles.gravity = {0, 0, -g};
  scene->pin_where([](const V& x) { return x.z() < 1e-6 || x.x() < 1e-6; });
  scene->obstacles.add(OrientedBox{{0.19, 0.19, 0.1}}, {.pose = {.position = {0.2, 0.2, 0.51}}, .mass = 20});
  scene->run(0.5);
  EXPECT_GT(scene->report().touching, 0);
  for (Index v = 0; v < scene->vertex_count(); ++v)
    if (scene->rest(v).z() < 1e-6 || scene->rest(v).x() < 1e-6) {
      ASSERT_EQ(scene->velocity(v).norm(), 0) << "vertex " << v;
    }
}

/// A rigid box of a thousandth of a cube's mass to a thousand times as much lies still on the cube, which lies on a
/// floor: what the floor bears is no measure for what a light box does, and multipliers do not drive a heavy one.
TEST(ContactCrate, ABoxOfAnyMassLiesStillOnACube) {
  for (const double ratio : {1e-3, 1e-1, 1e3}) {
    SCOPED_TRACE(ratio);
    auto scene = on_floor(euler, cube(euler, 4, ratio > 1 ? 1e8 : 5e5));
    const double mass = ratio * scene->total_mass();
    scene->obstacles.add(OrientedBox{{0.25, 0.25, 0.1}}, {.pose = {.position = {0.2, 0.2, 0.5}}, .mass = mass});
    scene->run(6);
    const Obstacle& box = scene->obstacles[1];
    double fastest = 0;
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(scene->step().accepted());
      fastest = std::max(fastest, box.velocity.norm());
    }
    EXPECT_LT(fastest, 1e-3);
    EXPECT_LT(std::fabs(box.load().impulse.z() / frame_time / (mass * g) - 1), 0.01);
    EXPECT_NEAR(box.pose().position.z(), 0.5, 0.05 * 0.4);
    EXPECT_LT(std::hypot(box.pose().position.x() - 0.2, box.pose().position.y() - 0.2), 1e-3);
  }
}

/// A rigid ball strikes a block beside its middle: both fly. What one gives, the other gets.
TEST_P(ContactFree, AStrikeKeepsMomentaAndGainsNoEnergy) {
  for (const double mass : {0.5, 10.0, 500.0})
    for (const double young : {5e5, 5e7}) {
      auto scene = make_scene(method(), cube(method(), 3, young));
      scene->obstacles.add(Sphere{0.1}, {.pose = {.position = {0.28, 0.22, 0.52}},
                                         .velocity = {0.5, 0, -3},
                                         .angular_velocity = {0, 4, 0},
                                         .mass = mass});
      const Obstacle& ball = scene->obstacles[0];
      const auto momentum = [&] { return V(scene->total_mass() * scene->mean_velocity() + mass * ball.velocity); };
      const auto angular = [&] {
        return V(scene->angular_momentum() + mass * ball.pose().position.cross(ball.velocity) +
                 ball.inertia() * ball.angular_velocity);
      };
      const auto energy = [&] {
        return scene->kinetic_energy() + scene->elastic_energy() + 0.5 * mass * ball.velocity.squaredNorm() +
               0.5 * ball.angular_velocity.dot(ball.inertia() * ball.angular_velocity);
      };
      const V p = momentum(), l = angular();
      const double e = energy(), scale = mass * 3 * 0.5;
      double most = 0;
      bool touched = false;
      for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(scene->step().accepted());
        most = std::max(most, energy());
        touched = touched || scene->report().touching > 0;
      }
      EXPECT_TRUE(touched);
      EXPECT_LT((momentum() - p).norm(), 1e-6 * p.norm()) << mass << ' ' << young;
      EXPECT_LT((angular() - l).norm(), 1e-3 * scale) << mass << ' ' << young;
      EXPECT_LE(most, e * (1 + 1e-6)) << mass << ' ' << young;
    }
}

/// What obstacles bear is the opposite of what the body feels, in each step: forces and their moments.
TEST_P(ContactFree, LoadsAreTheOppositeOfTouches) {
  auto scene = on_floor(method(), cube(method(), 3, 2e5));
  scene->obstacles.add(Sphere{0.15}, {.pose = {.position = {0.5, 0.2, 0.15}}, .velocity = {-1, 0, 0}, .mass = 8});
  scene->obstacles.add(
      OrientedBox{{0.1, 0.1, 0.1}},
      {.pose = {.position = {-0.15, 0.2, 0.2}}, .velocity = {0.3, 0, 0}, .angular_velocity = {0, 0, 1}});
  int touches = 0;
  for (int i = 0; i < 40; ++i) {
    std::vector<V> centre;
    for (Index o = 0; o < scene->obstacles.size(); ++o) centre.push_back(scene->obstacles[o].pose().position);
    ASSERT_TRUE(scene->step_body(frame_time, {}).accepted());
    std::vector<V> impulse(centre.size(), V::Zero()), moment = impulse;
    std::vector<double> bearing(centre.size(), 0);
    for (const Touch& touch : scene->touches()) {
      ++touches;
      bearing[at(touch.obstacle)] += touch.impulse.norm();
      impulse[at(touch.obstacle)] -= touch.impulse;
      moment[at(touch.obstacle)] -= (touch.place - centre[at(touch.obstacle)]).cross(touch.impulse);
    }
    for (Index o = 0; o < scene->obstacles.size(); ++o) {
      const ObstacleLoad& load = scene->obstacles[o].load();
      EXPECT_LT((load.impulse - impulse[at(o)]).norm(), 1e-12 * (1 + load.impulse.norm())) << o;
      // On a free one it acts where the point is at the end of the step.
      const double arm = scene->obstacles[o].is_free() ? 0.05 : 1e-12;
      EXPECT_LE((load.angular_impulse - moment[at(o)]).norm(), arm * bearing[at(o)]) << o;
    }
    scene->obstacles.advance(frame_time);
  }
  EXPECT_GT(touches, 100);
}

/// What the body's momentum changes by is what touches and weight give it.
TEST_P(ContactFree, TouchesAreWhatTheMomentumGets) {
  if (method().is_bdf2()) return;  // its momentum is that of two steps
  auto scene = on_floor(method(), cube(method(), 3, 2e5));
  scene->obstacles.add(OrientedBox{{0.1, 0.1, 0.1}},
                       {.pose = {.position = {-0.15, 0.2, 0.2}}, .velocity = {0.6, 0, 0}});
  for (int i = 0; i < 40; ++i) {
    const V before = scene->mean_velocity();
    ASSERT_TRUE(scene->step().accepted());
    V impulse = scene->total_mass() * frame_time * V(0, 0, -g);
    for (const Touch& touch : scene->touches()) impulse += touch.impulse;
    EXPECT_LT((scene->mean_velocity() - before - impulse / scene->total_mass()).norm(),
              method().is_float() ? 1e-6 : 1e-12)
        << i;
  }
}

/// A heavy rigid box that lies on a pinned body is carried by it, though nothing of the body moves.
TEST(ContactPins, PinnedVerticesCarryAFreeObstacle) {
  for (const Method& method : {euler, Method{Kind::double_tet10_euler, true}}) {
    auto scene = make_scene(method, cube(method, 2, 5e6));
    scene->obstacles.gravity = {0, 0, -g};
    scene->obstacles.add(OrientedBox{{0.2, 0.2, 0.1}}, {.pose = {.position = {0.2, 0.2, 0.52}}, .mass = 50});
    scene->pin_where([](const V&) { return true; });
    scene->run(3);
    EXPECT_NEAR(scene->obstacles[0].pose().position.z(), 0.5, 1e-5);
    EXPECT_LT(scene->obstacles[0].velocity.norm(), 1e-4);
    for (Index v = 0; v < scene->vertex_count(); ++v) EXPECT_EQ(scene->position(v), scene->rest(v));
  }
}

/// Pins among the contacts: a floor that comes up lifts what is free, and leaves pins where they are, although it
/// reaches over them. There is no force between it and them.
TEST(ContactPins, AFloorThatRisesLeavesPinsWhereTheyAre) {
  for (const Method& method : {euler, Method{Kind::double_tet10_euler, true}, bdf2}) {
    auto scene = on_floor(method, cube(method, 3, 5e5));
    const auto is_pinned = [](const V& x) { return x.x() < 1e-6; };
    ASSERT_GT(scene->pin_where(is_pinned), 0);
    scene->obstacles[0].velocity = {0, 0, 0.05};
    scene->run(1);
    scene->obstacles[0].velocity.setZero();
    scene->run(5);
    const double force = scene->report().normal_force;
    double low = 1;
    for (Index v = 0; v < scene->vertex_count(); ++v) {
      const V x = scene->rest(v);
      if (is_pinned(x))
        EXPECT_EQ(scene->position(v), x);
      else
        low = std::min(low, scene->position(v).z());
    }
    EXPECT_GT(low, 0.05 - 1e-5);
    EXPECT_LT(scene->fastest(), 1e-4);
    for (const Touch& touch : scene->touches())
      EXPECT_FALSE(is_pinned(scene->rest(scene->points().vertex(scene->points().first(touch.point)))));
    scene->run(2);
    EXPECT_NEAR(scene->report().normal_force, force, 1e-3 * force);
  }
}

}  // namespace
}  // namespace corotet::contact_free_obstacle_test
