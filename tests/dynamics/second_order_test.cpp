// How the error of a run falls with the time step, and what else the integrators promise of time.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "support/bodies.hpp"
#include "support/floating_point_traps.hpp"
#include "support/solver_choice.hpp"

namespace corotet::second_order_test {
namespace {

using testing::must;

constexpr Material soft{.young = 5e5, .poisson = 0.3, .density = 1000};
constexpr StepOptions one_solve{}, converged{.iterations = 12, .tolerance = 1e-6, .tangent = Tangent::consistent};

struct Motion {
  bool damped, led, uneven;
};

template <class Element>
SoftBody<double, Element> beam(const RayleighDamping& damping = {}) {
  const std::array<Index, 3> cells =
      Element::order == 1 ? std::array<Index, 3>{8, 1, 1} : std::array<Index, 3>{4, 1, 1};
  return testing::cantilever<double, Element>({.size = {1, 0.2, 0.2}, .cells = cells}, soft, 0, {.damping = damping});
}

/// A beam that swings far: gravity comes smoothly, because a jump would set off vibrations that no step length
/// here resolves. Led: its held end also turns and shifts. Uneven: steps of 0.5 to 1.5 times the mean.
template <class Integrator, class Body>
Body swing(Body body, const Motion& motion, int steps, const StepOptions& newton) {
  Integrator integrator(body, SolverOptions{.method = SolverMethod::cholesky, .tolerance = 1e-11}, newton);
  constexpr double duration = 0.3, pi = std::numbers::pi;
  std::vector<double> end{0};
  for (int s = 0; s < steps; ++s)
    end.push_back(end.back() + (motion.uneven ? 1 + 0.5 * std::sin(6 * pi * (s + 0.5) / steps) : 1.0));
  for (std::size_t s = 1; s < end.size(); ++s) {
    const double t = end[s] / end.back() * duration, h = (end[s] - end[s - 1]) / end.back() * duration;
    const double part = t / duration;
    body.set_gravity(Vec3<double>(0, 0, -9.81) * (part * part * part * (10 - part * (15 - 6 * part))));
    if (motion.led) {
      const double wave = std::pow(1 - std::cos(5 * t), 2) / 2;
      const Mat3<double> q = rotation_by(0.4 * wave * Vec3<double>::UnitY());
      for (const Index v : std::vector<Index>(body.pins().vertices()))
        body.move_pin(v, q * body.mesh().position(v) + Vec3<double>(0, 0.05 * wave, 0));
    }
    const StepReport report = integrator.step(body, h);
    EXPECT_TRUE(report.accepted() && report.newton_converged) << report.advice();
  }
  return body;
}

template <class Element>
class TimeError : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(TimeError, Elements);

/// Order one and two in h, with one solve a step and with the equation solved, with damping, led pins, uneven steps.
TYPED_TEST(TimeError, FallsAtTheOrderOfTheIntegrator) {
  for (const Motion& motion : {Motion{false, false, false}, Motion{true, false, false}, Motion{false, true, false},
                               Motion{true, true, true}}) {
    const auto start = motion.damped ? beam<TypeParam>({.mass = 0.5, .stiffness = 0.005}) : beam<TypeParam>();
    using Body = SoftBody<double, TypeParam>;
    const Body exact = swing<Bdf2<Body>>(start, {motion.damped, motion.led, false}, 800, converged);
    const auto error = [&](const Body& body) {
      return (flat(body.displacements()) - flat(exact.displacements())).norm() / flat(exact.displacements()).norm();
    };
    const auto expect_order = [&]<class Integrator>(const char* name, const StepOptions& newton, double order) {
      const double coarse = error(swing<Integrator>(start, motion, 25, newton));
      const double fine = error(swing<Integrator>(start, motion, 50, newton));
      std::printf("damped %d led %d uneven %d %s, %d solves: %.2e %.2e order %.2f\n", motion.damped, motion.led,
                  motion.uneven, name, newton.iterations, coarse, fine, std::log2(coarse / fine));
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.3) << name;
    };
    for (const StepOptions& newton : {one_solve, converged}) {
      expect_order.template operator()<ImplicitEuler<Body>>("backward Euler", newton, 1);
      expect_order.template operator()<Bdf2<Body>>("BDF2", newton, 2);
    }
  }
}

/// x' = xbar + c v', M (v' - vbar) = c (f_ext + f_el(x') - D v'), by the formulas for uneven steps.
TEST(Bdf2, ConvergedStepsSatisfyTheEquation) {
  using Body = SoftBody<double>;
  for (const MassModel model : {MassModel::lumped, MassModel::consistent}) {
    auto body = testing::cantilever<double, Tet4>({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}}, soft, 9.81,
                                                  {.mass = model, .damping = {.mass = 0.7, .stiffness = 0}});
    must(body.set_velocities(testing::random_field<double>(body.vertex_count(), 0.5, 2)));
    Bdf2<Body> integrator(body, SolverOptions{.method = SolverMethod::cholesky, .tolerance = 1e-12},
                          {.iterations = 20, .tolerance = 1e-12, .tangent = Tangent::consistent});
    Body before = body;
    ASSERT_TRUE(integrator.step(body, 0.01).accepted());
    double last_h = 0.01;
    for (const double ratio : {1.0, 1.7, 0.4}) {
      const double h = ratio * last_h, c = h * (1 + ratio) / (1 + 2 * ratio);
      const Body now = body;
      ASSERT_TRUE(integrator.step(body, h).newton_converged);
      const double lead = ratio * ratio / (1 + 2 * ratio);
      const VecX<double> x =
          flat(now.displacements()) + lead * (flat(now.displacements()) - flat(before.displacements()));
      Field<double> v(now.velocities());
      flat(v) += lead * (flat(now.velocities()) - flat(before.velocities()));
      EXPECT_LT((flat(body.displacements()) - x - c * flat(body.velocities())).norm(), 1e-13);

      detail::ElasticEvaluation<double, Tet4> state(body.law());
      SerialExecutor serial;
      body.law().evaluate(body.displacements(), state, serial);
      double residual = 0, size = 0;
      for (Index i = 0; i < body.vertex_count(); ++i) {
        if (body.pins().is_pinned(i)) continue;
        const auto mass_times = [&](const Field<double>& y) { return body.mass().row_product(*body.pattern(), i, y); };
        const Vec3<double> inertia = (1 + c * 0.7) * mass_times(body.velocities()) - mass_times(v);
        const Vec3<double> force = state.vertex_force(*body.pattern(), i) + body.mass().row_sum(i) * body.gravity();
        residual += (inertia - c * force).squaredNorm();
        size += (c * force).squaredNorm();
      }
      EXPECT_LT(residual, 1e-16 * size) << "ratio " << ratio;
      before = now;
      last_h = h;
    }
  }
}

template <class T>
class Bdf2Motion : public ::testing::Test {};
using Precisions = ::testing::Types<testing::Case<float, Tet4>, testing::Case<double, Tet10>>;
TYPED_TEST_SUITE(Bdf2Motion, Precisions);

template <class Scalar, class Element>
SoftBody<Scalar, Element> free_block(const Material& material = soft) {
  return must(SoftBody<Scalar, Element>::create(
      testing::block<Scalar, Element>({.corner = {-0.2, -0.15, -0.1}, .size = {0.4, 0.3, 0.2}, .cells = {3, 2, 2}}),
      material));
}

TYPED_TEST(Bdf2Motion, LinearMomentumOfAFreeBodyIsKept) {
  using Scalar = typename TypeParam::Scalar;
  auto body = free_block<Scalar, typename TypeParam::Element>();
  must(body.set_velocities(testing::random_field<Scalar>(body.vertex_count(), 1, 3)));
  const Vec3<double> start = testing::linear_momentum(body);
  const double energy = testing::kinetic_energy(body);
  Bdf2 integrator(body, testing::solver({.tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-12}));
  for (int step = 0; step < 50; ++step) ASSERT_TRUE(integrator.step(body, Scalar(0.01)).accepted());
  EXPECT_LT((testing::linear_momentum(body) - start).norm(), (sizeof(Scalar) == 4 ? 1e-3 : 1e-9) * start.norm());
  EXPECT_LT(testing::kinetic_energy(body), 0.5 * energy) << "the case must tell";
}

/// Straight flight is exact. In a constant field the velocity is, and so is the parabola but for what the first step,
/// of backward Euler, leaves: it begins g h^2 / 2 off, of which 3/2 stays.
TYPED_TEST(Bdf2Motion, FreeFlightIsExact) {
  using Scalar = typename TypeParam::Scalar;
  for (const double g : {0.0, 10.0}) {
    auto body = free_block<Scalar, typename TypeParam::Element>();
    body.set_gravity({0, Scalar(-g), 0});
    must(body.set_velocities(Field<Scalar>(at(body.vertex_count()), Vec3<Scalar>(1, 2, 0))));
    Bdf2 integrator(body, testing::solver({.tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-12}));
    const int steps = 64;
    const double h = 1.0 / 64;
    StepReport report;
    for (int step = 0; step < steps; ++step) report = integrator.step(body, Scalar(h));
    // In float: of 72 such bodies, 1e-4 in the mean and 3e-4 at most.
    const double tolerance = sizeof(Scalar) == 4 ? 5e-4 : 1e-10, t = steps * h;
    EXPECT_LT(report.max_strain, tolerance);
    for (Index v = 0; v < body.vertex_count(); ++v) {
      const Vec3<double> x = body.displacements()[at(v)].template cast<double>();
      const Vec3<double> speed = body.velocities()[at(v)].template cast<double>();
      EXPECT_LT((speed - Vec3<double>(1, 2 - g * t, 0)).norm(), tolerance);
      EXPECT_LT((x - Vec3<double>(t, 2 * t - g * t * t / 2 - 0.75 * g * h * h, 0)).norm(), tolerance);
    }
  }
}

/// Vibration of a stiff body, far faster than a step, is gone within twenty steps; the slow swing of a soft beam is
/// kept far better than by backward Euler.
TYPED_TEST(Bdf2Motion, FastVibrationIsDampedAndSlowSwingIsKept) {
  using Scalar = typename TypeParam::Scalar;
  auto stiff = free_block<Scalar, typename TypeParam::Element>({.young = 5e7, .poisson = 0.3, .density = 1000});
  must(stiff.set_displacements(testing::random_field<Scalar>(stiff.vertex_count(), 1e-3, 4)));
  const double start = stiff.law().energy(stiff.displacements());
  Bdf2 integrator(stiff);
  for (int step = 0; step < 20; ++step) ASSERT_TRUE(integrator.step(stiff, Scalar(1.0 / 60)).accepted());
  EXPECT_LT(stiff.law().energy(stiff.displacements()), 1e-6 * start);

  // A beam is kicked in the shape of its first mode, whose period is some 0.9 s.
  const auto energy_left = [&]<class Integrator>(Integrator*) {
    auto body =
        testing::cantilever<Scalar, typename TypeParam::Element>({.size = {1, 0.2, 0.2}, .cells = {6, 1, 1}}, soft, 0);
    Field<Scalar> kick;
    for (const auto& x : body.mesh().positions())
      kick.push_back({0, 0, Scalar(0.3) * x.x() * x.x() * (6 - x.x() * (4 - x.x()))});
    must(body.set_velocities(kick));
    const double first = testing::energy(body);
    Integrator stepper(body);
    for (int step = 0; step < 60; ++step) EXPECT_TRUE(stepper.step(body, Scalar(1.0 / 60)).accepted());
    return testing::energy(body) / first;
  };
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  const double euler = energy_left(static_cast<ImplicitEuler<Body>*>(nullptr));
  const double bdf2 = energy_left(static_cast<Bdf2<Body>*>(nullptr));
  std::printf("energy of a swing left after 60 steps: backward Euler %.3f, BDF2 %.3f\n", euler, bdf2);
  EXPECT_GT(bdf2, 0.9);
  EXPECT_LT(1 - bdf2, 0.25 * (1 - euler));
}

/// History serves only where the body is where the last step left it.
TYPED_TEST(Bdf2Motion, StartsAnewAfterTheStateWasSet) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  auto body =
      testing::cantilever<Scalar, typename TypeParam::Element>({.size = {1, 0.2, 0.2}, .cells = {3, 1, 1}}, soft, 9.81);
  const SolverOptions exact{.method = SolverMethod::cholesky, .tolerance = 1e-5};
  const StepOptions plain{.tangent = Tangent::warped};  // the same matrix for both
  const Scalar h = Scalar(0.01);
  Bdf2 integrator(body, exact, plain);
  const auto difference = [&](auto&& other, Scalar other_h) {  // of the next step, from that by `other`
    auto copy = body;
    EXPECT_TRUE(other.step(copy, other_h).accepted());
    EXPECT_TRUE(integrator.step(body, other_h).accepted());
    return (flat(body.velocities()) - flat(copy.velocities())).norm();
  };
  const auto euler = [&] { return ImplicitEuler<Body>(body, exact, plain); };
  EXPECT_EQ(difference(euler(), h), 0) << "first step";
  EXPECT_GT(difference(euler(), h), 0) << "second step";
  must(body.set_velocities(testing::random_field<Scalar>(body.vertex_count(), 1, 2)));
  EXPECT_EQ(difference(euler(), h), 0) << "after a kick";
  EXPECT_GT(difference(euler(), h), 0);
  must(body.set_displacements(testing::random_field<Scalar>(body.vertex_count(), 0.01, 2)));
  EXPECT_EQ(difference(euler(), h), 0) << "after a displacement";
  EXPECT_GT(difference(euler(), h), 0);
  EXPECT_EQ(difference(euler(), 3 * h), 0) << "after a step three times as long";

  auto undisturbed = integrator;
  EXPECT_FALSE(integrator.step(body, -h).accepted());
  const testing::WithoutTraps overflow_is_meant;
  body.external_forces()[5].x() = std::numeric_limits<Scalar>::max();
  EXPECT_FALSE(integrator.step(body, Scalar(2)).accepted());
  body.external_forces()[5].x() = 0;
  EXPECT_EQ(difference(undisturbed, h), 0) << "a refusal changes nothing";
}

}  // namespace
}  // namespace corotet::second_order_test
