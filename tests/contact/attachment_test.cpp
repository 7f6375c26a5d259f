// Laws of attachments: a point of a body tied to space, to an obstacle, to another body.
#include <gtest/gtest.h>

#include <array>
#include <corotet/attachment.hpp>
#include <corotet/contact.hpp>
#include <corotet/integrators.hpp>
#include <corotet/points.hpp>

#include "support/bodies.hpp"

namespace corotet::attachment_test {

using testing::must;

constexpr float h = 1.0f / 60;

SoftBody<float> cube(double young) {
  auto body = must(SoftBody<float>::create(testing::block<float, Tet4>({.size = {0.2, 0.2, 0.2}, .cells = {2, 2, 2}}),
                                           Material{.young = young, .poisson = 0.3, .density = 1000},
                                           {.damping = {.mass = 2}}));
  body.set_gravity({0, 0, -9.81f});
  return body;
}

template <class Body>
Vec3<double> momentum(const Body& body) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum += double(body.mass().row_sum(v)) * body.velocities()[at(v)].template cast<double>();
  return sum;
}

/// The top of the cube, in its middle.
LocatedPoint<Tet4> top(const SoftBody<float>& body) {
  return PointLocator(body.mesh()).locate(Vec3<double>(0.1, 0.1, 0.2));
}

TEST(Attachment, HoldsABodyOfAnyStiffnessByASpringOfAny) {
  for (const double young : {1e4, 1e6, 1e9})
    for (const double stiffness : {1e2, 1e5, 1e9}) {
      SCOPED_TRACE(::testing::Message() << "E " << young << ", k " << stiffness);
      SoftBody<float> body = cube(young);
      ImplicitEuler euler(body);
      Attachment<float> tie(top(body), {.stiffness = stiffness, .damping = 10});
      tie.set_target({0.1, 0.1, 0.2});
      StepContext<float> context;
      context.terms = tie;
      for (int step = 0; step < 900; ++step) ASSERT_TRUE(euler.step(body, h, context).accepted());
      const double weight = body.mass().total() * 9.81;
      // The spring feels the rounding of positions.
      EXPECT_NEAR(tie.force().z(), weight, 2e-3 * weight + 0.2 * stiffness * 1.2e-7);
      const double sag = 0.2 - double(position_at(body, top(body)).z());
      EXPECT_NEAR(sag, weight / stiffness, 1e-3 * weight / stiffness + 1e-6);
    }
}

TEST(Attachment, LeadsABodyAlong) {
  SoftBody<float> body = cube(1e6);
  body.set_gravity({0, 0, 0});
  ImplicitEuler euler(body);
  Attachment<float> tie(top(body), {.stiffness = 1e6, .damping = 1e3});
  StepContext<float> context;
  context.terms = tie;
  for (int step = 1; step <= 480; ++step) {
    tie.set_target({0.1 + 0.5 * step * double(h), 0.1, 0.2}, {0.5, 0, 0});
    ASSERT_TRUE(euler.step(body, h, context).accepted());
  }
  // 8 kg that are damped by 2/s.
  EXPECT_NEAR(tie.force().x(), 8 * 2 * 0.5, 0.1);
  EXPECT_NEAR(double(position_at(body, top(body)).x()), tie.target().x(), 2e-5);
}

/// A rigid ball hangs on a cube that is held at its top, at any ratio of masses and any stiffness.
TEST(Attachment, CarriesAFreeObstacleOfAnyMass) {
  for (const double mass : {0.008, 8.0, 8000.0})
    for (const double stiffness : {1e3, 1e9}) {
      if (mass > 100 && stiffness < 1e4) continue;  // 80 m of string
      SCOPED_TRACE(::testing::Message() << "m " << mass << ", k " << stiffness);
      SoftBody<float> body = cube(1e8);
      body.pin_where([](const Vec3<float>& x) { return x.z() > 0.19f; });
      ImplicitEuler euler(body);
      Obstacles obstacles;
      obstacles.gravity = {0, 0, -9.81};
      const Index ball = obstacles.add(Sphere{0.05}, {.pose = {.position = {0.1, 0.1, -0.05}}, .mass = mass});
      Attachment<float> tie(PointLocator(body.mesh()).locate(Vec3<double>(0.1, 0.1, 0)),
                            {.stiffness = stiffness, .damping = 2 * mass});
      tie.set_target(obstacles, ball, {0, 0, 0.05});
      StepContext<float> context;
      context.terms = tie;
      for (int step = 0; step < 1200; ++step) {
        ASSERT_TRUE(euler.step(body, h, context).accepted());
        obstacles.advance(double(h));
        ASSERT_LT(obstacles[ball].velocity.norm(), 5);
      }
      EXPECT_NEAR(tie.force().z(), -mass * 9.81, 0.01 * mass * 9.81);
      EXPECT_LT(obstacles[ball].velocity.norm(), 1e-2);
    }
}

TEST(Attachment, KeepsTheMomentumOfBodyAndObstacle) {
  for (const double mass : {0.1, 8.0, 1000.0})
    for (const double stiffness : {1e2, 1e5, 1e9}) {
      SCOPED_TRACE(::testing::Message() << "m " << mass << ", k " << stiffness);
      auto body =
          must(SoftBody<double>::create(testing::block<double, Tet4>({.size = {0.2, 0.2, 0.2}, .cells = {2, 2, 2}}),
                                        Material{.young = 1e6, .poisson = 0.3, .density = 1000}));
      ImplicitEuler euler(body);
      Obstacles obstacles;
      const Index ball =
          obstacles.add(Sphere{0.05}, {.pose = {.position = {0.1, 0.1, 0.4}}, .velocity = {0, 3, 1}, .mass = mass});
      Attachment<double> tie(PointLocator(body.mesh()).locate(Vec3<double>(0.1, 0.1, 0.2)), {.stiffness = stiffness});
      tie.set_target(obstacles, ball, {0, 0, 0});
      StepContext<double> context;
      context.terms = tie;
      const Vec3<double> before = mass * obstacles[ball].velocity;
      for (int step = 0; step < 200; ++step) {
        ASSERT_TRUE(euler.step(body, 1.0 / 60, context).accepted());
        obstacles.advance(1.0 / 60);
        ASSERT_LT((momentum(body) + mass * obstacles[ball].velocity - before).norm(), (step + 1) * 1e-9 * before.norm())
            << step;
      }
      EXPECT_GT(momentum(body).norm(), 1e-3 * before.norm());
    }
}

/// Two bodies tied together: the first step sees the spring, the second the force that the first found.
TEST(Attachment, PullsAnotherBodyByTheOppositeForce) {
  SoftBody<float> upper = cube(1e6), lower = cube(1e6);
  upper.pin_where([](const Vec3<float>& x) { return x.z() > 0.19f; });
  ImplicitEuler euler_of_upper(upper), euler_of_lower(lower);
  const LocatedPoint<Tet4> hook = PointLocator(upper.mesh()).locate(Vec3<double>(0.1, 0.1, 0)), eye = top(lower);
  Attachment<float> tie(eye, {.stiffness = 1e4, .damping = 100});
  Attachment<float>::Counterpart pull(tie, hook);
  StepContext<float> of_lower, of_upper;
  of_lower.terms = tie;
  of_upper.terms = pull;
  for (int step = 0; step < 600; ++step) {
    const Vec3<double> target = position_at(upper, hook).cast<double>();
    tie.set_target(target, velocity_at(upper, hook).cast<double>());
    ASSERT_TRUE(euler_of_lower.step(lower, h, of_lower).accepted());
    ASSERT_TRUE(euler_of_upper.step(upper, h, of_upper).accepted());
  }
  EXPECT_NEAR(tie.force().z(), 8 * 9.81, 0.1);
}

}  // namespace corotet::attachment_test
