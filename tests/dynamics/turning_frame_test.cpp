// How a free body spins: it turns and does not grow, and no energy comes from nowhere.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/bodies.hpp"
#include "support/floating_point_traps.hpp"
#include "support/pairs.hpp"
#include "support/solver_choice.hpp"

namespace corotet::turning_frame_test {
namespace {

using testing::must;

template <class K>
class Spin : public ::testing::Test {
 public:
  using Body = SoftBody<typename K::Scalar, typename K::Element>;
  static constexpr double h = 1.0 / 60;

  /// Of 0.4 x 0.3 x 0.2 m about the origin, 1000 kg/m^3, that starts to turn by `turn` rad a step.
  static Body block(const Vec3<double>& turn, double young, MassModel mass = MassModel::lumped) {
    Body body = must(Body::create(testing::block<typename K::Scalar, typename K::Element>(
                                      {.corner = {-0.2, -0.15, -0.1}, .size = {0.4, 0.3, 0.2}, .cells = {3, 2, 2}}),
                                  Material{.young = young, .poisson = 0.3, .density = 1000},
                                  {.mass = mass, .damping = {}, .volumetric_strain = VolumetricStrain::pointwise}));
    must(body.set_velocities(testing::spin_of(body.mesh(), turn / h)));
    return body;
  }
};
TYPED_TEST_SUITE(Spin, testing::AllCases);

constexpr StepOptions one_solve{}, converged{.iterations = 12, .tangent = Tangent::consistent};

/// A stiff block is turned exactly, by any angle a step: straight lines would make it sqrt(1 + (h w)^2) as large.
TYPED_TEST(Spin, AStiffBodyTurnsAsARigidOne) {
  using Scalar = typename TypeParam::Scalar;
  const auto expect_turned = [this](MassModel mass, double turn, const StepOptions& newton) {
    // The norm in which float has solved then knows little of rigid motion.
    if (turn > 1 && sizeof(Scalar) == 4) return;
    auto body = this->block({0, 0, turn}, 5e7 * turn * turn / 0.01, mass);
    ImplicitEuler euler(body, testing::solver({.tolerance = sizeof(Scalar) == 4 ? 1e-5 : 1e-8}), newton);
    const int steps = 10;
    for (int step = 0; step < steps; ++step) ASSERT_TRUE(euler.step(body, Scalar(this->h)).accepted());
    const Mat3<double> q = rotation_by(steps * turn * Vec3<double>::UnitZ());
    for (Index v = 0; v < body.vertex_count(); ++v)
      EXPECT_LT((body.position(v).template cast<double>() - q * body.mesh().position(v).template cast<double>()).norm(),
                1e-3)  // straight lines: 0.03 at h omega = 0.5
          << "h omega = " << turn << ", vertex " << v;
  };
  testing::for_pairs(testing::seed_of<Scalar, typename TypeParam::Element>, expect_turned,
                     std::array{MassModel::lumped, MassModel::consistent}, std::array{0.1, 0.5, 2.0},
                     std::array{one_solve, converged});
}

/// A soft block is stretched by its spin, at any step by no more than its strain rho w^2 r^2 / E says, and its energy
/// never rises.
TYPED_TEST(Spin, NoEnergyComesFromNowhere) {
  using Scalar = typename TypeParam::Scalar;
  using Element = typename TypeParam::Element;
  const auto expect_no_gain = [this](double turn, const StepOptions& newton, bool is_double, int order) {
    if (is_double != (sizeof(Scalar) == 8) || order != Element::order) return;  // of another type
    auto body = this->block({0.3 * turn, 0, turn}, 5e5 * turn * turn / 0.01);
    ImplicitEuler euler(body, testing::solver({.tolerance = 1e-4}), newton);
    testing::EnergyWatch watch(testing::energy(body));
    const double start = watch.least();
    double max_strain = 0;
    const int steps = static_cast<int>(std::ceil(3 * 2 * std::numbers::pi / turn));
    for (int step = 0; step < steps; ++step) {
      const StepReport report = euler.step(body, Scalar(this->h));
      ASSERT_TRUE(report.accepted());
      max_strain = std::max(max_strain, report.max_strain);
      watch.see(testing::energy(body));
    }
    EXPECT_LT(watch.rise(), 1e-3 * start) << "h omega = " << turn;
    EXPECT_GT(watch.least(), 0.95 * start) << "h omega = " << turn;
    EXPECT_GT(max_strain, 1e-3) << "h omega = " << turn;
    EXPECT_LT(max_strain, 0.03) << "h omega = " << turn;  // straight lines: 0.17 at h omega = 0.5
  };
  testing::for_pairs(1, expect_no_gain, std::array{0.02, 0.1, 0.5}, std::array{one_solve, converged},
                     std::array{false, true}, std::array{1, 2});
}

/// The same motion, seen from a frame that flies.
TYPED_TEST(Spin, IsTheSameInFlight) {
  using Scalar = typename TypeParam::Scalar;
  const Vec3<double> flight(3, -2, 1);
  auto still = this->block({0.1, 0.2, 0.3}, 5e5), flying = still;
  Field<Scalar> v = still.velocities();
  for (auto& each : v) each += flight.template cast<Scalar>();
  must(flying.set_velocities(v));
  ImplicitEuler a(still, testing::solver({.tolerance = 1e-6})), b(flying, testing::solver({.tolerance = 1e-6}));
  const int steps = 60;
  for (int step = 0; step < steps; ++step) {
    ASSERT_TRUE(a.step(still, Scalar(this->h)).accepted());
    ASSERT_TRUE(b.step(flying, Scalar(this->h)).accepted());
  }
  const double tolerance = sizeof(Scalar) == 4 ? 2e-4 : 1e-6;
  for (Index i = 0; i < still.vertex_count(); ++i)
    EXPECT_LT(((flying.displacements()[at(i)] - still.displacements()[at(i)]).template cast<double>() -
               steps * this->h * flight)
                  .norm(),
              tolerance);
}

/// A force that keeps its direction in space: a vertex of a body that has next to no stiffness follows it, whatever the
/// body's spin, but for what the projection of angular momentum spreads over the body.
TYPED_TEST(Spin, ForcesKeepTheirDirection) {
  using Scalar = typename TypeParam::Scalar;
  for (const double turn : {0.1, 0.5}) {
    auto pulled = this->block({0, 0, turn}, 1e-3), left = pulled;
    const Index vertex = pulled.mesh().nearest_vertex({Scalar(0.05), 0, 0});
    const Vec3<double> force(1, 0, 0);
    pulled.external_forces()[at(vertex)] = force.template cast<Scalar>();
    ImplicitEuler a(pulled, testing::solver({.tolerance = 1e-6})), b(left, testing::solver({.tolerance = 1e-6}));
    ASSERT_TRUE(a.step(pulled, Scalar(this->h)).accepted());
    ASSERT_TRUE(b.step(left, Scalar(this->h)).accepted());
    const Vec3<double> change =
        (pulled.velocities()[at(vertex)] - left.velocities()[at(vertex)]).template cast<double>();
    EXPECT_GT(change.normalized().x(), 0.985) << "h omega = " << turn;  // turned with the body: cos(2 h omega)
    EXPECT_NEAR(change.norm(), this->h / double(pulled.mass().row_sum(vertex)), 0.1 * change.norm());
  }
}

/// Nothing of the frame stays behind in an integrator once the body is held.
TYPED_TEST(Spin, IsForgottenOnceABodyIsPinned) {
  using Scalar = typename TypeParam::Scalar;
  auto body = this->block({0.1, 0, 0.3}, 5e5);
  body.external_forces()[at(body.vertex_count() - 1)] = {Scalar(20), 0, 0};
  ImplicitEuler used(body, testing::solver({.method = SolverMethod::cholesky}));
  ASSERT_TRUE(used.step(body, Scalar(this->h)).accepted());
  body.pins().pin(0, body.displacements()[0]);
  auto copy = body;
  ImplicitEuler fresh(copy, testing::solver({.method = SolverMethod::cholesky}));
  ASSERT_TRUE(used.step(body, Scalar(this->h)).accepted());
  ASSERT_TRUE(fresh.step(copy, Scalar(this->h)).accepted());
  EXPECT_EQ((flat(body.displacements()) - flat(copy.displacements())).norm(), 0);
  EXPECT_GT(testing::max_displacement(body), 0.01) << "the case must tell";
}

}  // namespace
}  // namespace corotet::turning_frame_test
