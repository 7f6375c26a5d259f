// Bodies that start flat, on a line, in a point or mirrored come back to their rest shape.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "support/bodies.hpp"
#include "support/pairs.hpp"
#include "support/random.hpp"

namespace corotet::recovery_test {
namespace {

using testing::must;

/// Where the free vertices of a beam along x, held at x = 0, start.
struct Start {
  const char* name;
  Vec3<double> factor;  // of each coordinate
};
const std::array<Start, 6> starts{
    Start{"flat, across", {1, 1, 0}}, Start{"flat, along", {0, 1, 1}},     Start{"line", {1, 0, 0}},
    Start{"point", {0, 0, 0}},        Start{"mirrored along", {-1, 1, 1}}, Start{"mirrored across", {1, 1, -1}}};

template <class T>
class Recovery : public ::testing::Test {};
TYPED_TEST_SUITE(Recovery, testing::AllCases);

/// `damping`: 1/s M, with steps of 1/60 s and of 1/10 s. `slow`: the same bodies are not home yet after 100 steps of
/// 1/10 s. `off`: what each coordinate is off at most, m.
template <class Scalar, class Element, template <class> class Integrator>
void expect_recovery(const std::array<double, 2>& damping, bool slow, double off = 0) {
  using Body = SoftBody<Scalar, Element>;
  const std::array<Index, 3> cells =
      Element::order == 1 ? std::array<Index, 3>{8, 2, 2} : std::array<Index, 3>{4, 1, 1};
  const auto expect_return = [&](double poisson, double h, const Start& start) {
    // From a point a nearly incompressible body of 10-node elements may come to another minimum of the energy, in
    // which no quadrature point is inverted: docs/benchmarks/hard_cases.md.
    const bool hard = Element::order == 2 && poisson > 0.49;
    const bool may_be_stuck = hard && (start.factor.norm() == 0 || (slow && h > 0.05));
    Body body = testing::cantilever<Scalar, Element>({.corner = {0, -0.1, -0.1}, .size = {1, 0.2, 0.2}, .cells = cells},
                                                     Material{.young = 5e5, .poisson = poisson, .density = 1000}, 0,
                                                     {.damping = {.mass = damping[h < 0.1 ? 0 : 1], .stiffness = 0}});
    testing::Random random(1);
    must(body.set_displacements(testing::displacement_of(body.mesh(), [&](const Vec3<double>& x) {
      const Vec3<double> noise{random.uniform(-off, off), random.uniform(-off, off), random.uniform(-off, off)};
      return x.x() == 0 ? x : (x.cwiseProduct(start.factor) + noise);
    })));
    Integrator<Body> integrator(body);
    StepReport report;
    for (int step = 0; step < (h < 0.1 ? 300 : 100); ++step) {
      report = integrator.step(body, Scalar(h));
      ASSERT_TRUE(report.accepted()) << report.advice();
      EXPECT_LT(report.residual, 1e-2) << start.name << ", step " << step;  // float stagnates near rest
    }
    if (may_be_stuck) return;
    const double rms = std::sqrt(double(flat(body.displacements()).squaredNorm()) / body.vertex_count());
    EXPECT_EQ(report.inverted_elements, 0) << start.name << ", nu = " << poisson << ", h = " << h;
    EXPECT_LT(rms, 1e-3) << start.name << ", nu = " << poisson << ", h = " << h;
  };
  testing::for_pairs(testing::seed_of<Scalar, Element>, expect_return, std::array{0.3, 0.499},
                     std::array{1.0 / 60, 0.1}, starts);
}

template <class Body>
using Euler = ImplicitEuler<Body>;
template <class Body>
using SecondOrder = Bdf2<Body>;

/// With the default options, without damping at h = 1/10 s and with a little at 1/60 s, the body is back in its rest
/// shape, to 1e-3 of the size, after ten seconds; five are enough at 1/60 s. No solve breaks down on the way.
TYPED_TEST(Recovery, DegenerateStartsReturnToRest) {
  expect_recovery<typename TypeParam::Scalar, typename TypeParam::Element, Euler>({2, 0}, false);
}

/// Nobody's body starts exactly in a point, but off by a millionth of its size, and yet all its elements must turn the
/// same way: else half of these do not come home at nu = 0.3, and four fifths at 0.499.
TYPED_TEST(Recovery, NearlyDegenerateStartsReturnToRest) {
  expect_recovery<typename TypeParam::Scalar, typename TypeParam::Element, Euler>({2, 2}, false, 1e-6);
}

/// The second order formula, too; as it keeps slow motion, with more damping.
TYPED_TEST(Recovery, DegenerateStartsReturnToRestWithTheSecondOrder) {
  expect_recovery<typename TypeParam::Scalar, typename TypeParam::Element, SecondOrder>({5, 5}, true);
}

}  // namespace
}  // namespace corotet::recovery_test
