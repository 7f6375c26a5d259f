// The forces of pins: balance of forces at rest and of momenta in motion.
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/measures.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "support/bodies.hpp"
#include "support/random.hpp"
#include "support/solver_choice.hpp"

namespace corotet::pin_reactions_test {
namespace {

using testing::must;

constexpr Material soft{.young = 2e5, .poisson = 0.4, .density = 1000};
constexpr StepOptions converged{.iterations = 50, .tolerance = 1e-8};
constexpr SolverOptions tight{.tolerance = 1e-10};

/// Finite differences and balances need double.
template <class Element>
class PinReactionsOf : public ::testing::Test {
 protected:
  using Body = SoftBody<double, Element>;

  /// Hangs from its left side and from a vertex elsewhere that may slide along x, pulled by gravity and by a force.
  static Body hanging(const BodyOptions& options) {
    Body body = testing::cantilever<double, Element>({.size = {1, 0.3, 0.25}, .cells = {4, 1, 1}}, soft, 9.81, options);
    const Index other = body.mesh().nearest_vertex({0.75, 0.3, 0.25});
    body.pins().pin(other, body.displacements()[at(other)], {.x = false, .y = true, .z = true});
    body.external_forces()[at(body.mesh().nearest_vertex({1, 0, 0}))] = {5, 20, -10};
    return body;
  }
  static void settle(Body& body) {
    ImplicitEuler euler(body, testing::solver(tight), converged);
    for (int step = 0; step < 30; ++step) ASSERT_TRUE(euler.step(body, 100.0).accepted());
  }

  /// The sum of f(v) over the body.
  template <class PerVertex>
  static Vec3<double> sum(const Body& body, const PerVertex& per_vertex) {
    Vec3<double> total = Vec3<double>::Zero();
    for (Index v = 0; v < body.vertex_count(); ++v) total += per_vertex(v);
    return total;
  }
  static Vec3<double> load(const Body& body, Index v) {
    return body.external_forces()[at(v)] + body.mass().row_sum(v) * body.gravity();
  }
};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(PinReactionsOf, Elements);

constexpr std::array<BodyOptions, 4> all_options{
    {{.mass = MassModel::lumped, .damping = {}, .volumetric_strain = VolumetricStrain::pointwise},
     {.mass = MassModel::consistent, .damping = {}, .volumetric_strain = VolumetricStrain::averaged},
     {.mass = MassModel::lumped,
      .damping = {.mass = 0.7, .stiffness = 0.01},
      .volumetric_strain = VolumetricStrain::averaged},
     {.mass = MassModel::consistent,
      .damping = {.mass = 0, .stiffness = 0.02},
      .volumetric_strain = VolumetricStrain::pointwise}}};

TYPED_TEST(PinReactionsOf, AHangingBodyIsHeldByItsWeight) {
  for (const BodyOptions& options : all_options) {
    auto body = this->hanging(options);
    for (Vec3<double>& f : body.external_forces()) f.setZero();
    this->settle(body);
    PinReactions reactions(body);
    reactions.evaluate_static(body);
    const Vec3<double> weight = body.mass().total() * body.gravity();
    EXPECT_LE((reactions.total_force() + weight).norm(), 1e-7 * weight.norm());
    EXPECT_EQ(reactions.vertices().size(), body.pins().vertices().size());
  }
}

TYPED_TEST(PinReactionsOf, ForcesAndTorquesBalanceAtRest) {
  for (const BodyOptions& options : all_options) {
    auto body = this->hanging(options);
    this->settle(body);
    PinReactions reactions(body);
    reactions.evaluate_static(body);
    const Vec3<double> load = this->sum(body, [&](Index v) { return this->load(body, v); });
    EXPECT_LE((reactions.total_force() + load).norm(), 1e-7 * load.norm());
    for (const Vec3<double>& about : {Vec3<double>(0, 0, 0), Vec3<double>(2, -1, 3)}) {
      const Vec3<double> torque =
          this->sum(body, [&](Index v) { return (body.position(v) - about).cross(this->load(body, v)); });
      EXPECT_LE((reactions.total_torque(body, about) + torque).norm(), 1e-7 * torque.norm());
    }
  }
}

// A pin can be replaced by its force: the body stays where it is.
TYPED_TEST(PinReactionsOf, ReactionsHoldTheBodyInPlaceOfThePins) {
  auto body = this->hanging(all_options[0]);
  this->settle(body);
  PinReactions reactions(body);
  reactions.evaluate_static(body);
  must(body.set_velocities(Field<double>(at(body.vertex_count()), Vec3<double>::Zero())));
  auto released = body, fallen = body;
  for (std::size_t p = 0; p < reactions.vertices().size(); ++p) {
    const Index v = reactions.vertices()[p];
    released.pins().release(v);
    fallen.pins().release(v);
    released.external_forces()[at(v)] += reactions.forces()[p];
  }
  const auto moved = [&](auto& other) {
    ImplicitEuler euler(other, testing::solver(tight), converged);
    for (int step = 0; step < 5; ++step) EXPECT_TRUE(euler.step(other, 0.01).accepted());
    double most = 0;
    for (Index v = 0; v < body.vertex_count(); ++v)
      most = std::max(most, (other.displacements()[at(v)] - body.displacements()[at(v)]).norm());
    return most;
  };
  const double falls = moved(fallen);
  EXPECT_GT(falls, 1e-3) << "the case must tell";
  EXPECT_LE(moved(released), 1e-6 * falls);
}

/// In swinging motion, one pin led: how far the momentum that the body has won in each step is from what forces,
/// damping and pins have given, over the size of the reactions.
template <class Body>
double worst_imbalance(Body body, const StepOptions& newton, double h, double until, bool torques) {
  ImplicitEuler euler(body, testing::solver(tight), newton);
  PinReactions reactions(body);
  double worst = 0, largest = 0;
  for (int step = 1; step * h <= until; ++step) {
    const Field<double> u = body.displacements(), v = body.velocities();
    const Index led = body.pins().vertices().back();
    body.move_pin(led, body.position(led) + h * Vec3<double>(0.1, 0.2, std::sin(20 * step * h)));
    EXPECT_TRUE(euler.step(body, h).accepted());
    reactions.evaluate_step(body, u, v, h);
    const auto product = [&](Index i, const Field<double>& x) {
      return body.mass().row_product(*body.pattern(), i, x);
    };
    Vec3<double> force = reactions.total_force(), torque = reactions.total_torque(body, {0, 0, 0});
    for (Index i = 0; i < body.vertex_count(); ++i) {
      const Vec3<double> f = body.external_forces()[at(i)] + body.mass().row_sum(i) * body.gravity() -
                             (product(i, body.velocities()) - product(i, v)) / h -
                             body.damping().mass * product(i, body.velocities());
      force += f;
      torque += body.position(i).cross(f);
    }
    worst = std::max(worst, torques ? torque.norm() : force.norm());
    for (const Vec3<double>& r : reactions.forces()) largest = std::max(largest, r.norm());
  }
  return worst / largest;
}

TYPED_TEST(PinReactionsOf, MomentaBalanceInMotion) {
  for (const BodyOptions& options : all_options) {
    const auto body = this->hanging(options);
    EXPECT_LE(worst_imbalance(body, converged, 0.01, 0.2, false), 1e-6);
    // Stiffness damping has a torque of its own: it resists the strain of the shape before the step.
    if (options.damping.stiffness > 0) continue;
    EXPECT_LE(worst_imbalance(body, converged, 0.01, 0.2, true), 1e-6);
  }
}

// One linear solve a step leaves an error in the balance that shrinks as the step: its tangent is not the exact one.
TYPED_TEST(PinReactionsOf, OneSolveBalancesToItsLinearisation) {
  const auto body = this->hanging(all_options[2]);
  const double coarse = worst_imbalance(body, {}, 0.004, 0.2, false),
               fine = worst_imbalance(body, {}, 0.001, 0.2, false);
  EXPECT_LE(coarse, 0.01);
  EXPECT_LE(fine, coarse / 3);
}

TYPED_TEST(PinReactionsOf, AStepGivenAsAnAccelerationIsTheSame) {
  for (const BodyOptions& options : all_options) {
    auto body = this->hanging(options);
    const double h = 0.01;
    ImplicitEuler euler(body, testing::solver(tight), converged);
    for (int step = 0; step < 3; ++step) euler.step(body, h);
    const Field<double> u = body.displacements(), v = body.velocities();
    euler.step(body, h);
    Field<double> a;
    for (std::size_t i = 0; i < v.size(); ++i) a.push_back((body.velocities()[i] - v[i]) / h);
    EXPECT_GT(flat(a).norm(), 1) << "the case must tell";
    PinReactions step(body), dynamic(body);
    step.evaluate_step(body, u, v, h);
    dynamic.evaluate_dynamic(body, u, a);
    for (std::size_t p = 0; p < step.forces().size(); ++p) EXPECT_EQ(step.forces()[p], dynamic.forces()[p]);
    // At rest in its state, without velocity and acceleration: the static reactions.
    must(body.set_velocities(Field<double>(v.size(), Vec3<double>::Zero())));
    PinReactions at_rest(body);
    at_rest.evaluate_static(body);
    dynamic.evaluate_dynamic(body, u, Field<double>(v.size(), Vec3<double>::Zero()));
    for (std::size_t p = 0; p < step.forces().size(); ++p)
      EXPECT_LE((at_rest.forces()[p] - dynamic.forces()[p]).norm(), 1e-12);
  }
}

TYPED_TEST(PinReactionsOf, ThereAreReactionsWhereThereArePins) {
  auto body = this->hanging(all_options[2]);
  must(body.set_displacements(testing::random_field<double>(body.vertex_count(), 0.01, 3)));
  PinReactions reactions(body);
  reactions.evaluate_static(body);
  EXPECT_FALSE(reactions.forces().empty());
  for (std::size_t p = 0; p < reactions.forces().size(); ++p)
    for (int i = 0; i < 3; ++i) EXPECT_EQ(reactions.forces()[p][i] != 0, body.pins().axes()[p][i]);
  while (!body.pins().vertices().empty()) body.pins().release(body.pins().vertices().front());
  reactions.evaluate_static(body);
  EXPECT_TRUE(reactions.forces().empty());
  EXPECT_TRUE(reactions.total_force().isZero());
}

// element_measures of a body is that of its law where it is.
TYPED_TEST(PinReactionsOf, EnergiesOfElementsSumToThatOfTheBody) {
  auto body = this->hanging(all_options[1]);
  ImplicitEuler euler(body, testing::solver(tight));
  for (int step = 0; step < 10; ++step) euler.step(body, 0.02);
  std::vector<ElementMeasures<double>> measures(at(body.mesh().element_count()));
  element_measures(body, std::span(measures));
  double sum = 0;
  for (const auto& m : measures) sum += m.volume * m.energy_density;
  EXPECT_GT(sum, 0.1);
  EXPECT_NEAR(sum, body.law().energy(body.displacements()), 1e-12 * sum);
}

}  // namespace
}  // namespace corotet::pin_reactions_test
