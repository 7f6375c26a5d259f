// Newton's method within a step, and the tangents that it may use.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "support/bodies.hpp"
#include "support/hard_step.hpp"
#include "support/random.hpp"
#include "support/solver_choice.hpp"

namespace corotet::newton_test {
namespace {

using testing::must;

constexpr Material soft{.young = 5e5, .poisson = 0.3, .density = 1000};
constexpr SolverOptions direct{.method = SolverMethod::cholesky, .tolerance = 1e-12};
constexpr std::array all_tangents{Tangent::warped, Tangent::stabilized, Tangent::consistent};

/// Tip deflections of converged backward Euler at 1/60 s with consistent mass, by independent programs.
TEST(Newton, ReproducesTheConvergedReferenceBeam) {
  auto body = testing::cantilever<double, Tet4>(
      {.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = {20, 4, 4}, .split = BlockSplit::kuhn6}, soft, 9.81,
      {.mass = MassModel::consistent, .damping = {}});
  ImplicitEuler euler(body, testing::solver({.tolerance = 1e-4}),
                      StepOptions{.iterations = 10, .tolerance = 1e-5, .tangent = Tangent::consistent});
  const Index tip = body.mesh().nearest_vertex({1, 0, 0});
  int solves = 0;
  for (int step = 1; step <= 60; ++step) {
    const StepReport report = euler.step(body, 1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.advice();
    EXPECT_LE(report.newton_residual, 1e-5);
    solves += report.newton_iterations;
    const double z = body.displacements()[at(tip)].z();
    const double expected = step == 15 ? -0.39337 : step == 30 ? -0.76457 : step == 60 ? -0.23199 : z;
    EXPECT_NEAR(z, expected, 1e-5) << "after " << step << " steps";
  }
  EXPECT_LE(solves, 4 * 60);
}

template <class Element>
SoftBody<double, Element> hard_step() {
  auto body = testing::cantilever<double, Element>({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}}, soft, 9.81,
                                                   {.damping = {.mass = 0.5, .stiffness = 0.002}});
  testing::make_step_hard(body);
  return body;
}

template <class Element>
void expect_quadratic_convergence() {
  const std::vector<double> exact = testing::errors_of_solves(hard_step<Element>(), Tangent::consistent, 5);
  const std::vector<double> plain = testing::errors_of_solves(hard_step<Element>(), Tangent::warped, 5);
  for (int k = 0; k < 5; ++k) std::printf("%d solves: exact %.1e plain %.1e\n", k + 1, exact[at(k)], plain[at(k)]);
  testing::expect_quadratic(exact);
  EXPECT_GT(plain[3], 1e-9);
}

TEST(Newton, ConvergesQuadraticallyWithTheExactTangent) {
  expect_quadratic_convergence<Tet4>();
  expect_quadratic_convergence<Tet10>();
}

/// Which tangent is used does not change what is solved, damping included.
TEST(Newton, AllTangentsFindTheSameState) {
  const auto start = hard_step<Tet10>();
  std::vector<SoftBody<double, Tet10>> solution;
  for (const Tangent tangent : all_tangents) {
    solution.push_back(start);
    ImplicitEuler euler(solution.back(), direct, {.iterations = 100, .tolerance = 1e-11, .tangent = tangent});
    const StepReport report = euler.step(solution.back(), 1.0 / 60);
    EXPECT_TRUE(report.newton_converged) << name_of(tangent) << report.newton_residual;
    EXPECT_LT((flat(solution.back().displacements()) - flat(solution.front().displacements())).norm(), 1e-9);
    EXPECT_GT((flat(solution.back().displacements()) - flat(start.displacements())).norm(), 0.01);
  }
}

template <class T>
class NewtonSteps : public ::testing::Test {};
using Cases = ::testing::Types<testing::Case<float, Tet4>, testing::Case<double, Tet10>>;
TYPED_TEST_SUITE(NewtonSteps, Cases);

template <class Scalar, class Element>
SoftBody<Scalar, Element> bar(const Material& material) {
  const std::array<Index, 3> cells =
      Element::order == 1 ? std::array<Index, 3>{8, 2, 2} : std::array<Index, 3>{5, 1, 1};
  return must(SoftBody<Scalar, Element>::create(
      testing::block<Scalar, Element>({.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = cells}), material));
}

/// A bar held at several times its length comes to rest, with the default options too: one plain solve a step buzzes
/// for ever. (Thinner than 1 + 1/nu times its length there is no rest, whatever the integrator.)
TYPED_TEST(NewtonSteps, AStretchedBarComesToRest) {
  using Scalar = typename TypeParam::Scalar;
  struct Held {
    double stretch, poisson;
  };
  double plain = 0;
  for (const Held& held : {Held{3, 0.3}, Held{4, 0.3}, Held{5, 0}, Held{8, 0}}) {
    const auto speed_with = [&](const StepOptions& newton) {
      auto body = bar<Scalar, typename TypeParam::Element>({.young = 5e5, .poisson = held.poisson});
      const double side = 1 - held.poisson * (held.stretch - 1);
      const Field<Scalar> noise = testing::random_field<Scalar>(body.vertex_count(), 1e-3, 1);
      auto u = testing::displacement_of(
          body.mesh(), [&](const Vec3<double>& x) { return x.cwiseProduct(Vec3<double>(held.stretch, side, side)); });
      flat(u) += flat(noise);
      must(body.set_displacements(u));
      for (Index v = 0; v < body.vertex_count(); ++v) {
        const Scalar x = body.mesh().position(v).x();
        if (x < Scalar(1e-6) || x > Scalar(1 - 1e-6)) body.pins().pin(v, {x * Scalar(held.stretch - 1), 0, 0});
      }
      ImplicitEuler euler(body, testing::solver(), newton);
      for (int step = 0; step < 120; ++step) EXPECT_TRUE(euler.step(body, Scalar(1.0 / 60)).accepted());
      return testing::max_speed(body);
    };
    const double resting = sizeof(Scalar) == 4 ? 1e-3 : 1e-6;  // m/s; float rounds positions to 1e-7 m, 1e-5 m/s
    EXPECT_LT(speed_with({}), resting) << "x" << held.stretch;
    EXPECT_LT(speed_with({.iterations = 10, .tangent = Tangent::consistent}), resting) << "x" << held.stretch;
    plain = std::max(plain, speed_with({.tangent = Tangent::warped, .bounds_energy = false}));
  }
  EXPECT_GT(plain, 1) << "the cases must be hard";
}

/// Share of the angular momentum that a free block keeps over ten revolutions at 0.1 rad a step.
template <class Integrator, class Body>
double spin_kept(Body body, const StepOptions& newton) {
  using Scalar = typename Body::scalar_type;
  const double turn = 0.1, h = 1.0 / 60;
  must(body.set_velocities(testing::spin_of(body.mesh(), {0, 0, turn / h})));
  const double start = testing::angular_momentum(body).z();
  Integrator integrator(body, testing::solver({.tolerance = 1e-5}), newton);
  for (int step = 0; step < int(10 * 2 * std::numbers::pi / turn); ++step)
    EXPECT_TRUE(integrator.step(body, Scalar(h)).accepted());
  return testing::angular_momentum(body).z() / start;
}

/// With the options with which stretched bars come to rest, spin is kept, too.
TYPED_TEST(NewtonSteps, AFreeBlockKeepsItsSpinWithTheDefaultOptions) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  const Body block =
      must(Body::create(testing::block<Scalar, typename TypeParam::Element>(
                            {.corner = {-0.2, -0.15, -0.1}, .size = {0.4, 0.3, 0.2}, .cells = {3, 2, 2}}),
                        soft));
  const double rounding = sizeof(Scalar) == 4 ? 1e-4 : 1e-10;
  EXPECT_NEAR(spin_kept<ImplicitEuler<Body>>(block, {}), 1, rounding);
  EXPECT_NEAR(spin_kept<ImplicitEuler<Body>>(block, {.iterations = 10, .tangent = Tangent::consistent}), 1, rounding);
  EXPECT_NEAR(spin_kept<Bdf2<Body>>(block, {}), 1, rounding);

  // What the integrators do by themselves: the default tangent brakes least.
  const auto by_itself = [](StepOptions newton) {
    newton.keeps_angular_momentum = false;
    return newton;
  };
  const double kept = spin_kept<ImplicitEuler<Body>>(block, by_itself({}));
  EXPECT_GT(kept, 0.99);
  EXPECT_LT(kept, 1.01);
  EXPECT_GT(spin_kept<Bdf2<Body>>(block, by_itself({})), 0.95);
  EXPECT_LT(spin_kept<ImplicitEuler<Body>>(block, by_itself({.tangent = Tangent::consistent})), kept);
  EXPECT_LT(spin_kept<ImplicitEuler<Body>>(block, by_itself({.iterations = 10, .tangent = Tangent::consistent})), 0.9)
      << "the case must tell";
}

/// A free block that is kicked at random, spins by half a rad a step, flies, is pulled round and damped has the angular
/// momentum that it should have, about its centre of mass and to rounding.
TYPED_TEST(NewtonSteps, AngularMomentumIsWhatForcesAndDampingMakeIt) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  const double h = 1.0 / 60, damping = 0.5, rounding = sizeof(Scalar) == 4 ? 1e-3 : 1e-10;
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent})
    for (const int iterations : {1, 4}) {
      Body body = must(Body::create(testing::block<Scalar, typename TypeParam::Element>(
                                        {.corner = {3, -0.15, -0.1}, .size = {0.4, 0.3, 0.2}, .cells = {3, 2, 2}}),
                                    Material{.young = 5e6, .poisson = 0.3, .density = 1000},
                                    {.mass = mass, .damping = {.mass = damping, .stiffness = 0.01}}));
      body.set_gravity({0, Scalar(-9.81), 0});
      testing::Random random(7);
      Field<Scalar> velocity;
      for (const auto& x : body.mesh().positions())
        velocity.push_back((Vec3<double>(10, 20, 5) + random.vector(1.5) +
                            Vec3<double>(0.1, 0.5 / h, 0.2).cross(x.template cast<double>()))
                               .template cast<Scalar>());
      must(body.set_velocities(velocity));
      const Index a = 0, b = body.vertex_count() - 1;
      body.external_forces()[at(a)] = {0, 0, Scalar(30)};
      body.external_forces()[at(b)] = {0, 0, Scalar(-30)};

      const auto arm = [&](Index v) {
        return (body.position(v) + Scalar(h / 2) * body.velocities()[at(v)]).template cast<double>();
      };
      const Vec3<double> start = testing::angular_momentum(body);
      Vec3<double> expected = start;
      ImplicitEuler euler(body, testing::solver({.tolerance = 1e-2}),
                          StepOptions{.iterations = iterations, .tangent = Tangent::consistent});
      for (int step = 0; step < 40; ++step) {
        const Vec3<double> torque = (arm(a) - arm(b)).cross(Vec3<double>(0, 0, 30));
        const double decay = 1 / (1 + h * damping);
        expected = decay * expected + h * std::sqrt(decay) * torque;
        ASSERT_TRUE(euler.step(body, Scalar(h)).accepted());
      }
      EXPECT_LT((testing::angular_momentum(body) - expected).norm(), rounding * start.norm())
          << "Newton " << iterations;
      EXPECT_GT((expected - start).norm(), 0.05 * start.norm()) << "the case must tell";
    }
}

/// A bar squeezed to three quarters wants to buckle: its Hessian is indefinite, and steps go on all the same.
TYPED_TEST(NewtonSteps, AnIndefiniteHessianIsProjectedAndNotRefused) {
  using Scalar = typename TypeParam::Scalar;
  for (const int iterations : {1, 20}) {
    auto body = bar<Scalar, typename TypeParam::Element>(soft);
    must(body.set_displacements(testing::displacement_of(
        body.mesh(), [](const Vec3<double>& x) { return Vec3<double>(0.75 * x.x(), x.y(), x.z()); })));
    body.pin_where([](const auto& x) { return x.x() < Scalar(1e-6) || x.x() > Scalar(1 - 1e-6); });
    body.external_forces()[at(body.mesh().nearest_vertex({0.5, 0, 0}))].y() = 1;
    ImplicitEuler euler(body, testing::solver(), StepOptions{.iterations = iterations, .tangent = Tangent::consistent});
    for (int step = 0; step < 120; ++step) {
      const StepReport report = euler.step(body, Scalar(1.0 / 60));
      ASSERT_TRUE(report.accepted()) << report.advice();
      EXPECT_TRUE(report.newton_converged) << "step " << step;
      EXPECT_EQ(report.inverted_elements, 0);
    }
    EXPECT_LT(testing::max_speed(body), 0.1);
    EXPECT_GT(double(body.displacements()[at(body.mesh().nearest_vertex({0.5, 0, 0}))].y()), 0.1) << "it has buckled";
  }
}

/// Too few iterations are said; a body at rest, where only rounding is left to solve, is not an error.
TYPED_TEST(NewtonSteps, SayWhetherTheyConverged) {
  using Scalar = typename TypeParam::Scalar;
  auto body = bar<Scalar, typename TypeParam::Element>(soft);
  body.pin_where([](const auto& x) { return x.x() < Scalar(1e-6); });
  body.set_gravity({0, 0, Scalar(-9.81)});
  auto resting = body;
  ImplicitEuler two(body, testing::solver(), StepOptions{.iterations = 2, .tolerance = 1e-14});
  StepReport report;
  for (int step = 0; step < 5; ++step) report = two.step(body, Scalar(0.1));
  EXPECT_TRUE(report.accepted());
  EXPECT_FALSE(report.newton_converged);
  EXPECT_FALSE(report.ok());
  EXPECT_STRNE(report.advice(), "");
  EXPECT_EQ(report.newton_iterations, 2);
  EXPECT_GT(report.newton_residual, 1e-14);

  ImplicitEuler many(resting, testing::solver(), StepOptions{.iterations = 20, .tangent = Tangent::consistent});
  for (int step = 0; step < 100; ++step) {
    report = many.step(resting, Scalar(0.2));
    EXPECT_TRUE(report.newton_converged) << "step " << step << " residual " << report.newton_residual;
  }
  EXPECT_LT(testing::max_speed(resting), 1e-3);

  const auto before = body;
  for (const StepOptions& bad : {StepOptions{.iterations = 0}, StepOptions{.tolerance = 0}, StepOptions{.tolerance = 1},
                                 StepOptions{.tolerance = std::numeric_limits<double>::quiet_NaN()}}) {
    ImplicitEuler euler(body, testing::solver(), bad);
    report = euler.step(body, Scalar(0.1));
    EXPECT_EQ(report.error, StepError::newton_options);
    EXPECT_STRNE(report.advice(), "");
    EXPECT_EQ(flat(body.displacements()), flat(before.displacements()));
  }
}

TEST(LineSearch, GoesAsFarAsTheEnergyFalls) {
  const auto parabola = [](double x) { return -x + x * x; };  // slope -1, least at 1/2, zero at 1
  EXPECT_EQ(detail::backtrack(-1, 0, parabola), 0.5);
  EXPECT_EQ(detail::backtrack(-1, 0, [](double x) { return -x; }), 1);
  EXPECT_EQ(detail::backtrack(-1, 0.1, parabola), 1) << "within rounding";
  EXPECT_EQ(detail::backtrack(-1, 0, [](double x) { return x; }), 0);
  EXPECT_EQ(detail::backtrack(-1, 0, [](double x) { return x > 0.2 ? std::nan("") : -x; }), 0.125);
}

}  // namespace
}  // namespace corotet::newton_test
