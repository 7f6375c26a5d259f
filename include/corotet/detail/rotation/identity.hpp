// No rotation at all: linear elasticity, right for small rotations only.
#pragma once

#include <corotet/detail/rotation/rotation_extractor.hpp>

namespace corotet::inline v0_1 {

/// R = I. A body that turns or bends far grows in volume: this is what the corotational method cures.
struct Identity {
  static constexpr bool per_element = false;            ///< each quadrature point has its own
  static constexpr std::string_view name = "identity";  ///< as in messages

  /// Sets `r` to the identity.
  template <std::floating_point Scalar>
  static void extract(const Mat3Lanes<Scalar>& /*f*/, Mat3Lanes<Scalar>& r) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r(i, j) = Lanes<Scalar>(i == j ? 1 : 0);
  }
};

static_assert(RotationExtractor<Identity>);

}  // namespace corotet::inline v0_1
