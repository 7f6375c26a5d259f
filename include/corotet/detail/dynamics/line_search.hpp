// How far to go along a direction of descent.
#pragma once

#include <concepts>

namespace corotet::inline v0_1::detail {

/// The largest of 1, 1/2, 1/4, ... for which `change(fraction)` is at most 1e-4 fraction slope + noise (Armijo 1966;
/// Nocedal & Wright 2006, algorithm 3.1), or 0 if there is none. `change`: of an energy from fraction 0; `slope` < 0:
/// its derivative there; `noise` >= 0: what rounding may add to it. A change that is not a number is too large.
template <std::invocable<double> Change>
[[nodiscard]] double backtrack(double slope, double noise, Change&& change) {
  constexpr int max_halvings = 20;
  double fraction = 1;
  for (int halving = 0; halving <= max_halvings; ++halving, fraction /= 2)
    if (change(fraction) <= 1e-4 * fraction * slope + noise) return fraction;
  return 0;
}

}  // namespace corotet::inline v0_1::detail
