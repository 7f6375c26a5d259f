// Whether this source is compiled so that its results are the same bits on every processor.
#pragma once

#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/exactly.hpp>

#if defined(COROTET_DETERMINISTIC) && defined(__FAST_MATH__)
#error "COROTET_DETERMINISTIC does not hold with -ffast-math: compile without"
#endif

namespace corotet::inline v0_1::detail {

/// Whether the compiler makes one operation of a * b + c, which rounds once instead of twice: where the processor can,
/// g++ does so unless told -ffp-contract=off, and results then differ from those elsewhere in the last bits.
[[nodiscard]] inline bool contracts() {
  const volatile double a = 1 + 1.0 / (1 << 27), square = a * a;
  const double x = a, rounded = square;
  return !is_zero(x * x - rounded);
}

/// Asked by everything that steps, where COROTET_DETERMINISTIC is defined.
inline void expect_deterministic() {
#if defined(COROTET_DETERMINISTIC)
  COROTET_ASSERT(!contracts(), "COROTET_DETERMINISTIC needs -ffp-contract=off");
#endif
}

}  // namespace corotet::inline v0_1::detail
