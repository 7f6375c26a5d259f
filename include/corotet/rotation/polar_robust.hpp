// The rotation nearest to any finite 3x3 matrix: slow, sure, one matrix at a time.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <corotet/core/types.hpp>

namespace corotet {

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

  Eigen::Matrix<Scalar, 4, 4> k;  // only the lower triangle is read
  k(0, 0) = b.trace();
  k(1, 0) = b(2, 1) - b(1, 2);
  k(2, 0) = b(0, 2) - b(2, 0);
  k(3, 0) = b(1, 0) - b(0, 1);
  k.template bottomRightCorner<3, 3>() = b + b.transpose() - b.trace() * Mat3<Scalar>::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Scalar, 4, 4>> eigen(k);
  const Eigen::Matrix<Scalar, 4, 1> q = eigen.eigenvectors().col(3).normalized();
  return Eigen::Quaternion<Scalar>(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace corotet
