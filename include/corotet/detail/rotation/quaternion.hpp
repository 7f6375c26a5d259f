// Rotations as unit quaternions and as vectors along their axis.
#pragma once

#include <cmath>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1 {

/// The rotation of a unit quaternion q = (w, x, y, z).
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> rotation_of(const Matrix<Scalar, 4, 1>& q) {
  const Scalar w = q[0], x = 2 * q[1], y = 2 * q[2], z = 2 * q[3];
  const Scalar xx = x * q[1], yy = y * q[2], zz = z * q[3], xy = x * q[2], xz = x * q[3], yz = y * q[3];
  Mat3<Scalar> r;
  r.set_col(0, {1 - (yy + zz), xy + w * z, xz - w * y});
  r.set_col(1, {xy - w * z, 1 - (xx + zz), yz + w * x});
  r.set_col(2, {xz + w * y, yz - w * x, 1 - (xx + yy)});
  return r;
}

/// The unit quaternion (w, x, y, z) of a rotation; of q and -q, the one whose largest component is positive.
/// (Shepperd 1978, "Quaternion from rotation matrix".)
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Matrix<Scalar, 4, 1> quaternion_of(const Mat3<Scalar>& r) {
  const Scalar trace = r.trace();
  Matrix<Scalar, 4, 1> q(trace, r(0, 0), r(1, 1), r(2, 2));
  const int largest = q.index_of_max();
  if (largest == 0)
    return Matrix<Scalar, 4, 1>(1 + trace, r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)).normalized();
  const int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
  q[0] = r(k, j) - r(j, k);
  q[1 + i] = 1 + r(i, i) - r(j, j) - r(k, k);
  q[1 + j] = r(j, i) + r(i, j);
  q[1 + k] = r(k, i) + r(i, k);
  return q.normalized();
}

/// The rotation about the direction of `turn` by its length, rad.
[[nodiscard]] COROTET_COLD inline Mat3<double> rotation_by(const Vec3<double>& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return Mat3<double>::Identity();
  const auto [sine, cosine] = detail::sine_and_cosine(angle / 2);
  const Vec3<double> axis = sine / angle * turn;
  return rotation_of<double>({cosine, axis[0], axis[1], axis[2]});
}

/// The axis of a rotation times its angle, rad, at most pi: of rotation_by the inverse.
[[nodiscard]] COROTET_COLD inline Vec3<double> rotation_vector(const Mat3<double>& r) {
  Matrix<double, 4, 1> q = quaternion_of(r);
  if (q[0] < 0) q = -q;
  const Vec3<double> axis(q[1], q[2], q[3]);
  const double sine = axis.norm();
  if (!(sine > 0)) return Vec3<double>::Zero();
  constexpr double quarter_turn = 1.5707963267948966;
  double half_angle = sine < q[0] ? sine : quarter_turn - q[0];
  for (int i = 0; i < 3; ++i) {  // adds the sine of what is missing: of third order
    const auto [s, c] = detail::sine_and_cosine(half_angle);
    half_angle += sine * c - q[0] * s;
  }
  return 2 * half_angle / sine * axis;
}

}  // namespace corotet::inline v0_1
