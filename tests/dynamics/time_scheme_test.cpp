// The doors for time schemes and for Newton's method: a scheme of third order, written here, reaches its order;
// Newton's method solves a problem that is no body.
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/integrator.hpp>
#include <corotet/detail/dynamics/newton.hpp>
#include <gtest/gtest.h>

#include <cmath>

#include "support/bodies.hpp"

namespace corotet::time_scheme_test {
namespace {

using testing::must;

/// The backward differentiation formula of third order, steps of one length: gamma = 6 h / 11,
/// x_history = (18 x - 9 x_1 + 2 x_2) / 11 (Hairer, Nørsett & Wanner 1993, section III.1). The first two are backward
/// Euler's.
template <class Body>
class Bdf3Scheme {
 public:
  using Scalar = typename Body::scalar_type;

  explicit Bdf3Scheme(const Body& body) : x_(body.displacements()), v_(x_) {
    for (int k = 0; k < 2; ++k) past_x_[k] = past_v_[k] = x_;
  }
  TimeStep<Scalar> discretize(const Body& body, Scalar h, ExecutorRef) {
    if (steps_ < 2) return backward_euler(body, h);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] =
          (Scalar(18) * body.displacements()[i] - Scalar(9) * past_x_[0][i] + Scalar(2) * past_x_[1][i]) / Scalar(11);
      v_[i] = (Scalar(18) * body.velocities()[i] - Scalar(9) * past_v_[0][i] + Scalar(2) * past_v_[1][i]) / Scalar(11);
    }
    return {.gamma = 6 * h / 11, .x_history = x_, .v_history = v_, .h = h, .order = 3, .linearization_time = h};
  }
  void accept(const Body&, Scalar, const StepReport&, Field<Scalar>& x, Field<Scalar>& v) {
    past_x_[0].swap(past_x_[1]);
    past_v_[0].swap(past_v_[1]);
    past_x_[0].swap(x);
    past_v_[0].swap(v);
    ++steps_;
  }

 private:
  Field<Scalar> x_, v_, past_x_[2], past_v_[2];
  int steps_ = 0;
};

template <class Element>
class Scheme : public ::testing::Test {
 public:
  using Body = SoftBody<double, Element>;

  static Body beam() {
    Body body = testing::cantilever<double, Element>({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}},
                                                     Material{.young = 1e5, .poisson = 0.3, .density = 1000}, 0,
                                                     {.damping = {.mass = 0.2, .stiffness = 0.002}});
    return body;
  }

  /// The state at 1 s under gravity that grows as t^4: so smoothly that the first steps' order does not matter.
  template <template <class> class S>
  static Field<double> run(int steps) {
    Body body = beam();
    Integrator<Body, S<Body>, AutoSolver<double>> integrator(body, AutoSolver<double>({.tolerance = 1e-11}),
                                                             {.iterations = 30, .tolerance = 1e-12});
    const double h = 1.0 / steps;
    for (int step = 1; step <= steps; ++step) {
      body.set_gravity({0, 0, -4 * std::pow(step * h, 4)});
      if (!integrator.step(body, h, {}).accepted()) return {};
    }
    return body.displacements();
  }
};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(Scheme, Elements);

TYPED_TEST(Scheme, OfThirdOrderConverges) {
  const auto exact = TestFixture::template run<Bdf3Scheme>(640);
  const auto error = [&](int steps) {
    const auto u = TestFixture::template run<Bdf3Scheme>(steps);
    double sum = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) sum += (u[i] - exact[i]).squaredNorm();
    return std::sqrt(sum);
  };
  const double coarse = error(40), fine = error(80);
  EXPECT_GT(std::log2(coarse / fine), 2.7) << coarse << " and " << fine;
}

/// A scheme that discretises as backward Euler is ImplicitEuler, to the last bit.
TYPED_TEST(Scheme, IsAllThatMakesAnIntegrator) {
  auto first = this->beam(), second = first;
  Integrator<typename TestFixture::Body, detail::BackwardEulerScheme<typename TestFixture::Body>, AutoSolver<double>>
      own(first, AutoSolver<double>(), {});
  ImplicitEuler euler(second);
  for (auto* body : {&first, &second}) body->set_gravity({1, 2, -9.81});
  for (int step = 0; step < 10; ++step) {
    ASSERT_TRUE(own.step(first, 1.0 / 60, {}).accepted());
    ASSERT_TRUE(euler.step(second, 1.0 / 60).accepted());
  }
  EXPECT_EQ(first.displacements(), second.displacements());
  EXPECT_GT(testing::max_displacement(first), 0.01) << "the case must tell";
}

/// Phi(x) = sqrt(1 + x^2) + x^2/20, whose full Newton steps from far away overshoot.
struct Bowl {
  double x = 0, d = 0;
  int projected = 0;

  double phi(double at) const { return std::sqrt(1 + at * at) + at * at / 20; }
  double gradient(double at) const { return at / std::sqrt(1 + at * at) + at / 10; }
  double curvature() const { return std::pow(1 + x * x, -1.5) + 0.1; }

  void linearize(bool) {}
  SolveStatus solve() { return d = -gradient(x) / curvature(), SolveStatus::converged; }
  double decrement2() const { return -gradient(x) * d; }
  double gradient_norm() const { return std::fabs(gradient(x)); }
  bool project_tangent(bool) { return ++projected, false; }
  double noise() const { return 1e-15; }
  double rounding() const { return 1e-12; }
  double search(double decrement, double noise_of_phi) const {
    return detail::backtrack(-decrement, noise_of_phi, [&](double fraction) { return phi(x + fraction * d) - phi(x); });
  }
  bool apply(double fraction) { return x += fraction * d, std::isfinite(x); }
  void evaluate() {}
};

TEST(Newton, SolvesAProblemThatIsNoBody) {
  for (const double start : {0.1, 3.0, -40.0}) {
    Bowl bowl{.x = start};
    const detail::NewtonResult result = detail::newton_solve(bowl, 50, 1e-10, true);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(bowl.x, 0, 1e-9);
    EXPECT_EQ(bowl.projected, 0);
  }
}

TEST(Newton, TakesOneCorrectionAsItIs) {
  Bowl bowl{.x = 3};
  const detail::NewtonResult result = detail::newton_solve(bowl, 1, 1e-10, true);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_DOUBLE_EQ(bowl.x, 3 + bowl.d);
  EXPECT_LT(bowl.x, 0) << "it overshoots";
}

TEST(Newton, ReportsWhatKeptItFromConverging) {
  Bowl bowl{.x = -40};
  const detail::NewtonResult result = detail::newton_solve(bowl, 2, 1e-10, true);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_GT(result.residual, 1e-10);
}

}  // namespace
}  // namespace corotet::time_scheme_test
