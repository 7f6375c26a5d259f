// The deformation gradients of a batch of elements at their quadrature points, and the rotations in them.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/element_batch.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// The mean of F over the points of each element, by volume.
template <class Batch, std::floating_point Scalar, std::size_t points>
[[nodiscard]] Mat3Lanes<Scalar> mean_of_points(const Batch& batch, const std::array<Mat3Lanes<Scalar>, points>& f) {
  Lanes<Scalar> volume = batch.point[0].volume;
  for (std::size_t q = 1; q < points; ++q) volume += batch.point[q].volume;
  volume = select(volume > 0, volume, Lanes<Scalar>(1));
  Mat3Lanes<Scalar> mean;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      mean(i, j) = batch.point[0].volume * f[0](i, j);
      for (std::size_t q = 1; q < points; ++q) mean(i, j) += batch.point[q].volume * f[q](i, j);
      mean(i, j) = mean(i, j) / volume;
    }
  return mean;
}

/// r[q] = R of f[q], or with Rotation::per_element of their mean. `least`: of the determinants of f, in each element.
///
/// In an element that is inverted at a point, or nearly, a point's polar rotation is the one of its four stationary
/// rotations, R^T F symmetric, that is nearest to the rotation of the element's mean F: that of the largest tr(R^T F)
/// as long as points do not differ by a half turn or so, so that nothing jumps. Each point for itself would undo its
/// inversion along its own direction of least stretch; points then come to rest turned against each other, at a local
/// minimum of the energy: docs/benchmarks/hard_cases.md. (Schmedding & Teschner 2008 choose the direction of inversion
/// for an element with one point.) Not in an element that is pulled long and thin: it does not unfold, and its rotation
/// about its long axis is ill-determined. R^T F stays symmetric, so that the force is the gradient of an energy, and
/// without torque (but for clear_choice). Costs nothing where no element of the batch is concerned.
template <RotationExtractor Rotation, class Batch, std::floating_point Scalar, std::size_t points>
void extract_rotations(const Batch& batch, const std::array<Mat3Lanes<Scalar>, points>& f, const Lanes<Scalar>& least,
                       std::array<Mat3Lanes<Scalar>, points>& r) {
  if constexpr (Rotation::per_element && points > 1) {
    extract_from_gradient<Rotation>(mean_of_points(batch, f), r[0]);
    for (std::size_t q = 1; q < points; ++q) r[q] = r[0];
  } else {
    for (std::size_t q = 0; q < points; ++q) extract_from_gradient<Rotation>(f[q], r[q]);
    if constexpr (std::derived_from<Rotation, Polar> && points > 1) {
      constexpr auto healthy = Scalar(0.3);  // not 0: elements turned inside out at a corner alone unfold too
      constexpr auto stretched = Scalar(6);  // |F|^2 is 3 at rest; where a bar is held at four times its length, 16
      const LaneMask<Scalar> inverted = least < Lanes<Scalar>(healthy);
      if (!inverted.any()) return;
      const Mat3Lanes<Scalar> mean = mean_of_points(batch, f);
      Lanes<Scalar> norm2 = mean(0, 0) * mean(0, 0);
      for (int k = 1; k < 9; ++k) norm2 += mean(k / 3, k % 3) * mean(k / 3, k % 3);
      const LaneMask<Scalar> folded = inverted & (norm2 < Lanes<Scalar>(stretched));
      Mat3Lanes<Scalar> turn;
      extract_from_gradient<Rotation>(mean, turn);
      for (int l = 0; l < lane_count<Scalar>; ++l)
        for (std::size_t q = 0; folded[l] && q < points; ++q)
          r[q].set_lane(l, polar_near<Scalar>(f[q].lane(l), turn.lane(l), Scalar(1)));
    }
  }
}

/// F and R at each quadrature point of a batch, and the least determinant of F in each element.
template <RotationExtractor Rotation, std::floating_point Scalar, ReferenceElement Element, std::size_t points>
Lanes<Scalar> deformation_of_batch(const ElementBatch<Scalar, Element>& batch, const Field<Scalar>& displacement,
                                   std::array<Mat3Lanes<Scalar>, points>& f, std::array<Mat3Lanes<Scalar>, points>& r) {
  std::array<Vec3Lanes<Scalar>, std::size_t{Element::nodes}> u;
  batch.gather(displacement.data(), u);
  for (std::size_t q = 0; q < points; ++q) batch.displacement_gradient(q, u, f[q]);
  Lanes<Scalar> least = 1;
  for (std::size_t q = 0; q < points; ++q) {
    for (int i = 0; i < 3; ++i) f[q](i, i) += 1;
    least = lane_min(least, determinant(f[q]));
  }
  extract_rotations<Rotation>(batch, f, least, r);
  return least;
}

}  // namespace corotet::inline v0_1::detail
