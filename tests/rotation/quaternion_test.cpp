// Rotations as quaternions and vectors against Eigen's.
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/random.hpp"

namespace corotet {
namespace {

using testing::Random;

template <class S>
class Quaternions : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Quaternions, Scalars);

/// (w, x, y, z), of length 1.
std::vector<Matrix<double, 4, 1>> quaternions() {
  std::vector<Matrix<double, 4, 1>> all;
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
    all.emplace_back(w, x, y, z);
    all.emplace_back(1e-9 * w, x, y, z);  // nearly half a turn
    all.emplace_back(w, 1e-9 * x, y, 1e-5 * z);
    all.emplace_back(1, 1e-4 * x, 1e-8 * y, 1e-12 * z);  // hardly any turn
    all.emplace_back(0, x, y, z);
  }
  for (const double w : {-1, 0, 1})
    for (const double x : {-1, 0, 1})
      for (const double y : {-1, 0, 1})
        for (const double z : {-1, 0, 1})
          if (w != 0 || x != 0 || y != 0 || z != 0) all.emplace_back(w, x, y, z);  // half turns about axes, ties
  for (auto& q : all) q.normalize();
  return all;
}

TYPED_TEST(Quaternions, RotateAsEigensDo) {
  using S = TypeParam;
  const auto epsilon = static_cast<double>(std::numeric_limits<S>::epsilon());
  for (const auto& exact : quaternions()) {
    const Matrix<S, 4, 1> q = exact.cast<S>();
    const Mat3<S> r = rotation_of(q);
    const Mat3<S> eigens = Eigen::Quaternion<S>(q[0], q[1], q[2], q[3]).toRotationMatrix();
    EXPECT_LT((r - eigens).norm(), 4 * epsilon) << as_eigen(q).transpose();
    EXPECT_LT((r.transpose() * r - Mat3<S>::Identity()).norm(), 16 * epsilon);
    EXPECT_NEAR(r.determinant(), 1, 16 * epsilon);
    EXPECT_EQ(rotation_of<S>(-q), r);
  }
}

TYPED_TEST(Quaternions, OfARotationAreEigens) {
  using S = TypeParam;
  const auto epsilon = static_cast<double>(std::numeric_limits<S>::epsilon());
  for (const auto& exact : quaternions()) {
    const Mat3<S> r = rotation_of(exact).template cast<S>();
    const Matrix<S, 4, 1> q = quaternion_of(r);
    EXPECT_NEAR(q.norm(), 1, 2 * epsilon);
    EXPECT_GT(q.maxCoeff(), q.cwiseAbs().maxCoeff() - 4 * epsilon)
        << as_eigen(q).transpose();  // or equal, but for rounding
    EXPECT_LT((rotation_of(q) - r).norm(), 16 * epsilon) << as_eigen(q).transpose();
    const Eigen::Quaternion<S> e(Eigen::Matrix<S, 3, 3>(as_eigen(r)));
    const Matrix<S, 4, 1> eigens(e.w(), e.x(), e.y(), e.z());
    EXPECT_LT((std::min)((q - eigens).norm(), (q + eigens).norm()), 8 * epsilon) << as_eigen(q).transpose();
    const Matrix<double, 4, 1> as_double = q.template cast<double>();
    EXPECT_LT((std::min)((as_double - exact).norm(), (as_double + exact).norm()), 8 * epsilon)
        << as_eigen(q).transpose();
  }
}

TEST(RotationVectors, RotateAsEigensAngleAxisDoes) {
  Random random(2);
  const double epsilon = std::numeric_limits<double>::epsilon(), pi = std::numbers::pi;
  const auto compare = [&](const Vec3<double>& axis, double angle) {
    const Mat3<double> r = rotation_by(angle * axis);
    const Mat3<double> eigens = Eigen::AngleAxisd(angle, as_eigen(axis)).toRotationMatrix();
    EXPECT_LT((r - eigens).norm(), 8 * epsilon * (1 + std::abs(angle)))
        << angle << " about " << as_eigen(axis).transpose();
    EXPECT_LT((r * axis - axis).norm(), 8 * epsilon);
  };
  for (int i = 0; i < 2000; ++i) {
    const Vec3<double> axis = random.vector().normalized();
    for (const double angle : {random.uniform(-pi, pi), random.uniform(-20, 20), pi, -pi, pi / 2, 2 * pi, 1e-3, 1e-8,
                               1e-12, 1e-20, 1e-100, 0.0})
      compare(axis, angle);
  }
  for (const Vec3<double>& axis : {Vec3<double>::UnitX(), Vec3<double>::UnitY(), Vec3<double>::UnitZ()})
    for (const double angle : {pi, -pi, pi / 2, 2 * pi, 1e-8}) compare(axis, angle);
  EXPECT_EQ(rotation_by(Vec3<double>::Zero()), Mat3<double>::Identity());
}

/// Of a tiny turn it is the turn: 1 + [turn].
TEST(RotationVectors, KeepTinyTurns) {
  Random random(3);
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-100})
    for (int i = 0; i < 100; ++i) {
      const Vec3<double> turn = random.vector(size);
      const Mat3<double> r = rotation_by(turn);
      const Vec3<double> axial(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
      const double second_order = turn.squaredNorm() + 4 * std::numeric_limits<double>::epsilon();
      EXPECT_LT((axial / 2 - turn).norm(), second_order * turn.norm()) << as_eigen(turn).transpose();
    }
}

}  // namespace
}  // namespace corotet
