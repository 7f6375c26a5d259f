// The rotation nearest to any finite 3x3 matrix: slow, sure, one matrix at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/core/types.hpp>
#include <limits>

namespace corotet {

namespace detail {

/// The eigenvectors, as columns, of a symmetric matrix with entries of order one, whose diagonal becomes the
/// eigenvalues: cyclic Jacobi rotations (Golub & Van Loan 2013, section 8.5). Eigen's solver gives the same, but takes
/// nine seconds to compile in every file that steps a body; the tests compare the two.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 4, 4> diagonalise(Eigen::Matrix<Scalar, 4, 4>& k) {
  constexpr int most_sweeps = 16;  // quadratic convergence: four or five are enough
  const Scalar negligible = k.norm() * std::numeric_limits<Scalar>::epsilon() / 8;
  Eigen::Matrix<Scalar, 4, 4> vectors = Eigen::Matrix<Scalar, 4, 4>::Identity();
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < most_sweeps; ++sweep) {
    rotated = false;
    for (int p = 0; p < 3; ++p)
      for (int q = p + 1; q < 4; ++q) {
        if (!(std::abs(k(p, q)) > negligible)) continue;
        rotated = true;
        // tan of the smaller of the two angles that make k(p, q) zero.
        const Scalar cotangent = (k(q, q) - k(p, p)) / (2 * k(p, q));
        const Scalar t =
            std::copysign(Scalar(1), cotangent) / (std::abs(cotangent) + std::sqrt(cotangent * cotangent + Scalar(1)));
        const Scalar c = 1 / std::sqrt(t * t + Scalar(1)), s = t * c;
        for (int i = 0; i < 4; ++i) {
          const Scalar x = k(i, p), y = k(i, q);
          k(i, p) = c * x - s * y;
          k(i, q) = s * x + c * y;
        }
        for (int i = 0; i < 4; ++i) {
          const Scalar x = k(p, i), y = k(q, i);
          k(p, i) = c * x - s * y;
          k(q, i) = s * x + c * y;
        }
        for (int i = 0; i < 4; ++i) {
          const Scalar x = vectors(i, p), y = vectors(i, q);
          vectors(i, p) = c * x - s * y;
          vectors(i, q) = s * x + c * y;
        }
      }
  }
  return vectors;
}

/// A unit eigenvector of the largest eigenvalue.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 4, 1> dominant_eigenvector(Eigen::Matrix<Scalar, 4, 4> k) {
  const Eigen::Matrix<Scalar, 4, 4> vectors = diagonalise<Scalar>(k);
  int largest = 0;
  for (int i = 1; i < 4; ++i)
    if (k(i, i) > k(largest, largest)) largest = i;
  return vectors.col(largest).normalized();
}

/// Entries of order one times 2^exponent.
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> scaled(const Mat3<Scalar>& f, int exponent) {
  // A power of two leaves the digits alone; in two halves, because 2^-exponent itself may overflow.
  return f * std::ldexp(Scalar(1), -exponent / 2) * std::ldexp(Scalar(1), -(exponent - exponent / 2));
}

/// Davenport's matrix K: q . K q = tr(R^T B) for the rotation R of a unit quaternion q (w x y z).
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 4, 4> davenport(const Mat3<Scalar>& b) {
  Eigen::Matrix<Scalar, 4, 4> k;
  const Scalar trace = b(0, 0) + b(1, 1) + b(2, 2);
  k(0, 0) = trace;
  k(0, 1) = k(1, 0) = b(2, 1) - b(1, 2);
  k(0, 2) = k(2, 0) = b(0, 2) - b(2, 0);
  k(0, 3) = k(3, 0) = b(1, 0) - b(0, 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) k(1 + i, 1 + j) = b(i, j) + b(j, i) - (i == j ? trace : Scalar(0));
  return k;
}

template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> rotation_of(const Eigen::Matrix<Scalar, 4, 1>& q) {
  return Eigen::Quaternion<Scalar>(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace detail

/// How far rounding may have moved the entries of a matrix that was summed from numbers of size `unit`: of a
/// deformation gradient, from the identity and the gradients of displacements.
template <std::floating_point Scalar>
[[nodiscard]] constexpr Scalar rounding_of_entries(Scalar unit) {
  return 256 * std::numeric_limits<Scalar>::epsilon() * unit;
}

/// R = argmax tr(R^T F) over rotations, by the dominant eigenvector of Davenport's 4x4 matrix, which is a unit
/// quaternion (Horn 1987, section 4). Never a reflection; for a non-finite F, the identity.
///
/// Where several rotations are equally near (a point, a line, some mirror images) it returns one of them. With
/// `unit` > 0, see rounding_of_entries, that is the one that turns least, also where rounding would choose another, and
/// of half turns those about x rather than y rather than z. So all elements of a body that starts collapsed or mirrored
/// turn the same way, and it unfolds; by rounding each would turn its own way, and they lock.
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> polar_robust(const Mat3<Scalar>& f, Scalar unit = 0) {
  const Scalar largest = f.cwiseAbs().maxCoeff();
  if (!(largest > rounding_of_entries(unit)) || !std::isfinite(largest) || !f.allFinite())
    return Mat3<Scalar>::Identity();
  int exponent = 0;
  std::frexp(largest, &exponent);
  Eigen::Matrix<Scalar, 4, 4> k = detail::davenport<Scalar>(detail::scaled<Scalar>(f, exponent));
  if (unit > 0) {
    const Scalar preference = std::ldexp(rounding_of_entries(std::max(unit, largest)), -exponent);
    for (int i = 0; i < 3; ++i) k(i, i) += static_cast<Scalar>(4 >> i) * preference;  // 4: F + preference I
  }
  return detail::rotation_of<Scalar>(detail::dominant_eigenvector<Scalar>(k));
}

/// Of the four rotations for which R^T F is symmetric, that is for which tr(R^T F) is stationary, the one that is
/// nearest to another rotation: the eigenvectors of Davenport's matrix are those four. Where rounding would choose
/// (see rounding_of_entries), it is `near` itself; for a non-finite F too.
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> polar_near(const Mat3<Scalar>& f, const Mat3<Scalar>& near, Scalar unit) {
  const Scalar largest = f.cwiseAbs().maxCoeff();
  if (!(largest > rounding_of_entries(unit)) || !std::isfinite(largest) || !f.allFinite()) return near;
  int exponent = 0;
  std::frexp(largest, &exponent);
  const Eigen::Quaternion<Scalar> turn(near);
  const Eigen::Matrix<Scalar, 4, 1> q(turn.w(), turn.x(), turn.y(), turn.z());
  Eigen::Matrix<Scalar, 4, 4> k = detail::davenport<Scalar>(detail::scaled<Scalar>(f, exponent));
  k += std::ldexp(4 * rounding_of_entries(std::max(unit, largest)), -exponent) * q * q.transpose();
  const Eigen::Matrix<Scalar, 4, 4> vectors = detail::diagonalise<Scalar>(k);
  int nearest = 0;
  for (int i = 1; i < 4; ++i)
    if (std::abs(vectors.col(i).dot(q)) > std::abs(vectors.col(nearest).dot(q))) nearest = i;
  return detail::rotation_of<Scalar>(vectors.col(nearest).normalized());
}

}  // namespace corotet
