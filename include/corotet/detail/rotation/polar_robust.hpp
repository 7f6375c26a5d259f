// The rotation nearest to any finite 3x3 matrix: slow, sure, one matrix at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <limits>

namespace corotet::inline v0_1::detail {

/// The eigenvectors, as columns, of a symmetric matrix with entries of order one, whose diagonal becomes the
/// eigenvalues: cyclic Jacobi rotations (Golub & Van Loan 2013, section 8.5). Eigen's solver gives the same, but takes
/// nine seconds to compile in every file that steps a body; the tests compare the two.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Matrix<Scalar, 4, 4> diagonalise(Matrix<Scalar, 4, 4>& k) {
  constexpr int max_sweeps = 16;  // quadratic convergence: four or five are enough
  const Scalar negligible = k.norm() * std::numeric_limits<Scalar>::epsilon() / 8;
  Matrix<Scalar, 4, 4> vectors = Matrix<Scalar, 4, 4>::Identity();
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < max_sweeps; ++sweep) {
    rotated = false;
    for (int p = 0; p < 3; ++p)
      for (int q = p + 1; q < 4; ++q) {
        if (!(std::fabs(k(p, q)) > negligible)) continue;
        rotated = true;
        // tan of the smaller of the two angles that make k(p, q) zero.
        const Scalar cotangent = (k(q, q) - k(p, p)) / (2 * k(p, q));
        const Scalar t = std::copysign(Scalar(1), cotangent) /
                         (std::fabs(cotangent) + square_root(cotangent * cotangent + Scalar(1)));
        const Scalar c = 1 / square_root(t * t + Scalar(1)), s = t * c;
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

/// One of the four unit eigenvectors of Davenport's matrix K (see there), and how far its eigenvalue is from the
/// others: that of the largest eigenvalue, or the one nearest to a unit quaternion.
template <std::floating_point Scalar>
struct StationaryRotation {
  Matrix<Scalar, 4, 1> quaternion;
  Scalar gap = std::numeric_limits<Scalar>::infinity();

  explicit StationaryRotation(Matrix<Scalar, 4, 4> k) {
    const Matrix<Scalar, 4, 4> vectors = diagonalise<Scalar>(k);
    set(k, vectors, k.diagonal().index_of_max());
  }
  StationaryRotation(Matrix<Scalar, 4, 4> k, const Matrix<Scalar, 4, 1>& direction) {
    const Matrix<Scalar, 4, 4> vectors = diagonalise<Scalar>(k);
    set(k, vectors, (vectors.transpose() * direction).cwiseAbs().index_of_max());
  }

 private:
  void set(const Matrix<Scalar, 4, 4>& values, const Matrix<Scalar, 4, 4>& vectors, int which) {
    quaternion = vectors.col(which).normalized();
    for (int i = 0; i < 4; ++i)
      if (i != which) gap = (std::min)(gap, std::fabs(values(i, i) - values(which, which)));
  }
};

/// Entries of order one times 2^exponent.
template <std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> scaled(const Mat3<Scalar>& f, int exponent) {
  // A power of two leaves the digits alone; in two halves, because 2^-exponent itself may overflow.
  return f * std::ldexp(Scalar(1), -exponent / 2) * std::ldexp(Scalar(1), -(exponent - exponent / 2));
}

/// Davenport's matrix K: q . K q = tr(R^T B) for the rotation R of a unit quaternion q (w x y z).
template <std::floating_point Scalar>
[[nodiscard]] Matrix<Scalar, 4, 4> davenport(const Mat3<Scalar>& b) {
  Matrix<Scalar, 4, 4> k;
  const Scalar trace = b(0, 0) + b(1, 1) + b(2, 2);
  k(0, 0) = trace;
  k(0, 1) = k(1, 0) = b(2, 1) - b(1, 2);
  k(0, 2) = k(2, 0) = b(0, 2) - b(2, 0);
  k(0, 3) = k(3, 0) = b(1, 0) - b(0, 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) k(1 + i, 1 + j) = b(i, j) + b(j, i) - (i == j ? trace : Scalar(0));
  return k;
}

/// How far rounding may have moved the entries of a matrix that was summed from numbers of size `unit`: of a
/// deformation gradient, from the identity and the gradients of displacements.
template <std::floating_point Scalar>
[[nodiscard]] constexpr Scalar rounding_of_entries(Scalar unit) {
  return 256 * std::numeric_limits<Scalar>::epsilon() * unit;
}

/// Returns the difference of tr(R^T F) from which on the choice between two stationary rotations is clear. A rotation
/// is stationary if R^T F is symmetric. `unit`: the size of F at rest.
///
/// Below it rounding would choose, and the elements of a body that starts collapsed or mirrored would turn each their
/// own way and lock. R is then chosen by the axes of the rest configuration, so that all turn the same way. R^T F is
/// symmetric only to 0.003 `unit` there: docs/theory.md, "The rotation".
template <std::floating_point Scalar>
[[nodiscard]] constexpr Scalar clear_choice(Scalar unit) {
  return Scalar(0.008) * unit;
}

/// Davenport's matrix of F / 2^exponent, and in the same measure what makes a choice among its eigenvectors clear.
template <std::floating_point Scalar>
struct Choice {
  Matrix<Scalar, 4, 4> k;
  Scalar clear;

  /// `largest`: of the entries of F, by size.
  Choice(const Mat3<Scalar>& f, Scalar largest, Scalar unit) {
    clear = (std::max)(clear_choice(unit), rounding_of_entries(largest));
    int exponent = 0;
    std::frexp((std::max)(largest, clear), &exponent);
    k = davenport<Scalar>(scaled<Scalar>(f, exponent));
    clear = std::ldexp(clear, -exponent);
  }

  /// For a gap < clear: what to prefer is worth a part of this; `clear` between rotations with the same tr(R^T F), 0
  /// where the choice becomes clear, so that nothing jumps there.
  [[nodiscard]] Scalar doubt(Scalar gap) const {
    const Scalar unclear = 1 - gap / clear;
    return unclear * unclear * clear;
  }
};

/// R = argmax tr(R^T F) over rotations, by the dominant eigenvector of Davenport's 4x4 matrix, which is a unit
/// quaternion (Horn 1987, section 4). Never a reflection; for a non-finite F, the identity.
///
/// Where several rotations are equally near (a point, a line, some mirror images) it returns one of them. With
/// `unit` > 0, the size of F at rest, it prefers where the choice is not clear (clear_choice) those that turn less, and
/// of half turns those about x to y to z.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Mat3<Scalar> polar_robust(const Mat3<Scalar>& f, Scalar unit = 0) {
  const Scalar largest = f.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest) || !f.allFinite()) return Mat3<Scalar>::Identity();
  Choice<Scalar> choice(f, largest, unit);
  StationaryRotation<Scalar> nearest(choice.k);
  if (unit > 0 && nearest.gap < choice.clear) {
    const Scalar preference = choice.doubt(nearest.gap) / 8;
    for (int i = 0; i < 3; ++i) choice.k(i, i) += static_cast<Scalar>(4 >> i) * preference;  // 4: F + preference I
    nearest = StationaryRotation<Scalar>(choice.k);
  }
  return rotation_of<Scalar>(nearest.quaternion);
}

/// Of the four rotations for which R^T F is symmetric, that is for which tr(R^T F) is stationary, the one that is
/// nearest to another rotation: the eigenvectors of Davenport's matrix are those four. Where it is not clear which
/// rotations these are (clear_choice), `other` decides with them; for F = 0 or a non-finite F it is `other` itself.
template <std::floating_point Scalar>
[[nodiscard]] COROTET_COLD Mat3<Scalar> polar_near(const Mat3<Scalar>& f, const Mat3<Scalar>& other, Scalar unit) {
  const Scalar largest = f.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest) || !f.allFinite()) return other;
  const Matrix<Scalar, 4, 1> q = quaternion_of<Scalar>(other);
  Choice<Scalar> choice(f, largest, unit);
  StationaryRotation<Scalar> stationary(choice.k, q);
  if (stationary.gap < choice.clear) {
    choice.k += choice.doubt(stationary.gap) / 20 * q * q.transpose();
    stationary = StationaryRotation<Scalar>(choice.k, q);
  }
  return rotation_of<Scalar>(stationary.quaternion);
}

}  // namespace corotet::inline v0_1::detail
