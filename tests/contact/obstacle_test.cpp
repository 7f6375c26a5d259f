// How obstacles move: led along paths, or freely with their momenta.
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/random.hpp"

namespace corotet::obstacle_test {
namespace {

using V = Vec3<double>;
constexpr double pi = std::numbers::pi;

V direction(testing::Random& random) { return random.vector().normalized(); }

TEST(RotationVector, IsTheInverseOfRotationBy) {
  testing::Random random(1);
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-6, 0.1, 1.0, pi / 2, 3.0, pi - 1e-3, pi - 1e-6, pi - 1e-9, pi})
    for (int i = 0; i < 50; ++i) {
      const V turn = angle * direction(random);
      const Mat3<double> r = rotation_by(turn);
      const V found = rotation_vector(r);
      EXPECT_LE(found.norm(), pi * (1 + 1e-15)) << angle;
      EXPECT_LT((rotation_by(found) - r).norm(), 1e-14) << angle;
      if (angle < pi - 1e-7) {
        EXPECT_LT((found - turn).norm(), 1e-14) << angle;
      }
    }
  for (int i = 0; i < 1000; ++i) {
    const Mat3<double> r = random.rotation();
    EXPECT_LT((rotation_by(rotation_vector(r)) - r).norm(), 1e-14);
  }
}

/// Of a point of the obstacle, that its velocity takes along.
TEST(Obstacle, VelocityIsTheRateOfItsPose) {
  testing::Random random(2);
  constexpr double h = 1e-6;
  for (int i = 0; i < 50; ++i) {
    Obstacle obstacle(Sphere{0.1}, {.pose = {random.vector(), quaternion_of(random.rotation())},
                                    .velocity = random.vector(),
                                    .angular_velocity = random.vector()});
    const V p = random.vector(), in_frame = obstacle.to_frame(p - obstacle.pose().position);
    const V told = obstacle.velocity_at(p);
    EXPECT_LT((obstacle.pose().position + obstacle.to_world(in_frame) - p).norm(), 1e-14);
    obstacle.move(h);
    const V now = obstacle.pose().position + obstacle.to_world(in_frame);
    EXPECT_LT(((now - p) / h - told).norm(), 1e-4);
  }
}

TEST(Obstacle, AFreeOneKeepsItsMomenta) {
  testing::Random random(3);
  for (int i = 0; i < 10; ++i) {
    Obstacles all;
    const V inertia(0.1, 0.2, 0.28);  // about the middle axis it tumbles
    all.add(Sphere{0.1}, {.pose = {random.vector(), quaternion_of(random.rotation())},
                          .velocity = random.vector(),
                          .angular_velocity = 5 * random.vector(),
                          .mass = 2,
                          .inertia = inertia});
    Obstacle& body = all[0];
    const V velocity = body.velocity, start = body.pose().position;
    const V momentum = body.inertia() * body.angular_velocity;
    for (int step = 0; step < 1000; ++step) all.advance(0.01);
    EXPECT_LT((body.inertia() * body.angular_velocity - momentum).norm(), 1e-12 * momentum.norm());
    EXPECT_LT((body.pose().position - start - 10 * velocity).norm(), 1e-11);
    EXPECT_NEAR(body.pose().rotation.norm(), 1, 1e-15);
    const Mat3<double> axes = body.inertia();  // a rotation has kept its moments
    EXPECT_NEAR(axes.trace(), inertia.sum(), 1e-13);
    EXPECT_NEAR(axes.determinant(), inertia.x() * inertia.y() * inertia.z(), 1e-13);
  }
}

/// A step of any number of bodies that share it: once, and a led obstacle is not moved by forces.
TEST(Obstacle, WeightForceAndTorqueActOnceAStep) {
  constexpr double h = 0.02;
  Obstacles all;
  all.gravity = {0, 0, -9.81};
  for (const double mass : {0.0, 2.0})
    all.add(Sphere{0.5},
            {.pose = {.rotation = {1, 2, 3, 4}}, .velocity = {1, 0, 0}, .mass = mass, .inertia = {1, 2, 3}});
  for (Index i = 0; i < 2; ++i) {
    all[i].force = {4, 0, 0};
    all[i].torque = {1, 2, 3};
  }
  all.begin_step(h);
  all.begin_step(h);  // of another body
  all[1].add_load({{0, 0, 1}, {0, 1, 0}});
  all[1].add_load({{0, 0, 2}, {0, 1, 0}});
  all.advance(h);
  EXPECT_LT((all[0].velocity - V(1, 0, 0)).norm(), 1e-15);
  EXPECT_TRUE(all[0].angular_velocity.isZero());
  EXPECT_LT((all[0].pose().position - V(h, 0, 0)).norm(), 1e-15);
  EXPECT_LT((all[1].velocity - V(1 + h * 2, 0, -h * 9.81)).norm(), 1e-15);
  EXPECT_LT((all[1].inertia() * all[1].angular_velocity - h * V(1, 2, 3)).norm(), 1e-14);
  EXPECT_EQ(all[1].load().impulse, V(0, 0, 3)) << "what bodies have done can be read after the step";
  EXPECT_EQ(all[1].load().angular_impulse, V(0, 2, 0));
  all.begin_step(h);
  EXPECT_TRUE(all[1].load().impulse.isZero());
}

/// An engine that moves its bodies itself: velocities as of advance(), poses as it says.
TEST(Obstacle, EndsAStepWithoutMoving) {
  constexpr double h = 0.02;
  Obstacles all;
  all.gravity = {0, 0, -9.81};
  all.add(Sphere{0.5}, {.mass = 1});
  for (int step = 0; step < 3; ++step) {
    all.begin_step(h);
    all.end_step();
  }
  EXPECT_NEAR(all[0].velocity.z(), -3 * h * 9.81, 1e-14);
  EXPECT_TRUE(all[0].pose().position.isZero());
}

TEST(Obstacle, ALedOneArrivesAtItsTarget) {
  testing::Random random(4);
  for (const double angle : {0.0, 1e-9, 0.3, 3.0, pi - 1e-6, pi - 1e-9})
    for (int i = 0; i < 20; ++i) {
      const double h = std::pow(10, random.uniform(-3, -1));
      Obstacles all;
      const Mat3<double> start = random.rotation(), turn = rotation_by(angle * direction(random));
      all.add(OrientedBox{{1, 2, 3}}, {.pose = {random.vector(10), quaternion_of(start)}});
      Pose target{random.vector(10), quaternion_of(Mat3<double>(turn * start))};
      if (i % 2 == 0) target.rotation = -3.0 * target.rotation;  // the same rotation
      all.lead(0, target, h);
      EXPECT_LE(all[0].angular_velocity.norm() * h, pi * (1 + 1e-15));
      all.advance(h);
      EXPECT_LT((all[0].pose().position - target.position).norm(), 1e-13);
      EXPECT_LT((rotation_of(all[0].pose().rotation) - turn * start).norm(), 1e-13) << angle;
    }
}

}  // namespace
}  // namespace corotet::obstacle_test
