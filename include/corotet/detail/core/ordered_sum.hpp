// A sum over tasks that gives the same bits on any number of threads, and needs no memory.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <type_traits>

namespace corotet::inline v0_1::detail {

inline constexpr Index max_ordered_ranges = 64;
using OrderedPart = double (*)(void* part, Index begin, Index end);

/// ordered_sum of a part whose type is forgotten.
[[nodiscard]] COROTET_NOINLINE inline double sum_of_ranges(ExecutorRef executor, Index count, Index min_grain,
                                                           void* part, OrderedPart call) {
  std::array<double, std::size_t{max_ordered_ranges}> partial;
  const Index grain = (std::max)(min_grain, (count + max_ordered_ranges - 1) / max_ordered_ranges);
  for_ranges(executor, count, grain,
             [&](Index begin, Index end) { partial[at(begin / grain)] = call(part, begin, end); });
  double sum = 0;
  for (Index range = 0; range * grain < count; ++range) sum += partial[at(range)];
  return sum;
}

/// The sum of `part(begin, end)`, which returns a double, over at most 64 ranges of [0, count), each by one task, added
/// in their order. `min_grain`: entries of a range at least. The ranges depend on `count` and `min_grain` alone.
template <std::invocable<Index, Index> Part>
[[nodiscard]] double ordered_sum(ExecutorRef executor, Index count, Index min_grain, Part&& part) {
  const OrderedPart call = &call_object<double, std::remove_reference_t<Part>, Index, Index>;
  return sum_of_ranges(executor, count, min_grain, address_of(part), call);
}

}  // namespace corotet::inline v0_1::detail
