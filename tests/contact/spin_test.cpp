// Free bodies that are held hard by terms: the spin that a step lacks is shared with these, and spins nothing up.
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/bodies.hpp"

namespace corotet::contact_spin_test {
namespace {

using testing::must;
using V = Vec3<double>;

/// Springs of one stiffness from vertices to points.
template <class Scalar>
class Springs final : public StepTerm<Scalar> {
 public:
  explicit Springs(double stiffness) : stiffness_(static_cast<Scalar>(stiffness)) {}
  void hold(Index vertex, const V& point) {
    vertices_.push_back(vertex);
    points_.push_back(point.cast<Scalar>());
  }

  void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      out.add(vertices_[i], stiffness_ * (points_[i] - state.position(vertices_[i])));
  }
  void add_stiffness(const TermState<Scalar>& /*state*/, TermStiffness<Scalar>& out) override {
    for (const Index v : vertices_) out.add_stiffness(v, v, stiffness_ * Mat3<Scalar>::Identity());
  }

 private:
  std::vector<Index> vertices_;
  Field<Scalar> points_;
  Scalar stiffness_;
};

template <class K>
class ContactSpin : public ::testing::Test {};
using Cases = ::testing::Types<testing::Case<float, Tet4>, testing::Case<double, Tet10>>;
TYPED_TEST_SUITE(ContactSpin, Cases);

/// A block whose two ends are drawn apart, or pressed together, by a fifth of its length, and twisted a little: by
/// springs so stiff that they are pins. Turning straight lines and one linearisation leave a moment that grows with the
/// force; given to the body alone, it would spin it the more, the harder it is drawn.
TYPED_TEST(ContactSpin, ABodyHeldByStiffSpringsComesToRest) {
  using Scalar = typename TypeParam::Scalar;
  using Body = SoftBody<Scalar, typename TypeParam::Element>;
  for (const double stretch : {1.2, 0.8})
    for (const double young : {5e5, 5e7}) {
      Body body = must(Body::create(testing::block<Scalar, typename TypeParam::Element>(
                                        {.corner = {-0.4, -0.1, -0.1}, .size = {0.8, 0.2, 0.2}, .cells = {4, 2, 2}}),
                                    Material{.young = young, .poisson = 0.3, .density = 1000}));
      body.set_gravity({0, 0, Scalar(-9.81)});
      Springs<Scalar> springs(1e9);
      const Mat3<double> twist = rotation_by({0.05, 0.02, 0});
      for (Index v = 0; v < body.vertex_count(); ++v) {
        const V x = body.position(v).template cast<double>();
        if (std::fabs(x.x()) < 0.399) continue;
        const V drawn(stretch * x.x(), x.y(), x.z());
        springs.hold(v, x.x() > 0 ? V(twist * drawn) : drawn);
      }
      ImplicitEuler euler(body, SolverOptions{.tolerance = 1e-3});
      StepContext<Scalar> context;
      context.terms = springs;
      double late = 0;
      for (int step = 0; step < 150; ++step) {
        ASSERT_TRUE(euler.step(body, Scalar(1.0 / 60), context).accepted()) << stretch << ' ' << young << ' ' << step;
        if (step >= 120)
          for (const auto& v : body.velocities()) late = std::max(late, double(v.norm()));
      }
      EXPECT_LT(late, 1e-3) << stretch << ' ' << young;
    }
}

}  // namespace
}  // namespace corotet::contact_spin_test
