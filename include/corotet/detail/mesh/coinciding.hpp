// Vertices at exactly the same place.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

namespace corotet::inline v0_1::detail {

/// For each vertex the first one whose three coordinates are equal to its own (0 and -0 are equal), often itself.
/// Positions must be finite. O(n log n).
[[nodiscard]] inline std::vector<Index> first_coinciding(std::span<const Vec3<double>> x) {
  std::vector<Index> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index v) { return std::make_tuple(x[at(v)][0], x[at(v)][1], x[at(v)][2], v); };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
  std::vector<Index> first(x.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && x[at(order[i])] == x[at(order[i - 1])];
    first[at(order[i])] = same ? first[at(order[i - 1])] : order[i];
  }
  return first;
}

}  // namespace corotet::inline v0_1::detail
