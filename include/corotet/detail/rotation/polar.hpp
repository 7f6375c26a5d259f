// The rotation of the polar decomposition F = R S: the default, and the one whose force has an energy.
#pragma once

#include <algorithm>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/rotation/polar_robust.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <limits>

namespace corotet::inline v0_1 {

/// The rotation nearest to F: R maximises tr(R^T F). For det F > 0 it is the orthogonal polar factor; for an inverted
/// element it is the rotation that undoes the inversion along the direction of least stretch (Irving et al. 2004).
/// A gradient's may fall short of the largest trace where the choice is not clear: see clear_choice.
///
/// In batches by Markley's closed form ("Attitude determination using vector observations: a fast optimal matrix
/// algorithm", 1993, eqs. 8-17), with the largest root of the characteristic quartic by Newton from above. It loses
/// digits as the two least signed stretches cancel; lanes where that shows are done again by `polar_robust`, where
/// `unit` is explained.
struct Polar {
  static constexpr bool per_element = false;         ///< each quadrature point has its own
  static constexpr std::string_view name = "polar";  ///< as in messages

  /// Sets `r` to the rotation nearest to each lane's F. `unit`: the size of F at rest, 0 if unknown.
  template <std::floating_point Scalar>
  static void extract(const Mat3Lanes<Scalar>& f, Mat3Lanes<Scalar>& r, Scalar unit = 0) {
    using L = Lanes<Scalar>;
    constexpr Scalar epsilon = std::numeric_limits<Scalar>::epsilon();

    // Entries of order one, whatever the units and however flat the element.
    L largest = lane_abs(f(0, 0));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) largest = lane_max(largest, lane_abs(f(i, j)));
    LaneMask<Scalar> sure =
        (largest > (std::max)(lowest<Scalar>(), detail::rounding_of_entries(unit))) & (largest < highest<Scalar>());
    const L scale = L(1) / select(sure, largest, L(1));
    Mat3Lanes<Scalar> b;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) b(i, j) = select(sure, f(i, j), L(i == j ? 1 : 0)) * scale;

    Mat3Lanes<Scalar> cofactor;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        cofactor(i, j) = b(i1, j1) * b(i2, j2) - b(i1, j2) * b(i2, j1);
      }
    const L det = b(0, 0) * cofactor(0, 0) + b(0, 1) * cofactor(0, 1) + b(0, 2) * cofactor(0, 2);
    const L b2 = squared_norm(b), cofactor2 = squared_norm(cofactor);

    // lambda = tr S, the largest root of (lambda^2 - |B|^2)^2 - 8 lambda det B - 4 |cof B|^2.
    const L bound = sqrt(L(3) * b2);  // s1 + s2 + s3 <= sqrt 3 |B|
    L lambda = bound;
    for (int iteration = 0; iteration < 12; ++iteration) {
      const L excess = lambda * lambda - b2;
      const L value = excess * excess - L(8) * lambda * det - L(4) * cofactor2;
      const L slope = L(4) * lambda * excess - L(8) * det;
      const L step = select(slope > epsilon, value, L(0)) / select(slope > epsilon, slope, L(1));
      lambda -= step;
      if ((lane_abs(step) < L(2 * epsilon) * lambda).all()) break;
    }

    // zeta = (s1+s2)(s2+s3)(s3+s1): what the closed form divides by.
    const L kappa = L(Scalar(0.5)) * (lambda * lambda - b2);
    const L zeta = kappa * lambda - det;
    sure = sure & (zeta > L(smallest_zeta<Scalar>()) * b2 * bound);
    // 2 (s2+s3) is by how much tr(R^T B) is larger than with the next stationary rotation; (s1+s2)(s3+s1) is
    // s1^2 + kappa, and s1^2 <= |B|^2: the choice must be clear.
    sure = sure & (L(2) * zeta > L(detail::clear_choice(unit)) * scale * (b2 + kappa));
    const L inverse_zeta = L(1) / select(sure, zeta, L(1));
    Mat3Lanes<Scalar> btb;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) btb(i, j) = b(0, i) * b(0, j) + b(1, i) * b(1, j) + b(2, i) * b(2, j);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const L bbtb = b(i, 0) * btb(0, j) + b(i, 1) * btb(1, j) + b(i, 2) * btb(2, j);
        r(i, j) = ((kappa + b2) * b(i, j) + lambda * cofactor(i, j) - bbtb) * inverse_zeta;
      }

    sure = sure & polish(r);
    if (!sure.all())
      for (int l = 0; l < lane_count<Scalar>; ++l)
        if (!sure[l]) r.set_lane(l, detail::polar_robust<Scalar>(f.lane(l), unit));
  }

 private:
  template <std::floating_point Scalar>
  static Lanes<Scalar> squared_norm(const Mat3Lanes<Scalar>& m) {
    Lanes<Scalar> sum = m(0, 0) * m(0, 0);
    for (int k = 1; k < 9; ++k) sum += m(k / 3, k % 3) * m(k / 3, k % 3);
    return sum;
  }

  /// One Newton-Schulz step, R <- R (3I - R^T R)/2: squares the distance from orthogonality. False in the lanes where
  /// that distance was too large to trust R.
  template <std::floating_point Scalar>
  static LaneMask<Scalar> polish(Mat3Lanes<Scalar>& r) {
    using L = Lanes<Scalar>;
    Mat3Lanes<Scalar> correction;
    L distance = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const L error = r(0, i) * r(0, j) + r(1, i) * r(1, j) + r(2, i) * r(2, j) - L(i == j ? 1 : 0);
        distance = lane_max(distance, lane_abs(error));
        correction(i, j) = L(Scalar(-0.5)) * error;
        correction(j, i) = correction(i, j);
      }
    for (int i = 0; i < 3; ++i) {
      const L x = r(i, 0), y = r(i, 1), z = r(i, 2);
      for (int j = 0; j < 3; ++j) r(i, j) += x * correction(0, j) + y * correction(1, j) + z * correction(2, j);
    }
    return distance < max_distance<Scalar>();
  }

  // Scales beyond which products of four entries leave the range of Scalar, or reciprocals do.
  template <std::floating_point Scalar>
  static constexpr Scalar lowest() {
    return (std::numeric_limits<Scalar>::min)() * 4;
  }
  template <std::floating_point Scalar>
  static constexpr Scalar highest() {
    return (std::numeric_limits<Scalar>::max)() / 4;
  }
  // Below this zeta (relative to sqrt 3 |B|^3; 0.9 for a rotation) the closed form keeps fewer digits than
  // polar_robust.
  template <std::floating_point Scalar>
  static constexpr Scalar smallest_zeta() {
    return Scalar(0.01);
  }
  // Leaves a rotation orthonormal to rounding after one polish.
  template <std::floating_point Scalar>
  static constexpr Scalar max_distance() {
    return sizeof(Scalar) <= 4 ? Scalar(1e-4) : Scalar(1e-9);
  }
};

static_assert(RotationExtractor<Polar>);

}  // namespace corotet::inline v0_1
