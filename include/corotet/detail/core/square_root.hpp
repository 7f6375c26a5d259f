// Square roots by the processor's instruction: the same bits with every C library, of which MinGW's rounds twice.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <cstddef>
#include <cstring>
#include <type_traits>

// By name, as std::sqrt is a call of the C library where it may have to set errno or code is to be small.
#if defined(__GNUC__) && defined(__SSE2_MATH__) && defined(__has_builtin)
#if __has_builtin(__builtin_ia32_sqrtss) && __has_builtin(__builtin_ia32_sqrtsd) && \
    __has_builtin(__builtin_ia32_sqrtps) && __has_builtin(__builtin_ia32_sqrtpd)
#define COROTET_SSE_SQUARE_ROOTS
#endif
#endif

namespace corotet::inline v0_1::detail {

#if defined(COROTET_SSE_SQUARE_ROOTS)
typedef float FourFloats __attribute__((vector_size(16)));   // NOLINT(modernize-use-using): clang takes it so only
typedef double TwoDoubles __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

COROTET_ALWAYS_INLINE void take_square_roots(FourFloats& x) { x = __builtin_ia32_sqrtps(x); }
COROTET_ALWAYS_INLINE void take_square_roots(TwoDoubles& x) { x = __builtin_ia32_sqrtpd(x); }
#endif

/// The square root, correctly rounded; NaN of a negative number.
template <std::floating_point T>
[[nodiscard]] COROTET_ALWAYS_INLINE T square_root(T x) {
#if defined(COROTET_SSE_SQUARE_ROOTS)
  if constexpr (std::same_as<T, float>)
    return __builtin_ia32_sqrtss(FourFloats{x, x, x, x})[0];
  else if constexpr (std::same_as<T, double>)
    return __builtin_ia32_sqrtsd(TwoDoubles{x, x})[0];
  else
#endif
    return std::sqrt(x);
}

/// Replaces each number by its square root.
template <std::floating_point T, std::size_t n>
void take_square_roots(std::array<T, n>& numbers) {
#if defined(COROTET_SSE_SQUARE_ROOTS)
  if constexpr (sizeof(T) <= sizeof(double) && n * sizeof(T) % sizeof(FourFloats) == 0) {
    std::conditional_t<std::same_as<T, float>, FourFloats, TwoDoubles> several;
    for (std::size_t i = 0; i < n; i += sizeof(several) / sizeof(T)) {
      std::memcpy(&several, &numbers[i], sizeof(several));
      take_square_roots(several);
      std::memcpy(&numbers[i], &several, sizeof(several));
    }
    return;
  }
#endif
  for (T& x : numbers) x = square_root(x);
}

}  // namespace corotet::inline v0_1::detail
