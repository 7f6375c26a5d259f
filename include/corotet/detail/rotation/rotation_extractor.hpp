// The policy slot "how is the rotation of an element found": F -> R, for a batch of elements at a time.
#pragma once

#include <concepts>
#include <corotet/detail/core/lanes.hpp>
#include <string_view>

namespace corotet::inline v0_1 {

/// Law: for every finite deformation gradient F, inverted, flat and zero included, R is finite, R^T R = I and det R =
/// +1, to rounding. For F with NaN or infinite entries R is still finite.
///
/// `per_element` is false where each quadrature point gets its own rotation, and true where an element has one, taken
/// from its mean deformation gradient (the same thing for Tet4).
template <class Model>
concept RotationExtractor =
    requires(const Mat3Lanes<float>& f, Mat3Lanes<float>& rf, const Mat3Lanes<double>& d, Mat3Lanes<double>& rd) {
      Model::extract(f, rf);
      Model::extract(d, rd);
      requires std::same_as<decltype(Model::per_element), const bool>;
      requires std::same_as<decltype(Model::name), const std::string_view>;
    };

namespace detail {

/// R of deformation gradients. A model that asks for it learns that F is of size 1 at rest: what is small and what is
/// rounding follow from that.
template <RotationExtractor Model, std::floating_point Scalar>
COROTET_ALWAYS_INLINE void extract_from_gradient(const Mat3Lanes<Scalar>& f, Mat3Lanes<Scalar>& r) {
  if constexpr (requires { Model::extract(f, r, Scalar(1)); })
    Model::extract(f, r, Scalar(1));
  else
    Model::extract(f, r);
}

}  // namespace detail

/// One matrix through the batch code: for tests and one-off use.
template <RotationExtractor Model, std::floating_point Scalar>
[[nodiscard]] Mat3<Scalar> extract_rotation(const Mat3<Scalar>& f) {
  Mat3Lanes<Scalar> lanes, r;
  for (int l = 0; l < lane_count<Scalar>; ++l) lanes.set_lane(l, f);
  Model::extract(lanes, r);
  return r.lane(0);
}

}  // namespace corotet::inline v0_1
