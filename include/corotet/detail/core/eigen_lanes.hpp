// Eigenvalues and eigenvectors of symmetric 3x3 matrices, one in each lane.
#pragma once

#include <corotet/detail/core/lanes.hpp>

namespace corotet::inline v0_1::detail {

/// The eigenvectors (columns of `v`) of a symmetric matrix, whose diagonal becomes the eigenvalues: cyclic Jacobi
/// rotations (Golub & Van Loan 2013, section 8.5).
template <std::floating_point Scalar>
void diagonalise_lanes(Mat3Lanes<Scalar>& a, Mat3Lanes<Scalar>& v) {
  using L = Lanes<Scalar>;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) v(i, j) = L(i == j ? 1 : 0);
  constexpr int sweeps = 5;  // quadratic convergence: enough for double
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int p = 0; p < 3; ++p) {
      const int q = (p + 1) % 3, k = (p + 2) % 3;
      const L off = a(p, q) + a(p, q), difference = a(q, q) - a(p, p);
      const L size = lane_abs(difference) + sqrt(difference * difference + off * off);
      const L t = select(size > L(0), select(difference < L(0), -off, off) / select(size > L(0), size, L(1)), L(0));
      const L c = L(1) / sqrt(L(1) + t * t), s = t * c;
      const L shift = t * a(p, q);
      a(p, p) -= shift;
      a(q, q) += shift;
      a(p, q) = a(q, p) = L(0);
      const L kp = a(k, p), kq = a(k, q);
      a(k, p) = a(p, k) = c * kp - s * kq;
      a(k, q) = a(q, k) = s * kp + c * kq;
      for (int i = 0; i < 3; ++i) {
        const L x = v(i, p), y = v(i, q);
        v(i, p) = c * x - s * y;
        v(i, q) = s * x + c * y;
      }
    }
}

}  // namespace corotet::inline v0_1::detail
