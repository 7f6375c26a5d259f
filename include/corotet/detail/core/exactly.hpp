// Comparing numbers exactly, where that is meant and not "nearly".
#pragma once

#include <concepts>
#include <corotet/detail/core/compiler.hpp>

namespace corotet::inline v0_1::detail {

// The one place that compares by ==, so that -Wfloat-equal of a program finds nothing in the library.
#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wfloat-equal"
#endif
template <std::floating_point T>
[[nodiscard]] COROTET_ALWAYS_INLINE constexpr bool exactly_equal(T a, T b) {
  return a == b;
}
#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic pop
#endif

template <std::floating_point T>
[[nodiscard]] COROTET_ALWAYS_INLINE constexpr bool is_zero(T a) {
  return exactly_equal(a, T(0));
}

}  // namespace corotet::inline v0_1::detail
