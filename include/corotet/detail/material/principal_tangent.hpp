// The tangent of an isotropic law in its principal frame, where its eigenvalues are known.
#pragma once

#include <array>
#include <corotet/detail/core/eigen_lanes.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/strain.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// F = U diag(s) V^T with rotations U and V: s may be negative.
template <std::floating_point Scalar>
struct PrincipalFrame {
  Mat3Lanes<Scalar> u;        ///< U
  Mat3Lanes<Scalar> v;        ///< V
  Vec3Lanes<Scalar> stretch;  ///< s

  /// From the polar rotation: with R^T F = V diag(s) V^T, U = R V. Where R^T F is not symmetric, because the polar
  /// rotation is not unique there (clear_choice), its symmetric part is meant.
  explicit PrincipalFrame(const DeformationLanes<Scalar>& deformation) {
    const detail::StrainLanes<Scalar> strain = detail::corotational_strain(deformation.gradient, deformation.rotation);
    Mat3Lanes<Scalar> e;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      e(i, i) = strain[at(i)];
      e(j, k) = e(k, j) = strain[at(3 + i)];
    }
    detail::diagonalise_lanes(e, v);
    product(deformation.rotation, v, u);
    for (int i = 0; i < 3; ++i) stretch[at(i)] = Lanes<Scalar>(1) + e(i, i);
  }

  /// U A V^T for A with the entries a_ij and a_ji alone.
  [[nodiscard]] Mat3Lanes<Scalar> dyads(int i, int j, const Lanes<Scalar>& a_ij, const Lanes<Scalar>& a_ji) const {
    Mat3Lanes<Scalar> sum;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        sum(row, column) = a_ij * u(row, i) * v(column, j) + a_ji * u(row, j) * v(column, i);
    return sum;
  }
};

/// Adds the tangent of an isotropic law to `c`, from its eigenvalues in the principal frame, Pa. With psi as a function
/// of the stretches, and pairs (i, j) of directions numbered by the third direction k, the nine eigenvectors are U A
/// V^T (Smith, de Goes & Kim 2019, "Analytic eigensystems for isotropic distortion energies"):
///   three twists, A = (e_i e_j^T - e_j e_i^T) / sqrt 2: twist[k] = (dpsi/ds_i + dpsi/ds_j) / (s_i + s_j);
///   three flips, A = (e_i e_j^T + e_j e_i^T) / sqrt 2: flip[k] = (dpsi/ds_i - dpsi/ds_j) / (s_i - s_j);
///   three diagonal A: the eigenvectors of scaling(i, j) = d2psi/ds_i ds_j, which is destroyed.
///
/// `semi_definite`: with the absolute values of the eigenvalues. Unlike the projection to positive ones that is stiff
/// where the law curves down, so that a step of Newton's method does not overshoot from inverted or flat states (Chen,
/// Liu, Jacobson, Levin & Zheng 2024, "Stabler Neo-Hookean Simulation: Absolute Eigenvalue Filtering for Projected
/// Newton").
template <std::floating_point Scalar>
void add_principal_tangent(const PrincipalFrame<Scalar>& frame, const Vec3Lanes<Scalar>& twist,
                           const Vec3Lanes<Scalar>& flip, Mat3Lanes<Scalar>& scaling, bool semi_definite,
                           TangentLanes<Scalar>& c) {
  using L = Lanes<Scalar>;
  const auto usable = [&](const L& eigenvalue) { return semi_definite ? lane_abs(eigenvalue) : eigenvalue; };
  const L half(Scalar(0.5)), one(Scalar(1)), zero(Scalar(0));
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    c.add_outer(half * usable(twist[at(k)]), frame.dyads(i, j, one, -one));
    c.add_outer(half * usable(flip[at(k)]), frame.dyads(i, j, one, one));
  }
  Mat3Lanes<Scalar> axes;
  detail::diagonalise_lanes(scaling, axes);
  for (int k = 0; k < 3; ++k) {
    Mat3Lanes<Scalar> mode;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        mode(row, column) = zero;
        for (int i = 0; i < 3; ++i) mode(row, column) += axes(i, k) * frame.u(row, i) * frame.v(column, i);
      }
    c.add_outer(usable(scaling(k, k)), mode);
  }
}

}  // namespace corotet::inline v0_1
