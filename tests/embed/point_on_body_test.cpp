#include <gtest/gtest.h>

#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/embed/point_locator.hpp>
#include <corotet/detail/embed/point_on_body.hpp>
#include <limits>
#include <vector>

#include "support/bodies.hpp"

namespace corotet {
namespace {

using testing::must;
using testing::Random;

template <class T>
class PointOnBody : public ::testing::Test {
 protected:
  using S = typename T::Scalar;
  using E = typename T::Element;
  using Body = SoftBody<S, E>;
  static constexpr double epsilon = std::numeric_limits<S>::epsilon();

  /// In the middle of some motion.
  static Body moving(MassModel mass) {
    Body body = must(Body::create(testing::distorted_block<S, E>({.size = {1, 0.4, 0.3}, .cells = {4, 2, 2}}, 0.2, 7),
                                  Material{.young = 1e5, .density = 800}, {.mass = mass, .damping = {}}));
    must(body.set_displacements(testing::random_field<S>(body.vertex_count(), 0.03, 3)));
    must(body.set_velocities(testing::random_field<S>(body.vertex_count(), 2, 4)));
    return body;
  }
  static Vec3<double> wide(const Vec3<S>& x) { return x.template cast<double>(); }

  static Vec3<double> momentum(const Body& body) {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < body.vertex_count(); ++v)
      sum += body.mass().row_product(*body.pattern(), v, [&](Index j) { return wide(body.velocities()[at(j)]); });
    return sum;
  }
  static Vec3<double> angular_momentum(const Body& body) {  // about the origin
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < body.vertex_count(); ++v)
      sum += wide(body.position(v)).cross(body.mass().row_product(*body.pattern(), v, [&](Index j) {
        return wide(body.velocities()[at(j)]);
      }));
    return sum;
  }

  /// Inside, and outside where weights are those of the extension.
  static std::vector<LocatedPoint<E>> points(const Body& body) {
    const PointLocator locator(body.mesh());
    std::vector<LocatedPoint<E>> out;
    Random random(12);
    for (int i = 0; i < 20; ++i) out.push_back(locator.locate(Vec3<double>(0.5, 0.2, 0.15) + random.vector(0.3)));
    return out;
  }
};
TYPED_TEST_SUITE(PointOnBody, testing::AllCases);

#define USE_BODY                                              \
  using Fixture [[maybe_unused]] = TestFixture;               \
  using Scalar [[maybe_unused]] = typename TypeParam::Scalar; \
  using Element [[maybe_unused]] = typename TypeParam::Element

TYPED_TEST(PointOnBody, PositionAndVelocityAreThoseOfAnEmbeddedVertex) {
  USE_BODY;
  const auto body = this->moving(MassModel::lumped);
  const std::vector<Vec3<double>> rest{{0.3, 0.1, 0.2}, {0.9, 0.35, 0.02}, {1.1, 0.5, -0.1}};
  auto surface = must(EmbeddedSurface<Scalar, Element>::bind(body.mesh(), rest));
  Field<Scalar> x(rest.size());
  surface.positions(body.displacements(), x);
  const PointLocator locator(body.mesh());
  for (Index v = 0; v < size_of(rest); ++v) {
    const LocatedPoint<Element> located = locator.locate(rest[at(v)]);
    for (const BodyPoint<Element>& point : {BodyPoint<Element>(located), surface.body_point(v)}) {
      EXPECT_LE(double((position_at(body, point) - x[at(v)]).norm()), 200 * Fixture::epsilon);
      EXPECT_LE(double((position_at(body, point) - displacement_at(body, point)).norm() - rest[at(v)].norm()),
                200 * Fixture::epsilon);
    }
    // Velocity is the rate of position: along v for a short time.
    auto later = body;
    Field<Scalar> u = body.displacements();
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += Scalar(0.5) * body.velocities()[i];
    must(later.set_displacements(u));
    const Vec3<Scalar> moved = position_at(later, located) - position_at(body, located);
    EXPECT_LE(double((moved - Scalar(0.5) * velocity_at(body, located)).norm()), 400 * Fixture::epsilon);
  }
}

TYPED_TEST(PointOnBody, ForcesHaveTheSameSumTorqueAndPower) {
  USE_BODY;
  Random random(5);
  auto body = this->moving(MassModel::lumped);
  for (const auto& point : this->points(body)) {
    for (Vec3<Scalar>& f : body.external_forces()) f.setZero();
    const Vec3<Scalar> force = random.vector(10).cast<Scalar>();
    add_force_at(body, point, force);
    Vec3<double> sum = Vec3<double>::Zero(), torque = sum;
    double power = 0, size = 0;
    for (Index v = 0; v < body.vertex_count(); ++v) {
      const Vec3<double> f = this->wide(body.external_forces()[at(v)]);
      sum += f;
      torque += this->wide(body.position(v)).cross(f);
      power += f.dot(this->wide(body.velocities()[at(v)]));
      size += f.norm() * 4;
    }
    EXPECT_LE((sum - this->wide(force)).norm(), 8 * Fixture::epsilon * size);
    EXPECT_LE((torque - this->wide(position_at(body, point)).cross(this->wide(force))).norm(),
              8 * Fixture::epsilon * size);
    EXPECT_NEAR(power, this->wide(velocity_at(body, point)).dot(this->wide(force)), 8 * Fixture::epsilon * size);
    // Forces add up.
    add_force_at(body, point, force);
    Vec3<double> twice = Vec3<double>::Zero();
    for (const Vec3<Scalar>& f : body.external_forces()) twice += this->wide(f);
    EXPECT_LE((twice - 2 * sum).norm(), 16 * Fixture::epsilon * size);
  }
}

TYPED_TEST(PointOnBody, AnImpulseIsWhatMomentaGrowBy) {
  USE_BODY;
  Random random(6);
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
    auto body = this->moving(mass);
    Field<Scalar> scratch;
    for (const auto& point : this->points(body)) {
      const Vec3<Scalar> impulse = random.vector(10).cast<Scalar>();
      const Vec3<double> p = this->momentum(body), l = this->angular_momentum(body),
                         r = this->wide(position_at(body, point));
      const Vec3<double> j = this->wide(impulse), v = this->wide(velocity_at(body, point));
      ASSERT_TRUE(apply_impulse_at(body, point, impulse, scratch).ok());
      double size = 10;
      for (Index i = 0; i < body.vertex_count(); ++i)
        size += std::fabs(double(body.mass().row_sum(i))) * this->wide(body.velocities()[at(i)]).norm();
      EXPECT_LE((this->momentum(body) - p - j).norm(), 8 * Fixture::epsilon * size);
      EXPECT_LE((this->angular_momentum(body) - l - r.cross(j)).norm(), 8 * Fixture::epsilon * size);
      EXPECT_GT((this->wide(velocity_at(body, point)) - v).dot(j), 0);
    }
  }
}

// The kinetic energy grows by the impulse times the point's mean velocity, as M dv = N J says.
TYPED_TEST(PointOnBody, AnImpulseDoesTheWorkOfItsMeanVelocity) {
  USE_BODY;
  Random random(6);
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
    auto body = this->moving(mass);
    for (const auto& point : this->points(body)) {
      const Vec3<Scalar> impulse = random.vector(10).cast<Scalar>();
      const double before = testing::kinetic_energy(body);
      const Vec3<double> v = this->wide(velocity_at(body, point));
      ASSERT_TRUE(apply_impulse_at(body, point, impulse).ok());
      const double after = testing::kinetic_energy(body);
      const double work = this->wide(impulse).dot(v + this->wide(velocity_at(body, point))) / 2;
      EXPECT_NEAR(after - before, work, 50 * Fixture::epsilon * (before + after));
    }
  }
}

// An impulse is a large force for a short time.
TYPED_TEST(PointOnBody, AnImpulseIsAForceForAShortTime) {
  USE_BODY;
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
    auto start = must(
        SoftBody<Scalar, Element>::create(testing::block<Scalar, Element>({.size = {1, 0.4, 0.3}, .cells = {3, 1, 1}}),
                                          Material{.young = 1e3}, {.mass = mass, .damping = {}}));
    const auto point = PointLocator(start.mesh()).locate({0.7, 0.3, 0.1});
    auto pushed = start, struck = start;
    constexpr auto h = Scalar(1e-5);
    add_force_at(pushed, point, Vec3<Scalar>(0, 0, 5) / h);
    ImplicitEuler euler(pushed, SolverOptions{.method = SolverMethod::cholesky});
    ASSERT_TRUE(euler.step(pushed, h).accepted());
    ASSERT_TRUE(apply_impulse_at(struck, point, {0, 0, 5}).ok());
    double most = 0, difference = 0;
    for (Index v = 0; v < start.vertex_count(); ++v) {
      most = std::max(most, double(struck.velocities()[at(v)].norm()));
      difference = std::max(difference, double((struck.velocities()[at(v)] - pushed.velocities()[at(v)]).norm()));
    }
    EXPECT_LE(difference, 1e-3 * most);
  }
}

TYPED_TEST(PointOnBody, PinsTakeUpTheirShare) {
  USE_BODY;
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
    auto body = this->moving(mass);
    body.pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(0.3); });
    body.pin_where([](const Vec3<Scalar>& x) { return x.x() > Scalar(0.3) && x.x() < Scalar(0.7); },
                   {.x = false, .y = true, .z = false});
    const Field<Scalar> before = body.velocities();
    const auto point = PointLocator(body.mesh()).locate({0.35, 0.2, 0.1});
    ASSERT_TRUE(apply_impulse_at(body, point, {1, 2, 3}).ok());
    int moved = 0, held = 0;
    for (Index v = 0; v < body.vertex_count(); ++v)
      for (int i = 0; i < 3; ++i) {
        const bool same = detail::exactly_equal(body.velocities()[at(v)][i], before[at(v)][i]);
        EXPECT_TRUE(same || !body.pins().axes_of(v)[i]);
        if (body.pins().is_pinned(v)) ++(same ? held : moved);
      }
    EXPECT_GT(moved, 0);
    EXPECT_GT(held, 0);
  }
}

TYPED_TEST(PointOnBody, ABadImpulseIsRefusedAndChangesNothing) {
  USE_BODY;
  auto body = this->moving(MassModel::lumped);
  must(body.set_materials(Material{.young = 1e5, .density = 1e-3}));  // so light that velocities overflow
  const Field<Scalar> before = body.velocities();
  const auto point = PointLocator(body.mesh()).locate({0.5, 0.2, 0.1});
  for (const Scalar bad : {std::numeric_limits<Scalar>::quiet_NaN(), std::numeric_limits<Scalar>::infinity(),
                           std::numeric_limits<Scalar>::max()}) {
    const auto status = apply_impulse_at(body, point, {0, bad, 0});
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, ErrorCode::non_finite_value);
    EXPECT_EQ(body.velocities(), before);
  }
}

}  // namespace
}  // namespace corotet
