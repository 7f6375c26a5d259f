// How an element maps natural coordinates to space.
#pragma once

#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// dX/dxi, m, (space, natural coordinate): the sum over nodes of X_a (x) dN_a/dxi, where `position[a]` is X_a, m.
template <std::size_t N>
[[nodiscard]] Mat3<double> jacobian(const std::array<NaturalCoordinates, N>& gradient,
                                    const std::array<Vec3<double>, N>& position) {
  Mat3<double> sum = Mat3<double>::Zero();
  for (std::size_t a = 0; a < N; ++a) sum += position[a] * Vec3<double>::load(gradient[a].data()).transpose();
  return sum;
}

}  // namespace corotet::inline v0_1::detail
