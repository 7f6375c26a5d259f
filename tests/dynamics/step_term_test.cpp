// The door for all that acts on a body: a spring to a point, written here, is implicit, stable at any stiffness, and
// counted in momenta and energy; what the body has itself can be written as a term, too.
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/bodies.hpp"
#include "support/pairs.hpp"
#include "support/solver_choice.hpp"

namespace corotet::step_term_test {
namespace {

using testing::must;

/// A spring without rest length from a vertex to a point.
template <class Scalar>
class PointSpring final : public StepTerm<Scalar> {
 public:
  PointSpring(Index vertex, const Vec3<Scalar>& point, double stiffness)
      : vertex_(vertex), point_(point), stiffness_(static_cast<Scalar>(stiffness)) {}

  void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
    if (state.contains(vertex_)) out.add(vertex_, stiffness_ * (point_ - state.position(vertex_)));
  }
  void add_stiffness(const TermState<Scalar>& state, TermStiffness<Scalar>& out) override {
    if (state.contains(vertex_)) out.add_stiffness(vertex_, vertex_, stiffness_ * Mat3<Scalar>::Identity());
  }
  [[nodiscard]] bool has_energy() const override { return true; }
  [[nodiscard]] double energy(const TermState<Scalar>& state) override {
    return state.contains(vertex_) ? energy_at(state.position(vertex_)) : 0;
  }
  [[nodiscard]] double energy_at(const Vec3<Scalar>& x) const {
    return double(stiffness_) / 2 * (x - point_).template cast<double>().squaredNorm();
  }

 private:
  Index vertex_;
  Vec3<Scalar> point_;
  Scalar stiffness_;
};

template <class K>
class Term : public ::testing::Test {
 public:
  using Real = typename K::Scalar;
  using Body = SoftBody<Real, typename K::Element>;
  static constexpr Real h = Real(1) / 60;
  static constexpr bool is_double = sizeof(Real) == 8;
  static constexpr BlockOptions bar{.corner = {-0.4, -0.1, -0.1}, .size = {0.8, 0.2, 0.2}, .cells = {4, 1, 1}};

  static Body free_body(double young = 5e5, const BodyOptions& options = {}) {
    return must(Body::create(testing::block<Real, typename K::Element>(bar),
                             Material{.young = young, .poisson = 0.3, .density = 1000}, options));
  }
  static Index corner(const Body& body) { return body.mesh().nearest_vertex({Real(0.4), Real(0.1), Real(0.1)}); }

  static Vec3<double> centre(const Body& body) {
    Vec3<double> sum = Vec3<double>::Zero();
    for (Index v = 0; v < body.vertex_count(); ++v)
      sum += double(body.mass().row_sum(v)) * body.position(v).template cast<double>();
    return sum / body.mass().total();
  }
  static StepContext<Real> with(const Terms<Real>& terms) { return {{}, {}, terms, {}}; }
};
TYPED_TEST_SUITE(Term, testing::AllCases);

constexpr StepOptions one_solve{}, converged{.iterations = 12, .tolerance = 1e-6, .tangent = Tangent::consistent};

/// A body that hangs by a corner from a point a tenth of its length away: stable at 1e9 N/m in steps of 1/60 s, and at
/// rest in the end with the corner at the point.
TYPED_TEST(Term, IsStableAtAnyStiffness) {
  using Scalar = typename TypeParam::Scalar;
  const auto expect_rest_at_the_point = [this](double stiffness, const StepOptions& newton, bool second_order) {
    auto body = this->free_body(5e5, {.damping = {.mass = 2, .stiffness = 0.02}});
    body.set_gravity({0, 0, Scalar(-9.81)});
    const Index corner = this->corner(body);
    const Vec3<Scalar> point = body.position(corner) + Vec3<Scalar>(Scalar(0.05), 0, Scalar(0.06));
    PointSpring<Scalar> spring(corner, point, stiffness);
    const auto context = this->with(spring);
    ImplicitEuler euler(body, testing::solver({.tolerance = 1e-4}), newton);
    Bdf2 bdf2(body, testing::solver({.tolerance = 1e-4}), newton);
    double fastest = 0;
    for (int step = 0; step < 300; ++step) {
      const StepReport report = second_order ? bdf2.step(body, this->h, context) : euler.step(body, this->h, context);
      ASSERT_TRUE(report.accepted()) << stiffness << " N/m, step " << step;
      fastest = std::max(fastest, testing::max_speed(body));
    }
    EXPECT_LT(fastest, 20) << stiffness << " N/m";  // the jump of the corner in one step: 5 m/s
    const double hangs = body.mass().total() * 9.81 / stiffness;
    const Vec3<double> off = (body.position(corner) - point).template cast<double>();
    EXPECT_NEAR(-off.z(), hangs, 0.05 * hangs + 1e-4) << stiffness << " N/m";
    EXPECT_LT(std::hypot(off.x(), off.y()), 0.05 * hangs + 1e-4) << stiffness << " N/m";
    if (!second_order) {
      EXPECT_LT(testing::max_speed(body), 0.2) << stiffness << " N/m";
    }
  };
  testing::for_pairs(testing::seed_of<Scalar, typename TypeParam::Element>, expect_rest_at_the_point,
                     std::array{1e2, 1e5, 1e9}, std::array{one_solve, converged}, std::array{false, true});
}

/// What the spring gives is what the body gets: in a step of backward Euler its momentum changes by h times the force
/// at the end, and its angular momentum by the moment of that. Spinning, soft, with one solve that is not exact.
TYPED_TEST(Term, MomentaChangeByItsImpulse) {
  using Scalar = typename TypeParam::Scalar;
  for (const MassModel mass : {MassModel::lumped, MassModel::consistent})
    for (const StepOptions& newton : {one_solve, converged}) {
      auto body = this->free_body(5e4, {.mass = mass});
      must(body.set_velocities(testing::spin_of(body.mesh(), {0.5, -1, 4})));
      const Index corner = this->corner(body);
      const double stiffness = 2e3;
      const Vec3<Scalar> point = body.position(corner) + Vec3<Scalar>(Scalar(0.1), Scalar(0.05), 0);
      PointSpring<Scalar> spring(corner, point, stiffness);
      ImplicitEuler euler(body, testing::solver({.tolerance = 1e-4}), newton);
      const double scale = body.mass().total(), tolerance = this->is_double ? 1e-9 : 1e-4;
      for (int step = 0; step < 40; ++step) {
        const Vec3<double> p = testing::linear_momentum(body), l = testing::angular_momentum(body);
        ASSERT_TRUE(euler.step(body, this->h, this->with(spring)).accepted());
        const Vec3<double> impulse =
            double(this->h) * stiffness * (point - body.position(corner)).template cast<double>();
        const Vec3<double> moment = (body.position(corner).template cast<double>() - this->centre(body)).cross(impulse);
        EXPECT_LT((testing::linear_momentum(body) - p - impulse).norm(), tolerance * scale) << "step " << step;
        EXPECT_LT((testing::angular_momentum(body) - l - moment).norm(), tolerance * scale) << "step " << step;
      }
    }
}

/// Of body and spring together; also where the spring is stretched at once, and the body spins about the point.
TYPED_TEST(Term, EnergyNeverRises) {
  using Scalar = typename TypeParam::Scalar;
  for (const double stiffness : {1e3, 1e5, 1e7})
    for (const double spin : {0.0, 3.0}) {
      auto body = this->free_body(2e5);
      must(body.set_velocities(testing::spin_of(body.mesh(), {0, spin, spin / 3})));
      const Index corner = this->corner(body);
      PointSpring<Scalar> spring(corner, body.position(corner) + Vec3<Scalar>(0, 0, Scalar(0.02)), stiffness);
      ImplicitEuler euler(body, testing::solver({.tolerance = 1e-5}));
      const auto total = [&] { return testing::energy(body) + spring.energy_at(body.position(corner)); };
      const double start = total();
      testing::EnergyWatch watch(start);
      for (int step = 0; step < 200; ++step) {
        ASSERT_TRUE(euler.step(body, this->h, this->with(spring)).accepted());
        watch.see(total());
      }
      EXPECT_LT(watch.least(), 0.99 * start) << "the case must tell";
      EXPECT_LT(watch.rise(), 2e-3 * start) << stiffness << " N/m, " << spin << " rad/s";
    }
}

/// A term that acts on nothing changes no bit.
TYPED_TEST(Term, OfNothingChangesNothing) {
  class Nothing final : public StepTerm<typename TypeParam::Scalar> {
   public:
    void add_force(const TermState<typename TypeParam::Scalar>&, TermForces<typename TypeParam::Scalar>&) override {}
  } nothing;
  auto alone = this->free_body();
  must(alone.set_velocities(testing::spin_of(alone.mesh(), {1, 2, 3})));
  auto watched = alone;
  ImplicitEuler a(alone, testing::solver()), b(watched, testing::solver());
  for (int step = 0; step < 20; ++step) {
    ASSERT_TRUE(a.step(alone, this->h).accepted());
    ASSERT_TRUE(b.step(watched, this->h, this->with(nothing)).accepted());
  }
  EXPECT_EQ(alone.displacements(), watched.displacements());
  EXPECT_EQ(alone.velocities(), watched.velocities());
  EXPECT_GT(testing::max_displacement(alone), 0.01) << "the case must tell";
}

/// Dashpots of a m_v from every vertex to space are mass damping a.
TYPED_TEST(Term, DashpotsOfTheMassAreMassDamping) {
  using Scalar = typename TypeParam::Scalar;
  class Dashpots final : public StepTerm<Scalar> {
   public:
    explicit Dashpots(Scalar rate) : rate_(rate) {}
    void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
      for (Index v = 0; v < static_cast<Index>(state.rest.size()); ++v)
        out.add(v, -rate_ * state.mass->row_sum(v) * state.velocity(v));
    }
    void add_stiffness(const TermState<Scalar>& state, TermStiffness<Scalar>& out) override {
      for (Index v = 0; v < static_cast<Index>(state.rest.size()); ++v)
        out.add_damping(v, v, rate_ * state.mass->row_sum(v) * Mat3<Scalar>::Identity());
    }

   private:
    Scalar rate_;
  } dashpots(5);
  // Where one end is held nothing turns or is projected, and a step is the same equation.
  const auto hang = [&](auto& body) {
    body.pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(-0.39); });
    body.set_gravity({0, 0, Scalar(-9.81)});
  };
  for (const StepOptions& newton : {one_solve, StepOptions{.iterations = 12, .tolerance = 1e-8}}) {
    auto damped = this->free_body(5e5, {.damping = {.mass = 5, .stiffness = 0}}), dashed = this->free_body();
    hang(damped);
    hang(dashed);
    ImplicitEuler a(damped, testing::solver({.tolerance = 1e-6}), newton),
        b(dashed, testing::solver({.tolerance = 1e-6}), newton);
    for (int step = 0; step < 30; ++step) {
      ASSERT_TRUE(a.step(damped, this->h).accepted());
      ASSERT_TRUE(b.step(dashed, this->h, this->with(dashpots)).accepted());
    }
    for (Index v = 0; v < damped.vertex_count(); ++v)
      EXPECT_LT((damped.position(v) - dashed.position(v)).norm(), Scalar(this->is_double ? 1e-6 : 1e-5));
    EXPECT_GT(testing::max_displacement(damped), 0.01) << "the case must tell";
  }
}

/// Proportional damping from a term is that of the body.
TYPED_TEST(Term, ProportionalDampingIsRayleighs) {
  using Scalar = typename TypeParam::Scalar;
  RayleighDampingTerm<Scalar> damping;
  damping.damping = {.mass = 0.3, .stiffness = 0.01};
  auto own = this->free_body(5e5, {.damping = damping.damping}), given = this->free_body();
  for (auto* body : {&own, &given}) body->pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(-0.39); });
  own.set_gravity({0, Scalar(3), Scalar(-9.81)});
  given.set_gravity({0, Scalar(3), Scalar(-9.81)});
  for (const StepOptions& newton : {one_solve, converged}) {
    Bdf2 a(own, testing::solver(), newton), b(given, testing::solver(), newton);
    for (int step = 0; step < 10; ++step) {
      ASSERT_TRUE(a.step(own, this->h).accepted());
      ASSERT_TRUE(b.step(given, this->h, this->with(damping)).accepted());
    }
    EXPECT_EQ(own.displacements(), given.displacements());
    EXPECT_GT(testing::max_displacement(own), 0.01) << "the case must tell";
  }
}

/// A spring between the two ends of a bar, which no element couples: internal, so that all momenta stay.
TYPED_TEST(Term, CouplesVerticesFarApart) {
  using Scalar = typename TypeParam::Scalar;
  class Tie final : public StepTerm<Scalar> {
   public:
    Tie(Index a, Index b, double stiffness) : a_(a), b_(b), k_(static_cast<Scalar>(stiffness)) {}
    void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
      const Vec3<Scalar> pull = k_ * (state.position(b_) - state.position(a_));
      out.add(a_, pull);
      out.add(b_, -pull);
    }
    void add_stiffness(const TermState<Scalar>& /*state*/, TermStiffness<Scalar>& out) override {
      out.add_relative_stiffness(a_, b_, k_ * Mat3<Scalar>::Identity());
    }

   private:
    Index a_, b_;
    Scalar k_;
  };
  const auto mesh = testing::block<Scalar, typename TypeParam::Element>(this->bar);
  const Index left = mesh.nearest_vertex({Scalar(-0.4), 0, 0}), right = mesh.nearest_vertex({Scalar(0.4), 0, 0});
  const Stencils couplings{.start = {0, 2}, .vertex = {left, right}};
  for (const double stiffness : {1e4, 1e8}) {
    auto body = this->free_body(5e5, {.couplings = couplings});
    must(body.set_velocities(testing::spin_of(body.mesh(), {0, 0, 2})));
    const Vec3<double> l = testing::angular_momentum(body);
    Tie tie(left, right, stiffness);
    ImplicitEuler euler(body, testing::solver({.tolerance = 1e-5}));
    double apart = 0;
    for (int step = 0; step < 60; ++step) {
      ASSERT_TRUE(euler.step(body, this->h, this->with(tie)).accepted());
      apart = double((body.position(left) - body.position(right)).norm());
    }
    EXPECT_LT(apart, 0.75) << "the tie pulls the bar's ends together";
    EXPECT_LT(testing::linear_momentum(body).norm(), (this->is_double ? 1e-9 : 1e-4) * body.mass().total());
    EXPECT_LT((testing::angular_momentum(body) - l).norm(), 1e-3 * l.norm());
  }
}

/// A step goes as far as its terms allow.
TYPED_TEST(Term, BoundsTheStep) {
  using Scalar = typename TypeParam::Scalar;
  class HalfWay final : public StepTerm<Scalar> {
   public:
    void add_force(const TermState<Scalar>&, TermForces<Scalar>&) override {}
    double max_safe_fraction(const TermState<Scalar>&, const TermState<Scalar>&) override { return 0.5; }
  } half_way;
  auto body = this->free_body();
  body.pin_where([](const Vec3<Scalar>& x) { return x.x() < Scalar(-0.39); });
  body.set_gravity({0, 0, Scalar(-9.81)});
  auto half = body;
  ImplicitEuler a(body, testing::solver({.tolerance = 1e-6})), b(half, testing::solver({.tolerance = 1e-6}));
  ASSERT_TRUE(a.step(body, this->h).accepted());
  ASSERT_TRUE(b.step(half, this->h, this->with(half_way)).accepted());
  for (Index v = 0; v < body.vertex_count(); ++v)
    EXPECT_LT((body.displacements()[at(v)] / 2 - half.displacements()[at(v)]).norm(), Scalar(1e-7));
  EXPECT_GT(testing::max_displacement(half), 1e-3) << "the case must tell";
}

/// Calls come in the order that StepTerm promises, the last with the state in which the step ended.
TYPED_TEST(Term, IsToldOfTheStep) {
  using Scalar = typename TypeParam::Scalar;
  class Diary final : public StepTerm<Scalar> {
   public:
    std::string calls;
    Vec3<Scalar> first, last;
    void begin_step(const TermState<Scalar>& s) override { calls += 'b', first = s.position(7); }
    void add_force(const TermState<Scalar>&, TermForces<Scalar>&) override { calls += 'f'; }
    void add_stiffness(const TermState<Scalar>&, TermStiffness<Scalar>&) override { calls += 'k'; }
    void end_step(const TermState<Scalar>& s) override { calls += 'e', last = s.position(7); }
  } diary;
  auto body = this->free_body();
  must(body.set_velocities(testing::spin_of(body.mesh(), {0, 5, 0})));
  ImplicitEuler euler(body);
  const Vec3<Scalar> before = body.position(7);
  ASSERT_TRUE(euler.step(body, this->h, this->with(diary)).accepted());
  EXPECT_EQ(diary.calls.front(), 'b');
  EXPECT_EQ(diary.calls.back(), 'e');
  EXPECT_EQ(diary.calls.substr(1, 2), "fk");
  EXPECT_EQ(diary.calls.find('e'), diary.calls.size() - 1);
  EXPECT_EQ(diary.first, before);
  EXPECT_EQ(diary.last, body.position(7));
}

}  // namespace
}  // namespace corotet::step_term_test
