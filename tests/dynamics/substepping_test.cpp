// Steps that cannot be trusted: accepted, refused or divided.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <gtest/gtest.h>

#include <limits>

#include "support/bodies.hpp"
#include "support/count_allocations.hpp"
#include "support/floating_point_traps.hpp"

namespace corotet::substepping_test {
namespace {

using testing::must;

constexpr Material soft{.young = 5e5, .poisson = 0.3, .density = 1000};

template <class Stepper>
class Adaptive : public ::testing::Test {
 public:
  using Body = typename Stepper::Body;
  using Integrator = typename Stepper::Integrator;

  static Body beam() {
    return testing::cantilever<typename Body::scalar_type, Tet4>({.size = {1, 0.2, 0.2}, .cells = {6, 2, 2}}, soft,
                                                                 9.81);
  }

  /// The held end jumps into the body, by a fifth of its length: faster than the rest can follow.
  static void push(Body& body) {
    for (const Index v : body.pins().vertices())
      body.move_pin(v, (body.mesh().position(v).template cast<double>() + Vec3<double>(0.2, 0, 0))
                           .template cast<typename Body::scalar_type>());
  }

  static SubsteppingIntegrator<Integrator, Body> stepper(const Body& body, const SubsteppingOptions& options,
                                                         const SolverOptions& solver = {}) {
    return {Integrator(body, solver, Stepper::newton), body, options};
  }
};
struct EulerSteps {
  using Body = SoftBody<float, Tet4>;
  using Integrator = ImplicitEuler<Body>;
  static constexpr StepOptions newton{};
};
struct NewtonSteps : EulerSteps {
  static constexpr StepOptions newton{.iterations = 10, .tangent = Tangent::consistent};
};
struct Bdf2Steps {
  using Body = SoftBody<double, Tet4>;
  using Integrator = Bdf2<Body>;
  static constexpr StepOptions newton{};
};
using Steppers = ::testing::Types<EulerSteps, NewtonSteps, Bdf2Steps>;
TYPED_TEST_SUITE(Adaptive, Steppers);

template <class Body>
void expect_same_state(const Body& a, const Body& b) {
  EXPECT_EQ(flat(a.displacements()), flat(b.displacements()));
  EXPECT_EQ(flat(a.velocities()), flat(b.velocities()));
}

TYPED_TEST(Adaptive, DoesWhatTheIntegratorDoesWhereThatCanBeTrusted) {
  using Scalar = typename TestFixture::Body::scalar_type;
  auto body = this->beam(), plain = body;
  auto adaptive = this->stepper(body, {});
  typename TestFixture::Integrator integrator(plain, SolverOptions{}, TypeParam::newton);
  for (int step = 0; step < 30; ++step) {
    const StepReport report = adaptive.step(body, Scalar(1.0 / 60));
    const StepReport expected = integrator.step(plain, Scalar(1.0 / 60));
    ASSERT_TRUE(report.ok()) << report.advice();
    EXPECT_EQ(report.sub_steps, 1);
    EXPECT_EQ(report.steps_tried, 1);
    EXPECT_EQ(report.iterations, expected.iterations);
    EXPECT_EQ(report.max_strain, expected.max_strain);
  }
  expect_same_state(body, plain);
  EXPECT_GT(testing::max_displacement(plain), 0.1) << "the case must tell";
}

/// A jump of the pins that strains elements too far in one step: kept and named, refused, or gone through in parts.
TYPED_TEST(Adaptive, TheCallerChoosesWhatBecomesOfAnUntrustedStep) {
  using Scalar = typename TestFixture::Body::scalar_type;
  const auto h = Scalar(0.02);
  for (const OnUnreliable on_unreliable : {OnUnreliable::accept, OnUnreliable::refuse, OnUnreliable::divide}) {
    auto body = this->beam();
    auto adaptive = this->stepper(body, {.on_unreliable = on_unreliable, .max_halvings = 6, .max_strain_growth = 0.2});
    ASSERT_EQ(adaptive.step(body, h).warning, StepWarning::none);
    this->push(body);
    const auto before = body;
    const StepReport report = adaptive.step(body, h);
    if (on_unreliable == OnUnreliable::refuse) {
      EXPECT_EQ(report.error, StepError::unreliable);
      EXPECT_NE(report.warning, StepWarning::none);
      EXPECT_STRNE(report.advice(), "");
      EXPECT_EQ(report.steps_tried, 1);
      expect_same_state(body, before);
      EXPECT_EQ(flat(body.pins().targets()), flat(before.pins().targets()));
      continue;
    }
    EXPECT_TRUE(report.accepted());
    for (const Index v : body.pins().vertices()) EXPECT_EQ(body.displacements()[at(v)].x(), Scalar(0.2));
    if (on_unreliable == OnUnreliable::accept) {
      EXPECT_NE(report.warning, StepWarning::none);
      EXPECT_FALSE(report.ok());
      EXPECT_STRNE(report.advice(), "");
      EXPECT_EQ(report.sub_steps, 1);
    } else {
      EXPECT_EQ(report.warning, StepWarning::none) << report.advice();
      EXPECT_GT(report.sub_steps, 1);
      EXPECT_EQ(report.inverted_elements, 0);
      EXPECT_GE(report.steps_tried, report.sub_steps + 1);
      EXPECT_GE(report.newton_iterations, report.sub_steps);
    }
  }
}

/// The first step has nothing to be compared with but the rest shape: a body that begins there is judged, a body that
/// was put elsewhere is not.
TYPED_TEST(Adaptive, TheFirstStepFromRestIsJudged) {
  using Scalar = typename TestFixture::Body::scalar_type;
  for (const bool at_rest : {true, false}) {
    auto body = this->beam();
    if (!at_rest) must(body.set_displacements(testing::random_field<Scalar>(body.vertex_count(), 1e-4, 1)));
    auto adaptive = this->stepper(body, {.on_unreliable = OnUnreliable::accept, .max_strain_growth = 0.2});
    this->push(body);
    EXPECT_EQ(adaptive.step(body, Scalar(0.02)).warning != StepWarning::none, at_rest);
  }
}

/// What no division mends ends after the agreed number, and is named.
TYPED_TEST(Adaptive, DivisionIsBounded) {
  using Scalar = typename TestFixture::Body::scalar_type;
  auto body = this->beam();
  auto adaptive = this->stepper(body, {.max_halvings = 3, .max_residual = 1e-9},
                                {.method = SolverMethod::pcg,
                                 .preconditioner = PreconditionerKind::block_jacobi,
                                 .tolerance = 1e-9,
                                 .max_iterations = 1});
  const StepReport report = adaptive.step(body, Scalar(0.1));
  EXPECT_TRUE(report.accepted());
  EXPECT_EQ(report.warning, StepWarning::residual);
  EXPECT_EQ(report.solve, SolveStatus::iteration_limit);
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.sub_steps, 8);
  EXPECT_EQ(report.steps_tried, 1 + 1 + 1 + 8);
}

/// Bad input is named as by the integrator, at the first try, and nothing changes. So is what only a sub-step meets.
TYPED_TEST(Adaptive, RefusalsLeaveTheBodyUntouched) {
  using Scalar = typename TestFixture::Body::scalar_type;
  auto body = this->beam();
  auto adaptive = this->stepper(body, {});
  ASSERT_TRUE(adaptive.step(body, Scalar(0.01)).ok());
  const auto before = body;
  constexpr auto nan = std::numeric_limits<Scalar>::quiet_NaN();
  EXPECT_EQ(adaptive.step(body, nan).error, StepError::time_step);
  EXPECT_EQ(adaptive.step(body, Scalar(0)).error, StepError::time_step);
  body.external_forces()[6].y() = nan;
  const StepReport force = adaptive.step(body, Scalar(0.01));
  EXPECT_EQ(force.error, StepError::external_force);
  EXPECT_EQ(force.vertex, 6);
  EXPECT_EQ(force.steps_tried, 1);
  EXPECT_STRNE(force.advice(), "");
  body.external_forces()[6].y() = 0;
  const Index pinned = body.pins().vertices().back();
  body.move_pin(pinned, {nan, 0, 0});
  EXPECT_EQ(adaptive.step(body, Scalar(0.01)).error, StepError::pin_target);
  body.move_pin(pinned, before.position(pinned));
  expect_same_state(body, before);

  const testing::WithoutTraps overflow_is_meant;
  body.external_forces()[6].y() = std::numeric_limits<Scalar>::max();
  const StepReport overflow = adaptive.step(body, Scalar(1e3));
  EXPECT_FALSE(overflow.accepted());
  EXPECT_GT(overflow.sub_steps, 1) << "a shorter step might have done";
  expect_same_state(body, before);
  EXPECT_EQ(flat(body.pins().targets()), flat(before.pins().targets()));
  body.external_forces()[6].y() = 0;
  EXPECT_TRUE(adaptive.step(body, Scalar(0.01)).ok());
}

TYPED_TEST(Adaptive, StepsAllocateNothing) {
  using Scalar = typename TestFixture::Body::scalar_type;
  auto body = this->beam();
  auto adaptive = this->stepper(body, {.max_halvings = 5, .max_strain_growth = 0.2});
  ASSERT_TRUE(adaptive.step(body, Scalar(0.01)).ok());
  const long before = testing::allocation_count;
  this->push(body);
  const StepReport divided = adaptive.step(body, Scalar(0.02));
  adaptive.step(body, Scalar(0.1));
  EXPECT_EQ(testing::allocation_count - before, 0);
  EXPECT_GT(divided.sub_steps, 1);
}

}  // namespace
}  // namespace corotet::substepping_test
