// Cholesky factorisation of one small block.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// Sets `inverse` to the inverse of L, a = L L^T, with zeros above its diagonal. False if `a` is not positive definite;
/// reads its lower triangle only.
template <std::floating_point Scalar, int B>
[[nodiscard]] bool inverse_cholesky(Matrix<Scalar, B, B> a, Matrix<Scalar, B, B>& inverse) {
  inverse.setZero();
  for (int j = 0; j < B; ++j) {
    Scalar pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k);
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    a(j, j) = detail::square_root(pivot);
    for (int i = j + 1; i < B; ++i) {
      for (int k = 0; k < j; ++k) a(i, j) -= a(i, k) * a(j, k);
      a(i, j) /= a(j, j);
    }
    // Row j of the inverse needs the rows above it only.
    inverse(j, j) = 1 / a(j, j);
    for (int c = 0; c < j; ++c) {
      Scalar sum = 0;
      for (int k = c; k < j; ++k) sum += a(j, k) * inverse(k, c);
      inverse(j, c) = -sum / a(j, j);
    }
  }
  return true;
}

}  // namespace corotet::inline v0_1::detail
