// Pins along some axes, and what released vertices take with them.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/static_solve.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/bodies.hpp"
#include "support/solver_choice.hpp"

namespace corotet::pins_test {
namespace {

using testing::must;

template <class K>
class PinnedBody : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Body = SoftBody<Real, typename K::Element>;
  static constexpr Real h = Real(1) / 60;
  static constexpr Real rounding = sizeof(Real) == 8 ? Real(1e-9) : Real(2e-5);

  static Body block(double poisson = 0.3) {
    return must(Body::create(testing::block<Real, typename K::Element>({.size = {1, 0.3, 0.2}, .cells = {4, 2, 2}}),
                             Material{.young = 2e5, .poisson = poisson, .density = 1000}));
  }
};
TYPED_TEST_SUITE(PinnedBody, testing::AllCases);

/// A bar on rollers that is pulled contracts by nu: the affine field, exactly, as the law is linear in stretch.
TYPED_TEST(PinnedBody, OnRollersIsStretchedUniformly) {
  using Scalar = typename TypeParam::Scalar;
  const double strain = 0.2, poisson = 0.35;
  auto body = this->block(poisson);
  for (Index v = 0; v < body.vertex_count(); ++v) {
    const Vec3<Scalar>& x = body.mesh().position(v);
    const PinnedAxes axes{x.x() < Scalar(1e-6) || x.x() > Scalar(1 - 1e-6), x.y() < Scalar(1e-6), x.z() < Scalar(1e-6)};
    body.pins().pin(v, {Scalar(strain) * x.x(), 0, 0}, axes);
  }
  const StaticReport report = solve_static(body, {.tolerance = 1e-5, .solver = {.tolerance = 1e-6}});
  ASSERT_TRUE(report.converged) << report.advice() << " residual " << report.residual;
  for (Index v = 0; v < body.vertex_count(); ++v) {
    const Vec3<double> x = body.mesh().position(v).template cast<double>();
    const Vec3<double> exact(strain * x.x(), -poisson * strain * x.y(), -poisson * strain * x.z());
    EXPECT_LT((body.displacements()[at(v)].template cast<double>() - exact).norm(), 2e-5) << "vertex " << v;
  }
}

/// A block on a smooth floor slides on as it did, and its bottom stays where it was.
TYPED_TEST(PinnedBody, SlidesAlongFreeAxes) {
  using Scalar = typename TypeParam::Scalar;
  auto body = this->block();
  body.pin_where([](const Vec3<Scalar>& x) { return x.z() < Scalar(1e-6); }, {false, false, true});
  must(body.set_velocities(Field<Scalar>(at(body.vertex_count()), Vec3<Scalar>(1, Scalar(-0.5), 0))));
  auto second = body;
  ImplicitEuler euler(body, testing::solver());
  Bdf2 bdf2(second, testing::solver());
  for (int step = 0; step < 60; ++step) {
    ASSERT_TRUE(euler.step(body, this->h).accepted());
    ASSERT_TRUE(bdf2.step(second, this->h).accepted());
  }
  for (const auto* b : {&body, &second}) {
    // BDF2 takes velocities from differences of positions: their rounding over h.
    const Scalar tolerance = b == &body ? this->rounding : 300 * this->rounding;
    for (Index v = 0; v < b->vertex_count(); ++v) {
      EXPECT_LT((b->velocities()[at(v)] - Vec3<Scalar>(1, Scalar(-0.5), 0)).norm(), tolerance);
      EXPECT_LT((b->displacements()[at(v)] - Vec3<Scalar>(1, Scalar(-0.5), 0)).norm(), tolerance);
      if (b->mesh().position(v).z() < Scalar(1e-6)) {
        EXPECT_EQ(b->displacements()[at(v)].z(), 0);
      }
    }
  }
}

/// Three pins of one axis each at the same place are one pin of three.
TYPED_TEST(PinnedBody, AxesAddUpToAPin) {
  using Scalar = typename TypeParam::Scalar;
  auto whole = this->block(), changed = whole;
  const auto held = [](const Vec3<Scalar>& x) { return x.x() < Scalar(1e-6); };
  whole.pin_where(held);
  changed.pin_where(held, {true, false, false});
  changed.pin_where(held, {false, true, true});
  changed.pin_where(held, {true, true, true});
  for (auto* body : {&whole, &changed}) body->set_gravity({0, 0, Scalar(-9.81)});
  ImplicitEuler a(whole, testing::solver()), b(changed, testing::solver());
  for (int step = 0; step < 10; ++step) {
    ASSERT_TRUE(a.step(whole, this->h).accepted());
    ASSERT_TRUE(b.step(changed, this->h).accepted());
  }
  EXPECT_EQ(whole.displacements(), changed.displacements());
  EXPECT_GT(testing::max_displacement(whole), 0.01) << "the case must tell";
  changed.pins().pin(0, {0, 0, 0}, {false, false, false});
  EXPECT_FALSE(changed.pins().is_pinned(0));
}

/// All vertices are led, stop for some steps or not at all, and are released: the body leaves with the velocity that it
/// had, none if it had stopped.
template <class Stepper, class Body, class Scalar>
void lead_and_release(Body body, Scalar h, Scalar rounding, int led, int stopped) {
  Stepper integrator(body, testing::solver());
  const Vec3<Scalar> velocity(Scalar(0.6), Scalar(-0.3), Scalar(0.9));
  body.pin_where([](const auto&) { return true; });
  Vec3<Scalar> there = Vec3<Scalar>::Zero();
  for (int step = 0; step < led + stopped; ++step) {
    if (step < led) there += h * velocity;
    for (Index v = 0; v < body.vertex_count(); ++v) body.pins().move(v, there);
    ASSERT_TRUE(integrator.step(body, h).accepted());
  }
  const Vec3<Scalar> expected = stopped > 0 ? Vec3<Scalar>(Vec3<Scalar>::Zero()) : velocity;
  const auto check_velocity = [&](const char* when) {
    for (const auto& v : body.velocities())
      ASSERT_LT((v - expected).norm(), 100 * rounding) << when << ": led " << led << ", stopped " << stopped;
  };
  check_velocity("pinned");
  for (Index v = 0; v < body.vertex_count(); ++v) body.pins().release(v);
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(integrator.step(body, h).accepted());
    check_velocity("released");
  }
}

TYPED_TEST(PinnedBody, LeavesWithTheVelocityThatItHad) {
  using Held = typename TestFixture::Body;
  for (const int led : {1, 2, 7})
    for (const int stopped : {0, 1, 2, 5}) {
      lead_and_release<ImplicitEuler<Held>>(this->block(), this->h, this->rounding, led, stopped);
      lead_and_release<Bdf2<Held>>(this->block(), this->h, this->rounding, led, stopped);
    }
}

/// One vertex of a body at rest is led to and fro and comes to rest where it was; a vertex next to it is pinned and
/// released by the way: BDF2 then moves as backward Euler, to the order of a step.
TYPED_TEST(PinnedBody, ReleasedOneByOneNothingJumps) {
  using Scalar = typename TypeParam::Scalar;
  auto first = this->block(), second = first;
  for (auto* body : {&first, &second}) body->pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(1e-6); });
  const Index tip = first.mesh().nearest_vertex({1, Scalar(0.15), Scalar(0.1)});
  ImplicitEuler euler(first, testing::solver());
  Bdf2 bdf2(second, testing::solver());
  double fastest = 0, apart = 0;
  for (int step = 0; step < 40; ++step) {
    for (auto* body : {&first, &second}) {
      const Scalar z = step < 10 ? Scalar(0.004) * Scalar(step) : Scalar(0.036);
      if (step < 15) body->pins().pin(tip, {0, 0, z});
      if (step == 15) body->pins().release(tip);
    }
    ASSERT_TRUE(euler.step(first, this->h).accepted());
    ASSERT_TRUE(bdf2.step(second, this->h).accepted());
    if (step == 14) {
      EXPECT_LT(second.velocities()[at(tip)].norm(), Scalar(1e-6));
    }
    if (step < 15) continue;
    fastest = std::max(fastest, double(second.velocities()[at(tip)].norm()));
    apart = std::max(apart, double((second.position(tip) - first.position(tip)).norm()));
  }
  // From 36 mm at rest the tip swings at some 10 rad/s.
  EXPECT_LT(fastest, 1.5);
  EXPECT_GT(fastest, 0.1) << "the case must tell";
  EXPECT_LT(apart, 0.02);
}

}  // namespace
}  // namespace corotet::pins_test
