// The shape in which a body rests.
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/static_solve.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/bodies.hpp"

namespace corotet::static_solve_test {
namespace {

using testing::must;

template <class K>
class Static : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Element = typename K::Element;
  static constexpr bool is_double = sizeof(Real) == 8;
  static constexpr double tolerance = is_double ? 1e-7 : 1e-4;

  static SoftBody<Real, Element> beam(double gravity = 9.81, const BodyOptions& options = {}, double poisson = 0.3) {
    return testing::cantilever<Real, Element>({.size = {1, 0.2, 0.2}, .cells = {6, 2, 2}},
                                              Material{.young = 3e5, .poisson = poisson, .density = 1000}, gravity,
                                              options);
  }
};
TYPED_TEST_SUITE(Static, testing::AllCases);

/// Where it rests it stays: a long step of backward Euler moves it by no more than the tolerance means.
TYPED_TEST(Static, IsWhereABodyStays) {
  using Scalar = typename TypeParam::Scalar;
  for (const BodyOptions& options :
       {BodyOptions{}, BodyOptions{.mass = MassModel::consistent, .damping = {.mass = 1, .stiffness = 0.1}},
        BodyOptions{.volumetric_strain = VolumetricStrain::averaged}}) {
    auto body = this->beam(9.81, options, options.volumetric_strain == VolumetricStrain::averaged ? 0.49 : 0.3);
    const StaticReport report = solve_static(body, {.tolerance = this->tolerance});
    ASSERT_TRUE(report.converged) << report.advice() << ", residual " << report.residual;
    EXPECT_LT(report.residual, this->is_double ? 1e-7 : 2e-2);  // float: rounding of stiff elements
    for (const auto& v : body.velocities()) ASSERT_TRUE(v.isZero());
    EXPECT_GT(testing::max_displacement(body), 0.05) << "the case must tell";
    const auto rest = body.displacements();
    ImplicitEuler euler(body, SolverOptions{.tolerance = 1e-8}, {.iterations = 20, .tolerance = 1e-6});
    ASSERT_TRUE(euler.step(body, Scalar(10)).accepted());
    for (std::size_t v = 0; v < rest.size(); ++v)
      EXPECT_LT((body.displacements()[v] - rest[v]).norm(), Scalar(this->is_double ? 1e-6 : 1e-3));
  }
}

/// From anywhere near, the same shape.
TYPED_TEST(Static, DoesNotDependOnTheStart) {
  using Scalar = typename TypeParam::Scalar;
  auto from_rest = this->beam(), from_elsewhere = from_rest;
  auto start = testing::random_field<Scalar>(from_rest.vertex_count(), 0.03, 7);
  for (const Index p : from_rest.pins().vertices()) start[at(p)].setZero();
  must(from_elsewhere.set_displacements(start));
  must(from_elsewhere.set_velocities(testing::random_field<Scalar>(from_rest.vertex_count(), 5, 8)));
  ASSERT_TRUE(solve_static(from_rest, {.tolerance = this->tolerance}).converged);
  ASSERT_TRUE(solve_static(from_elsewhere, {.tolerance = this->tolerance}).converged);
  for (Index v = 0; v < from_rest.vertex_count(); ++v)
    EXPECT_LT((from_rest.position(v) - from_elsewhere.position(v)).norm(), Scalar(this->is_double ? 1e-5 : 2e-3));
}

/// Without load: the rest shape, also from one that is turned inside out in part, and for a body that nothing holds.
TYPED_TEST(Static, WithoutLoadIsTheRestShape) {
  using Scalar = typename TypeParam::Scalar;
  auto held = this->beam(0), free = must(SoftBody<Scalar, typename TypeParam::Element>::create(
                                 held.mesh(), Material{.young = 3e5, .poisson = 0.3, .density = 1000}));
  for (auto* body : {&held, &free}) {
    auto start = testing::random_field<Scalar>(body->vertex_count(), 0.06, 3);
    for (const Index p : body->pins().vertices()) start[at(p)].setZero();
    must(body->set_displacements(start));
    const double before = body->law().energy(body->displacements());
    const StaticReport report = solve_static(*body, {.tolerance = this->tolerance, .max_steps = 400});
    EXPECT_TRUE(report.converged) << report.advice() << ", residual " << report.residual;
    EXPECT_LT(body->law().energy(body->displacements()), 1e-6 * before);
  }
}

/// A bar that hangs is longer by rho g L^2 / 2 E (nu = 0, small strain).
TYPED_TEST(Static, ABarThatHangsIsLongerByItsWeight) {
  using Scalar = typename TypeParam::Scalar;
  auto body = must(SoftBody<Scalar, typename TypeParam::Element>::create(
      testing::block<Scalar, typename TypeParam::Element>({.size = {1, 0.2, 0.2}, .cells = {10, 1, 1}}),
      Material{.young = 1e7, .poisson = 0, .density = 1000}));
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() == 0; });
  body.set_gravity({Scalar(9.81), 0, 0});
  ASSERT_TRUE(solve_static(body, {.tolerance = this->tolerance}).converged);
  const double exact = 1000 * 9.81 / (2 * 1e7);
  const Index end = body.mesh().nearest_vertex({1, Scalar(0.1), Scalar(0.1)});
  EXPECT_NEAR(double(body.displacements()[at(end)].x()), exact, 0.01 * exact);
}

/// What cannot rest, or may not be solved, says so.
TYPED_TEST(Static, SaysWhyItDidNotConverge) {
  using Scalar = typename TypeParam::Scalar;
  auto falls = this->beam();
  for (Index v = 0; v < falls.vertex_count(); ++v) falls.pins().release(v);
  const StaticReport falling = solve_static(falls, {.max_steps = 5});
  EXPECT_FALSE(falling.converged);
  EXPECT_STRNE(falling.advice(), "");
  auto wrong = this->beam();
  wrong.set_gravity({0, 0, std::numeric_limits<Scalar>::infinity()});
  const auto before = wrong.displacements();
  const StaticReport refused = solve_static(wrong);
  EXPECT_FALSE(refused.converged);
  EXPECT_EQ(refused.last.error, StepError::gravity);
  EXPECT_EQ(wrong.displacements(), before);
}

}  // namespace
}  // namespace corotet::static_solve_test
