// The law of one contact: what its impulse may be, and of which convex function its pieces are the tangents.
#include <corotet/detail/contact/point_contact.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.hpp"

namespace corotet::point_contact_test {
namespace {

using detail::PointContact;
using V = Vec3<double>;

constexpr double gamma = 1.0 / 60;

/// Linearised somewhere, with springs of any ratio, a force from the step before, and friction or none.
PointContact some_contact(testing::Random& random) {
  PointContact c;
  c.normal = random.vector().normalized();
  c.start = random.vector();
  c.reference = c.start + random.vector(0.01);
  c.led = random.vector(0.01);
  c.gap = random.uniform(-0.01, 0.02);
  c.friction = random.uniform() < 0.2 ? 0 : random.uniform(0, 2);
  c.multiplier = random.uniform() < 0.3 ? 0 : random.uniform(0, 500);
  c.anchor = c.tangential_part(random.vector(200));
  c.linearize(c.start + random.vector(0.02), gamma, random.uniform(1, 20), random.uniform(1, 20));
  return c;
}
V some_change(testing::Random& random) { return random.vector() * std::pow(10, random.uniform(-2, 1)); }

/// Goes to the phase that holds at w and takes its piece.
void take_piece_at(PointContact& c, const V& w) {
  for (int i = 0; i < 3; ++i) {
    c.evaluate(w);
    static_cast<void>(c.judge(0, 0, false));
    c.choose_piece(false);
  }
}
V piece_at(const PointContact& c, const V& w) { return c.piece_impulse - c.piece_stiffness * w; }

TEST(PointContact, NeverPullsAndKeepsFrictionInTheCone) {
  testing::Random random(1);
  int open = 0, sticks = 0, slides = 0;
  for (int i = 0; i < 20000; ++i) {
    PointContact c = some_contact(random);
    c.evaluate(some_change(random));
    const double normal = c.normal.dot(c.impulse), friction = c.tangential_part(c.impulse).norm();
    EXPECT_GE(normal, 0);
    EXPECT_LE(friction, c.friction * normal + 1e-13 * c.impulse.norm());
    if (normal <= 0)
      ++open;
    else if (friction < 0.999 * c.friction * normal)
      ++sticks;
    else if (c.friction > 0)
      ++slides;
  }
  EXPECT_GT(std::min({open, sticks, slides}), 1000);
}

/// Without a force of the step before, friction takes energy: it acts against the motion along the surface.
TEST(PointContact, FrictionActsAgainstTheMotion) {
  testing::Random random(2);
  for (int i = 0; i < 2000; ++i) {
    PointContact c = some_contact(random);
    c.anchor.setZero();
    const V end = c.start + random.vector(0.02);
    c.linearize(end, gamma, c.kappa, c.kappa_t);
    c.evaluate(V::Zero());
    const V moved = c.tangential_part(end - c.start - c.led), friction = c.tangential_part(c.impulse);
    EXPECT_NEAR(friction.dot(moved), -friction.norm() * moved.norm(), 1e-12);
  }
}

/// What counts is where the point ends: whether by the place of linearisation or by the change from there.
TEST(PointContact, DependsOnTheEndAlone) {
  testing::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    PointContact c = some_contact(random), d = c;
    const V end = c.start + random.vector(0.02), w = some_change(random);
    c.linearize(end, gamma, c.kappa, c.kappa_t);
    d.linearize(end + gamma * w, gamma, c.kappa, c.kappa_t);
    c.evaluate(w);
    d.evaluate(V::Zero());
    EXPECT_LT((c.impulse - d.impulse).norm(), 1e-10 * (1 + c.impulse.norm()));
  }
}

TEST(PointContact, APieceIsTheLawInItsOwnRegion) {
  testing::Random random(4);
  int seen[3] = {}, elsewhere = 0;
  for (int i = 0; i < 10000; ++i) {
    PointContact c = some_contact(random);
    const V w = some_change(random);
    take_piece_at(c, w);
    ++seen[static_cast<int>(c.phase)];
    // Beyond its limit by a thousandth, friction still counts as sticking: the law cuts that off.
    const auto tolerance = [&](const PointContact& at) {
      const double most = at.friction * std::max(0.0, at.normal_trial);
      return 1e-10 * (1 + at.impulse.norm()) + (at.tangential_trial.norm() > most ? 1e-3 * most : 0);
    };
    EXPECT_LT((piece_at(c, w) - c.impulse).norm(), tolerance(c)) << "where it was taken";
    if (c.phase == ContactPhase::sliding) continue;
    PointContact there = c;
    there.evaluate(some_change(random));
    static_cast<void>(there.judge(0, 0, false));
    if (there.phase != c.phase) continue;
    EXPECT_LT((piece_at(c, there.change) - there.impulse).norm(), tolerance(there)) << "elsewhere in its region";
    ++elsewhere;
  }
  EXPECT_GT(elsewhere, 1000);
  EXPECT_GT(std::min({seen[0], seen[1], seen[2]}), 500);
}

/// The convex function of the line search, with friction's limit held: p_n^2 / 2 kappa and Huber's of q / kappa_t.
double potential(const PointContact& c, const V& w) {
  const double p = std::max(0.0, c.normal0 - c.kappa * c.normal.dot(w));
  const double q = (c.tangential0 - c.kappa_t * c.tangential_part(w)).norm(), most = c.limit;
  return p * p / (2 * c.kappa) + (q <= most ? q * q / 2 : most * (q - most / 2)) / c.kappa_t;
}

TEST(PointContact, WorkIsTheSlopeOfAConvexFunction) {
  testing::Random random(5);
  for (int i = 0; i < 5000; ++i) {
    PointContact c = some_contact(random);
    take_piece_at(c, some_change(random));
    const V a = some_change(random), b = some_change(random), along = b - a;
    EXPECT_LE(c.work(b, along), c.work(a, along) + 1e-12 * (1 + std::fabs(c.work(a, along)))) << "it is monotone";
    const double step = 1e-5 / along.norm();
    const double slope = (potential(c, a + step * along) - potential(c, a - step * along)) / (2 * step);
    const double scale = along.norm() * (std::fabs(c.normal0) + c.tangential0.norm() + 20 * a.norm());
    EXPECT_NEAR(-c.work(a, along), slope, 1e-4 * scale);
  }
}

/// The stiffness of a piece is minus the derivative of the law there, friction's limit held; it is symmetric and
/// never negative.
TEST(PointContact, StiffnessIsTheTangent) {
  testing::Random random(6);
  for (int i = 0; i < 5000; ++i) {
    PointContact c = some_contact(random);
    const V w = some_change(random);
    take_piece_at(c, w);
    const Mat3<double>& k = c.piece_stiffness;
    EXPECT_LT((k - k.transpose()).norm(), 1e-14 * (1 + k.norm()));
    const V x = random.vector(), y = random.vector();
    EXPECT_GE(x.dot(k * x), -1e-12 * k.norm() * x.squaredNorm());
    if (!(c.friction > 0)) continue;  // then `limit` is none: friction of the law without one is zero, too
    // Away from the borders of the piece.
    const double q = c.tangential_trial.norm(), most = c.limit;
    if (std::fabs(c.normal_trial) < 0.01 || std::fabs(q - most) < 0.01 * most + 0.01) continue;
    const double step = 1e-5;
    const double slope = (c.work(w + step * x, y) - c.work(w - step * x, y)) / (2 * step);
    EXPECT_NEAR(-slope, y.dot(k * x), 1e-5 * (1 + c.kappa + c.kappa_t) * x.norm() * y.norm());
  }
}

/// The depth that is told is that of the spring, deeper than the point was.
TEST(PointContact, DepthIsThatOfThePoint) {
  testing::Random random(7);
  for (int i = 0; i < 2000; ++i) {
    PointContact c = some_contact(random);
    const V end = c.start + random.vector(0.02), w = some_change(random);
    c.linearize(end, gamma, c.kappa, c.kappa_t);
    c.evaluate(w);
    const double gap = c.gap + c.normal.dot(end + gamma * w - c.reference - c.led);
    const double expected = c.normal_trial > 0 ? -gap - std::max(0.0, -c.gap) : 0;
    EXPECT_NEAR(c.depth(gamma), expected, 1e-12);
  }
}

/// Once the multiplier has taken over all of the force, the same force is there without any depth.
TEST(PointContact, AMultiplierTakesTheSpringsPlace) {
  testing::Random random(8);
  for (int i = 0; i < 2000; ++i) {
    PointContact c = some_contact(random);
    c.evaluate(some_change(random));
    if (c.normal_trial <= 0) continue;
    const double force = c.normal_trial / gamma;
    c.augment(gamma);
    EXPECT_NEAR(c.multiplier, force, 1e-10 * (1 + force));
    // The change of velocity that ends on the surface.
    const V on = c.normal * ((c.normal0 - gamma * c.multiplier) / c.kappa);
    c.evaluate(on);
    EXPECT_NEAR(c.normal_trial, gamma * force, 1e-10 * (1 + force));
    EXPECT_NEAR(c.depth(gamma) + std::max(0.0, -c.gap), 0, 1e-12);
  }
}

TEST(PointContact, ChangesItsPhaseForMoreThanNoiseAlone) {
  testing::Random random(9);
  for (int i = 0; i < 5000; ++i) {
    PointContact c = some_contact(random);
    c.friction = random.uniform(0.1, 2);
    const V w = some_change(random);
    take_piece_at(c, w);
    const ContactPhase phase = c.phase;
    EXPECT_FALSE(c.judge(0, 0, false)) << "at the same solution";
    const V nearby = w + random.vector(1e-6);  // impulses change by less than the noise
    c.evaluate(nearby);
    EXPECT_FALSE(c.judge(1e-3, 1e-3, false));
    EXPECT_EQ(c.phase, phase);
  }
}

}  // namespace
}  // namespace corotet::point_contact_test
