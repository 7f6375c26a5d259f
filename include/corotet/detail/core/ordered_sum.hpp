// A sum over tasks that gives the same bits on any number of threads, and needs no memory.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1::detail {

/// The sum of `part(begin, end)`, which returns a double, over at most 64 ranges of [0, count), each by one task, added
/// in their order. `min_grain`: entries of a range at least. The ranges depend on `count` and `min_grain` alone.
template <std::invocable<Index, Index> Part>
[[nodiscard]] double ordered_sum(ExecutorRef executor, Index count, Index min_grain, Part&& part) {
  constexpr Index max_ranges = 64;
  std::array<double, std::size_t{max_ranges}> partial;
  const Index grain = (std::max)(min_grain, (count + max_ranges - 1) / max_ranges);
  for_ranges(executor, count, grain, [&](Index begin, Index end) { partial[at(begin / grain)] = part(begin, end); });
  double sum = 0;
  for (Index range = 0; range * grain < count; ++range) sum += partial[at(range)];
  return sum;
}

}  // namespace corotet::inline v0_1::detail
