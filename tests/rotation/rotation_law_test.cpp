// The law of RotationExtractor: for every finite F the result is a rotation; for Polar it is the nearest one.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/per_element.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "support/floating_point_traps.hpp"
#include "support/matrices.hpp"
#include "support/random.hpp"

namespace corotet {
namespace {

using testing::Random;

/// U diag(s) V^T with random rotations: every kind of deformation, by its signed stretches.
template <class Scalar>
Mat3<Scalar> with_stretches(Random& random, const Vec3<double>& s) {
  return (random.rotation() * testing::diagonal(s) * random.rotation().transpose()).cast<Scalar>();
}

/// Entries -1, 0, 1: the signs of `m`, but 0 where `mask` is not positive.
Mat3<double> signs_and_zeros(Mat3<double> m, const Mat3<double>& mask) {
  for (int k = 0; k < 9; ++k) m[k] = std::copysign(1.0, m[k]) * (mask[k] > 0 ? 1 : 0);
  return m;
}

/// One of the kinds of F that a simulation may meet, chosen by `kind`.
template <class Scalar>
Mat3<Scalar> draw(Random& random, int kind) {
  const double tiny = std::pow(10.0, random.uniform(-12, -1));
  const double a = random.uniform(0.1, 3), b = random.uniform(0.1, 3);
  switch (kind % 12) {
    case 0:
      return (random.rotation() + random.matrix(0.1)).template cast<Scalar>();
    case 1:
      return random.matrix().template cast<Scalar>();  // half inverted
    case 2:
      return with_stretches<Scalar>(random, {a, b, tiny});  // nearly flat
    case 3:
      return with_stretches<Scalar>(random, {a, b, -tiny});  // just inverted
    case 4:
      return with_stretches<Scalar>(random, {a, tiny, tiny * random.uniform(-1, 1)});  // nearly a line
    case 5:
      return with_stretches<Scalar>(random, {a, b, -b * (1 + tiny)});  // gap closing
    case 6:
      return with_stretches<Scalar>(random, {1, 1, -1});  // mirror image
    case 7:
      return with_stretches<Scalar>(random, {a, a, 0});  // flat
    case 8:
      return with_stretches<Scalar>(random, {a, 0, 0});  // line
    case 9: {                                            // any magnitude that Scalar has
      const double range =
          std::log10(static_cast<double>(std::min<long double>(1e300L, std::numeric_limits<Scalar>::max())));
      return (random.matrix() * std::pow(10.0, random.uniform(-range, range - 1))).template cast<Scalar>();
    }
    case 10:
      return signs_and_zeros(random.matrix(), random.matrix()).template cast<Scalar>();
    default:
      return with_stretches<Scalar>(random, {1e3 * a, b, 1e-3 * random.uniform(-1, 1)});
  }
}

template <class Scalar>
double distance_from_rotation(const Mat3<Scalar>& r) {
  const Mat3<double> d = r.template cast<double>();
  return std::max((d.transpose() * d - Mat3<double>::Identity()).norm(), std::abs(d.determinant() - 1));
}

/// Calls visit(F, R) for `count` draws, in full batches.
template <class Model, class Scalar, class Visit>
void for_random_matrices(int count, unsigned seed, Visit&& visit) {
  Random random(seed);
  Mat3Lanes<Scalar> f, r;
  for (int drawn = 0; drawn < count;) {
    for (int l = 0; l < lane_count<Scalar>; ++l) {
      Mat3<Scalar> m = draw<Scalar>(random, drawn++);
      if (!m.allFinite()) m = Mat3<Scalar>::Identity();  // a magnitude that rounded to infinity
      f.set_lane(l, m);
    }
    Model::extract(f, r);
    for (int l = 0; l < lane_count<Scalar>; ++l) visit(f.lane(l), r.lane(l));
  }
}

template <class T>
class RotationLaw : public ::testing::Test {};
template <class S, class M>
struct Extraction {
  using Scalar = S;
  using Model = M;
};
using Extractions = ::testing::Types<Extraction<float, Polar>, Extraction<double, Polar>,
                                     Extraction<float, GramSchmidt>, Extraction<double, GramSchmidt>,
                                     Extraction<float, Identity>, Extraction<double, PerElement<Polar>>>;
TYPED_TEST_SUITE(RotationLaw, Extractions);

TYPED_TEST(RotationLaw, EveryFiniteMatrixGivesARotation) {
  using Scalar = typename TypeParam::Scalar;
  double worst = 0;
  Mat3<Scalar> culprit = Mat3<Scalar>::Zero();
  for_random_matrices<typename TypeParam::Model, Scalar>(
      1'200'000, 1, [&](const Mat3<Scalar>& f, const Mat3<Scalar>& r) {
        const double distance = r.allFinite() ? distance_from_rotation(r) : std::numeric_limits<double>::infinity();
        if (!(distance <= worst)) {
          worst = distance;
          culprit = f;
        }
      });
  EXPECT_LT(worst, 16 * static_cast<double>(std::numeric_limits<Scalar>::epsilon())) << "worst F:\n"
                                                                                     << as_eigen(culprit);
}

TYPED_TEST(RotationLaw, ExtremesAndNonFiniteMatricesStayFinite) {
  const testing::WithoutTraps not_a_number_is_meant;
  using Scalar = typename TypeParam::Scalar;
  using Limits = std::numeric_limits<Scalar>;
  for (const Scalar value : {Scalar(0), Limits::denorm_min(), -Limits::denorm_min(), Limits::min(), Limits::max(),
                             Limits::lowest(), Limits::epsilon()})
    for (int entry = -1; entry < 9; ++entry) {
      Mat3<Scalar> f = entry < 0 ? Mat3<Scalar>::Constant(value) : Mat3<Scalar>::Zero();
      if (entry >= 0) f(entry) = value;
      const Mat3<Scalar> r = extract_rotation<typename TypeParam::Model, Scalar>(f);
      EXPECT_LT(distance_from_rotation(r), 16 * static_cast<double>(Limits::epsilon())) << "F:\n"
                                                                                        << as_eigen(f) << "\nR:\n"
                                                                                        << as_eigen(r);
    }
  for (const Scalar value : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()})
    for (int entry = 0; entry < 9; ++entry) {
      Mat3<Scalar> f = Mat3<Scalar>::Identity();
      f(entry) = value;
      EXPECT_TRUE((extract_rotation<typename TypeParam::Model, Scalar>(f).allFinite())) << "F:\n" << as_eigen(f);
    }
}

TYPED_TEST(RotationLaw, OneBadLaneLeavesTheOthersAlone) {
  const testing::WithoutTraps not_a_number_is_meant;
  using Scalar = typename TypeParam::Scalar;
  Random random(7);
  const Mat3<Scalar> f = (random.rotation() + random.matrix(0.1)).template cast<Scalar>();
  const Mat3<Scalar> alone = extract_rotation<typename TypeParam::Model, Scalar>(f);
  Mat3Lanes<Scalar> lanes, r;
  for (int l = 0; l < lane_count<Scalar>; ++l) lanes.set_lane(l, f);
  lanes.set_lane(1, Mat3<Scalar>::Zero());
  lanes.set_lane(2, Mat3<Scalar>::Constant(std::numeric_limits<Scalar>::quiet_NaN()));
  TypeParam::Model::extract(lanes, r);
  EXPECT_LT((r.lane(0) - alone).norm(), 8 * std::numeric_limits<Scalar>::epsilon());
}

template <class T>
class PolarLaw : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PolarLaw, Scalars);

/// R maximises tr(R^T F): it reaches s1 + s2 +- s3 of the singular values, and R^T F is symmetric. Both are backward
/// errors, which do not depend on how well R is determined.
TYPED_TEST(PolarLaw, IsTheNearestRotation) {
  using Scalar = TypeParam;
  double worst_trace = 0, worst_asymmetry = 0;
  for_random_matrices<Polar, Scalar>(120'000, 2, [&](const Mat3<Scalar>& f, const Mat3<Scalar>& r) {
    const double largest = f.template cast<double>().cwiseAbs().maxCoeff();
    if (!(largest > 1e-300)) return;
    const Mat3<double> g = f.template cast<double>() / largest, s = r.template cast<double>().transpose() * g;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(as_eigen(g), Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3<double> sigma = svd.singularValues();
    // The sign of det F, from its rotations: det F itself may be all rounding.
    const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
    const double best = sigma[0] + sigma[1] + sign * sigma[2];
    worst_trace = std::max(worst_trace, std::abs(best - s.trace()) / g.norm());
    worst_asymmetry = std::max(worst_asymmetry, (s - s.transpose()).norm() / g.norm());
  });
  const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  EXPECT_LT(worst_trace, 32 * epsilon);
  EXPECT_LT(worst_asymmetry, 64 * epsilon);
}

TYPED_TEST(PolarLaw, BatchAgreesWithTheRobustForm) {
  using Scalar = TypeParam;
  Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    const Mat3<Scalar> f = (random.rotation() + random.matrix(0.2)).template cast<Scalar>();
    const Vec3<double> sigma = Eigen::JacobiSVD<Eigen::Matrix3d>(as_eigen(f).template cast<double>()).singularValues();
    if (f.determinant() < 0 || sigma[2] < 0.1) continue;  // the rotation itself is ill-determined there
    ASSERT_LT((extract_rotation<Polar, Scalar>(f) - detail::polar_robust<Scalar>(f)).norm(),
              100 * std::numeric_limits<Scalar>::epsilon());
  }
}

/// Our Jacobi rotations against Eigen's symmetric QR, matrices with equal eigenvalues included: the vector reaches the
/// largest eigenvalue, and the gap is that to the next.
TYPED_TEST(PolarLaw, StationaryRotationsAgreeWithEigen) {
  using Scalar = TypeParam;
  using Matrix = Eigen::Matrix<double, 4, 4>;
  Random random(6);
  for (int i = 0; i < 20'000; ++i) {
    Matrix k;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c <= r; ++c) k(r, c) = k(c, r) = i % 3 == 0 ? std::round(random.normal()) : random.normal();
    const detail::StationaryRotation<Scalar> nearest(k.template cast<Scalar>());
    const Eigen::Matrix<double, 4, 1> v = nearest.quaternion.template cast<double>();
    const Eigen::Matrix<double, 4, 1> values =
        Eigen::SelfAdjointEigenSolver<Matrix>(k, Eigen::EigenvaluesOnly).eigenvalues();
    const double tolerance = 32 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    ASSERT_NEAR(v.norm(), 1, tolerance);
    ASSERT_LT(values[3] - v.dot(k * v), tolerance * (1 + k.norm()));
    ASSERT_NEAR(nearest.gap, values[3] - values[2], tolerance * (1 + k.norm()));
  }
}

template <class Scalar>
Mat3<Scalar> rotation_of_gradient(const Mat3<Scalar>& f) {
  Mat3Lanes<Scalar> lanes, r;
  for (int l = 0; l < lane_count<Scalar>; ++l) lanes.set_lane(l, f);
  detail::extract_from_gradient<Polar>(lanes, r);
  return r.lane(lane_count<Scalar> - 1);
}

/// Where several rotations are equally near, and rounding would choose or what little F is off, a gradient's rotation
/// is the one that turns least; where one is clearly nearest, what is preferred changes no bit.
TYPED_TEST(PolarLaw, AmongEquallyNearRotationsAGradientsIsTheOneThatTurnsLeast) {
  using Scalar = TypeParam;
  Random random(8);
  const double rounding = 2 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  for (const double off : {rounding, 1e-5})
    for (const Vec3<double>& stretches : {Vec3<double>(0, 0, 0), Vec3<double>(1, 0, 0), Vec3<double>(0, 2, 0),
                                          Vec3<double>(-1, 1, 1), Vec3<double>(1, 1, -1), Vec3<double>(2, -1, 1)})
      for (int i = 0; i < 100; ++i) {
        const Mat3<double> f = testing::diagonal(stretches) + random.matrix(off);
        const Mat3<Scalar> r = rotation_of_gradient<Scalar>(f.cast<Scalar>());
        ASSERT_LT((r - Mat3<Scalar>::Identity()).norm(), 0.1) << "F:\n" << as_eigen(f) << "\nR:\n" << as_eigen(r);
      }
  for (int i = 0; i < 1000; ++i) {
    const Mat3<Scalar> f = (random.rotation() + random.matrix(0.1)).template cast<Scalar>();
    ASSERT_EQ(rotation_of_gradient<Scalar>(f), (extract_rotation<Polar, Scalar>(f))) << "F:\n" << as_eigen(f);
  }
}

/// F with s1 >= s2 >= |s3| between random rotations, where 2 (s2 + s3), by how much tr(R^T F) is larger than for the
/// next stationary rotation, is `gap`.
struct NearTie {
  Vec3<double> stretches;
  Mat3<double> f;

  NearTie(Random& random, double size, double gap) {
    const double inverted = size * std::pow(random.uniform(), 4);
    const double middle = gap / 2 + inverted;
    stretches = {std::max(size, middle), middle, -inverted};
    const Mat3<double> left = random.rotation(), right = random.rotation();
    f = left * testing::diagonal(stretches) * right;
  }
};

/// R^T F, whose asymmetry is a torque, and tr(R^T F), its shortfall an energy, stay what they are but for three
/// thousandths of F at rest, also in an element that is long and thin; nothing is left where the choice is clear.
TYPED_TEST(PolarLaw, APreferenceAmongNearlyEqualRotationsChangesLittle) {
  using Scalar = TypeParam;
  Random random(9);
  const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  const double clear = detail::clear_choice(1.0);
  double most = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double size = std::pow(10.0, random.uniform(-2, 2.5)), gap = clear * std::pow(10.0, random.uniform(-3, 2));
    const NearTie tie(random, size, gap);
    const Mat3<double> r = rotation_of_gradient<Scalar>(tie.f.cast<Scalar>()).template cast<double>();
    const Mat3<double> s = r.transpose() * tie.f;
    const double rounding = 64 * epsilon * tie.stretches[0];
    // In a long element what float rounds may be more than what makes a choice clear.
    const double allowed = gap > std::max(clear, 8 * rounding) ? 0 : std::sqrt(0.125) * std::max(clear, 8 * rounding);
    ASSERT_LT(tie.stretches.sum() - s.trace(), allowed + rounding)
        << "gap " << gap << ", s " << as_eigen(tie.stretches).transpose();
    ASSERT_LT((s - s.transpose()).norm(), allowed + rounding)
        << "gap " << gap << ", s " << as_eigen(tie.stretches).transpose();
    most = std::max(most, (s - s.transpose()).norm());
  }
  EXPECT_GT(most, 1e-4) << "the case must tell";
}

/// Neither where the preference begins nor where the closed form hands over does the rotation jump.
TYPED_TEST(PolarLaw, APreferenceAmongNearlyEqualRotationsFadesIn) {
  using Scalar = TypeParam;
  Random random(10);
  const double clear = detail::clear_choice(1.0), epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  for (int i = 0; i < 10'000; ++i) {
    const double size = std::pow(10.0, random.uniform(-2, 1));
    const NearTie at_clear(random, size, clear * random.uniform(0.98, 1.02));
    const Mat3<Scalar> edge = at_clear.f.cast<Scalar>();
    const double determined = at_clear.stretches[0] * epsilon / clear;
    ASSERT_LT((detail::polar_robust<Scalar>(edge, 1) - detail::polar_robust<Scalar>(edge)).norm(),
              1e-3 + 64 * determined)
        << as_eigen(at_clear.stretches).transpose();
    const Mat3<Scalar> q = detail::polar_robust<Scalar>(edge);  // stationary: the nearest to itself
    ASSERT_LT((detail::polar_near<Scalar>(edge, q, 1) - q).norm(), 1e-3 + 64 * determined)
        << as_eigen(at_clear.stretches).transpose();
    const NearTie tie(random, size, clear * std::pow(10.0, random.uniform(-1, 1)));
    const Mat3<Scalar> f = tie.f.cast<Scalar>();
    ASSERT_LT((rotation_of_gradient<Scalar>(f) - detail::polar_robust<Scalar>(f, 1)).norm(),
              64 * tie.stretches[0] * epsilon / clear)
        << as_eigen(tie.stretches).transpose();
  }
}

/// Where it is clear which rotations are stationary it is the nearest of them; for F = 0 all are.
TYPED_TEST(PolarLaw, AStationaryRotationNearAnotherIsStationary) {
  using Scalar = TypeParam;
  Random random(11);
  const double clear = detail::clear_choice(1.0), epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  for (int i = 0; i < 10'000; ++i) {
    const Mat3<Scalar> near = random.rotation().template cast<Scalar>();
    EXPECT_EQ(detail::polar_near<Scalar>(Mat3<Scalar>::Zero(), near, 1), near);
    const NearTie tie(random, 1, clear * std::pow(10.0, random.uniform(-3, 2)));
    const Mat3<double> r = detail::polar_near<Scalar>(tie.f.cast<Scalar>(), near, 1).template cast<double>();
    ASSERT_LT(distance_from_rotation(r.template cast<Scalar>()), 16 * epsilon);
    const Mat3<double> s = r.transpose() * tie.f;
    ASSERT_LT((s - s.transpose()).norm(), clear / 20 + 64 * epsilon) << as_eigen(tie.stretches).transpose();
    // None of the four is nearer: R and its half turns about the axes of stretch.
    const Vec3<double>& t = tie.stretches;
    if (2 * std::min({t[1] + t[2], t[0] - t[1], t[1] - t[2]}) < 1.01 * clear) continue;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(as_eigen(tie.f), Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double side = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
    double best = -1;
    for (const Vec3<double>& sign :
         {Vec3<double>(1, 1, 1), Vec3<double>(1, -1, -1), Vec3<double>(-1, 1, -1), Vec3<double>(-1, -1, 1)}) {
      const Mat3<double> stationary = svd.matrixU() *
                                      as_eigen(sign).cwiseProduct(Eigen::Vector3d(1, 1, side)).asDiagonal() *
                                      svd.matrixV().transpose();
      best = std::max(best, (stationary.transpose() * near.template cast<double>()).trace());
    }
    ASSERT_GT((r.transpose() * near.template cast<double>()).trace(), best - 1024 * epsilon)
        << as_eigen(tie.stretches).transpose();
  }
}

/// Frame indifference: rotating the deformed body rotates R; rotating the rest shape rotates it back.
TYPED_TEST(PolarLaw, FollowsRotationsOfSpaceAndOfTheRestShape) {
  using Scalar = TypeParam;
  Random random(4);
  for (int i = 0; i < 5'000; ++i) {
    const Mat3<double> f = random.rotation() * (Mat3<double>::Identity() + random.matrix(0.1)), q = random.rotation();
    const Mat3<double> r = extract_rotation<Polar, Scalar>(f.template cast<Scalar>()).template cast<double>();
    const Mat3<double> left = extract_rotation<Polar, Scalar>((q * f).template cast<Scalar>()).template cast<double>();
    const Mat3<double> right = extract_rotation<Polar, Scalar>((f * q).template cast<Scalar>()).template cast<double>();
    const double tolerance = 50 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    ASSERT_LT((left - q * r).norm(), tolerance);
    ASSERT_LT((right - r * q).norm(), tolerance);
  }
}

/// Gram-Schmidt fails the second half of that law: why it is not the default.
TEST(GramSchmidtDefect, DependsOnTheAxesOfTheRestShape) {
  Random random(5);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const Mat3<double> f = Mat3<double>::Identity() + random.matrix(0.1), q = random.rotation();
    worst = std::max(
        worst, (extract_rotation<GramSchmidt, double>(f * q) - extract_rotation<GramSchmidt, double>(f) * q).norm());
  }
  EXPECT_GT(worst, 0.1);
}

}  // namespace
}  // namespace corotet
