// Steps of bodies with another elastic model than the corotated one: the same integrators and Newton's method.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/material/stable_neo_hookean.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <type_traits>
#include <vector>

#include "support/bodies.hpp"
#include "support/hard_step.hpp"
#include "support/pairs.hpp"
#include "support/random.hpp"
#include "support/softening_model.hpp"
#include "support/solver_choice.hpp"

namespace corotet::elastic_model_step_test {
namespace {

using testing::must;

constexpr Material soft{.young = 5e5, .poisson = 0.3, .density = 1000};

template <class Scalar, class Element>
using Rubber = SoftBody<Scalar, Element, StableNeoHookean>;

template <class Scalar, class Element, class Law = StableNeoHookean>
SoftBody<Scalar, Element, Law> beam(const BlockOptions& block, const Material& material = soft,
                                    const BodyOptions& options = {}) {
  auto body = must(SoftBody<Scalar, Element, Law>::create(testing::block<Scalar, Element>(block), material, options));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
  return body;
}

/// A step of a body far from rest, in motion, with damping and a pin that moves. The semi-definite tangent, which the
/// other choices ask for, converges too.
template <class Element>
void expect_quadratic_convergence() {
  auto body = beam<double, Element>({.size = {1, 0.2, 0.2}, .cells = {4, 1, 1}}, soft,
                                    {.damping = {.mass = 0.5, .stiffness = 0.002}});
  body.set_gravity({0, 0, -9.81});
  testing::make_step_hard(body);
  const std::vector<double> exact = testing::errors_of_solves(body, Tangent::consistent, 5);
  const std::vector<double> semi_definite = testing::errors_of_solves(body, Tangent::warped, 5);
  for (int k = 0; k < 5; ++k)
    std::printf("%d solves: exact %.1e semi-definite %.1e\n", k + 1, exact[at(k)], semi_definite[at(k)]);
  testing::expect_quadratic(exact);
  EXPECT_LT(exact[3], 1e-9);
  EXPECT_LT(semi_definite[4], semi_definite[0] / 10);
}

TEST(NeoHookeanSteps, ConvergeQuadraticallyWithTheExactTangent) {
  expect_quadratic_convergence<Tet4>();
  expect_quadratic_convergence<Tet10>();
}

/// Small strains are those of the corotated body, step by step, with each integrator and precision.
template <class Scalar, class Element, template <class> class Integrator>
void expect_small_strains_as_corotated() {
  const BlockOptions block{.size = {1, 0.2, 0.2}, .cells = {6, 1, 1}};
  const Material stiff{.young = 5e7, .poisson = 0.3, .density = 1000};
  auto rubber = beam<Scalar, Element>(block, stiff);
  auto corotated = beam<Scalar, Element, Polar>(block, stiff);
  const auto fall = [](auto& body) {
    body.set_gravity({0, 0, Scalar(-9.81)});
    Integrator<std::remove_cvref_t<decltype(body)>> integrator(body, testing::solver({.tolerance = 1e-6}));
    for (int step = 0; step < 30; ++step) ASSERT_TRUE(integrator.step(body, Scalar(1.0 / 60)).accepted());
  };
  fall(rubber);
  fall(corotated);
  const auto expected = flat(corotated.displacements());
  EXPECT_LT(double((flat(rubber.displacements()) - expected).norm()), 0.01 * double(expected.norm()));
}

template <class Body>
using Euler = ImplicitEuler<Body>;
template <class Body>
using SecondOrder = Bdf2<Body>;

TEST(NeoHookeanSteps, AreThoseOfTheCorotatedBodyForSmallStrains) {
  expect_small_strains_as_corotated<float, Tet4, Euler>();
  expect_small_strains_as_corotated<double, Tet10, Euler>();
  expect_small_strains_as_corotated<double, Tet4, SecondOrder>();
}

/// From flat, a line, a point, mirrored and anywhere: no step is refused, all numbers stay finite, and no energy comes
/// from nowhere. With one solve a step, whose energy is bounded, it never rises; by Newton's method it may rise from
/// step to step where the law is not convex, as that of the corotated body does, but never above that at the start.
template <class Scalar, class Element>
void expect_no_harm_from_hard_starts() {
  const std::array<Index, 3> cells =
      Element::nodes == 4 ? std::array<Index, 3>{8, 2, 2} : std::array<Index, 3>{4, 1, 1};
  struct Start {
    const char* name;
    Vec3<double> factor;
    double anywhere;  // m
  };
  const std::array starts{Start{"flat, across", {1, 1, 0}, 0},
                          Start{"flat, along", {0, 1, 1}, 0},
                          Start{"line", {1, 0, 0}, 0},
                          Start{"point", {0, 0, 0}, 0},
                          Start{"nearly a point", {0, 0, 0}, 1e-6},
                          Start{"mirrored along", {-1, 1, 1}, 0},
                          Start{"mirrored across", {1, 1, -1}, 0},
                          Start{"anywhere", {0, 0, 0}, 0.3}};
  const auto expect_no_harm = [&](double poisson, int iterations, const Start& start) {
    const std::string name =
        std::string(start.name) + ", nu " + std::to_string(poisson) + (iterations > 1 ? ", Newton" : "");
    auto body = beam<Scalar, Element>({.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = cells},
                                      {.young = 5e5, .poisson = poisson, .density = 1000});
    testing::Random random(1);
    must(body.set_displacements(testing::displacement_of(body.mesh(), [&](const Vec3<double>& x) {
      const Vec3<double> off = random.vector(start.anywhere);
      return x.x() == 0 ? x : Vec3<double>(x.cwiseProduct(start.factor) + off);
    })));
    const double at_start = testing::energy(body);
    testing::EnergyWatch watch(testing::energy(body));
    ImplicitEuler euler(body, testing::solver(),
                        iterations == 1
                            ? StepOptions{}
                            : StepOptions{.iterations = 30, .tolerance = 1e-6, .tangent = Tangent::consistent});
    double most = 0;
    for (int step = 0; step < 40; ++step) {
      const StepReport report = euler.step(body, Scalar(1.0 / 60));
      ASSERT_TRUE(report.accepted()) << name << " step " << step << ": " << report.advice();
      most = std::max(most, testing::energy(body));
      watch.see(testing::energy(body));
    }
    for (const auto& x : body.displacements()) ASSERT_TRUE(x.allFinite()) << name;
    const double rounding = sizeof(Scalar) == 4 ? 1e-5 : 1e-12;
    EXPECT_LT(most, (1 + rounding) * at_start) << name;
    if (iterations == 1) {
      EXPECT_LE(watch.rise(), rounding * at_start) << name;
    }
    EXPECT_LT(testing::energy(body), 0.3 * at_start) << name;
  };
  testing::for_pairs(testing::seed_of<Scalar, Element>, expect_no_harm, std::array{0.3, 0.49}, std::array{1, 30},
                     starts);
}

TEST(NeoHookeanSteps, FromHardStartsNeverRefuseNorGainEnergy) {
  expect_no_harm_from_hard_starts<float, Tet4>();
  expect_no_harm_from_hard_starts<double, Tet10>();
}

/// A free body keeps its momenta.
TEST(NeoHookeanSteps, FreeBodiesKeepTheirSpin) {
  auto body = must(Rubber<double, Tet4>::create(
      testing::block<double, Tet4>({.corner = {-0.2, -0.15, -0.1}, .size = {0.4, 0.3, 0.2}, .cells = {3, 2, 2}}),
      soft));
  must(body.set_velocities(testing::spin_of(body.mesh(), {0, 0, 6})));
  const double start = testing::angular_momentum(body).z();
  ImplicitEuler euler(body, testing::solver({.tolerance = 1e-5}));
  double farthest = 0;
  for (int step = 0; step < 300; ++step) {
    ASSERT_TRUE(euler.step(body, 1.0 / 60).accepted());
    farthest = std::max(farthest, testing::max_displacement(body));
  }
  EXPECT_GT(farthest, 0.45) << "a corner must have been on the other side";
  EXPECT_NEAR(testing::angular_momentum(body).z() / start, 1, 1e-10);
}

/// A body that softens is pulled and let go. After each accepted step its states are the trial states of where it is,
/// from those before, however many evaluations the step took; a refused step changes none.
template <class Scalar, class Element>
void expect_states_of_accepted_steps(const StepOptions& newton) {
  using Body = SoftBody<Scalar, Element, testing::Softening>;
  auto body = must(Body::create(testing::block<Scalar, Element>({.size = {1, 0.25, 0.25}, .cells = {4, 1, 1}}),
                                Material{.young = 3e4, .poisson = 0.3, .density = 900}));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(1e-6) || x.x() > Scalar(1 - 1e-6); });
  ImplicitEuler euler(body, testing::solver(), newton);
  typename Body::Law::Evaluation evaluation(body.law());
  const auto numbers = [](const typename Body::States& states) {
    std::vector<Scalar> kappa;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const auto lanes = states.get(k % Body::Law::points, Index(k / Body::Law::points)).kappa.values();
      kappa.insert(kappa.end(), lanes.begin(), lanes.end());
    }
    return kappa;
  };
  const std::vector<Scalar> at_rest = numbers(body.point_states());
  for (int step = 1; step <= 40; ++step) {
    const double stretch = 0.15 * (step <= 20 ? step : 40 - step) / 20;
    for (Index v = 0; v < body.vertex_count(); ++v)
      if (body.pins().is_pinned(v)) {
        const Vec3<Scalar>& x = body.mesh().position(v);
        body.move_pin(v, x + Vec3<Scalar>(x.x() * Scalar(stretch), 0, 0));
      }
    const typename Body::States before = body.point_states();
    ASSERT_FALSE(euler.step(body, Scalar(-1)).accepted());
    ASSERT_EQ(numbers(body.point_states()), numbers(before));
    ASSERT_TRUE(euler.step(body, Scalar(1.0 / 60)).accepted());
    body.law().evaluate(body.displacements(), before, evaluation, ExecutorRef());
    ASSERT_EQ(numbers(body.point_states()), numbers(evaluation.trial())) << "step " << step;
  }
  EXPECT_NE(numbers(body.point_states()), at_rest);
}

TEST(StatefulSteps, CommitTheStatesOfAcceptedStepsAlone) {
  for (const StepOptions& newton : {StepOptions{}, StepOptions{.iterations = 20, .tangent = Tangent::consistent}}) {
    expect_states_of_accepted_steps<double, Tet4>(newton);
    expect_states_of_accepted_steps<float, Tet10>(newton);
  }
}

}  // namespace
}  // namespace corotet::elastic_model_step_test
