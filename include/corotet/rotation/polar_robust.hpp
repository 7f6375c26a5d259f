// The rotation nearest to any finite 3x3 matrix: slow, sure, one matrix at a time.
#pragma once

#include <cmath>
#include <corotet/core/types.hpp>
#include <limits>

namespace corotet {

namespace detail {

/// A unit eigenvector of the largest eigenvalue of a symmetric matrix with entries of order one, by cyclic Jacobi
/// rotations (Golub & Van Loan 2013, section 8.5). Eigen's solver gives the same, but takes nine seconds to compile in
/// every file that steps a body; the tests compare the two.
template <std::floating_point Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 4, 1> dominant_eigenvector(Eigen::Matrix<Scalar, 4, 4> k) {
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
  int largest = 0;
  for (int i = 1; i < 4; ++i)
    if (k(i, i) > k(largest, largest)) largest = i;
  return vectors.col(largest).normalized();
}

}  // namespace detail

/// R = argmax tr(R^T F) over rotations, by the dominant eigenvector of Davenport's 4x4 matrix, which is a unit
/// quaternion (Horn 1987, section 4). Never a reflection. Where several rotations are equally near (a point, a line,
/// some mirror images) it returns one of them; for a non-finite F, the identity.
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> polar_robust(const Mat3<Scalar>& f) {
  const Scalar largest = f.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest) || !f.allFinite()) return Mat3<Scalar>::Identity();
  int exponent = 0;
  std::frexp(largest, &exponent);
  // A power of two leaves the digits alone; in two halves, because 2^-exponent itself may overflow.
  const Mat3<Scalar> b = f * std::ldexp(Scalar(1), -exponent / 2) * std::ldexp(Scalar(1), -(exponent - exponent / 2));

  Eigen::Matrix<Scalar, 4, 4> k;
  const Scalar trace = b(0, 0) + b(1, 1) + b(2, 2);
  k(0, 0) = trace;
  k(0, 1) = k(1, 0) = b(2, 1) - b(1, 2);
  k(0, 2) = k(2, 0) = b(0, 2) - b(2, 0);
  k(0, 3) = k(3, 0) = b(1, 0) - b(0, 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) k(1 + i, 1 + j) = b(i, j) + b(j, i) - (i == j ? trace : Scalar(0));
  const Eigen::Matrix<Scalar, 4, 1> q = detail::dominant_eigenvector<Scalar>(k);
  return Eigen::Quaternion<Scalar>(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace corotet
