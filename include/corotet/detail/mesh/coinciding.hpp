// Vertices at exactly the same place.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <numeric>
#include <vector>

namespace corotet::inline v0_1::detail {

/// For each vertex the first one whose three coordinates are equal to its own (0 and -0 are equal), often itself.
/// Positions must be finite. O(n log n).
[[nodiscard]] inline std::vector<Index> first_coinciding(const Field<double>& x) {
  std::vector<Index> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    for (int i = 0; i < 3; ++i)
      if (x[at(a)][i] < x[at(b)][i] || x[at(b)][i] < x[at(a)][i]) return x[at(a)][i] < x[at(b)][i];
    return a < b;
  });
  std::vector<Index> first(x.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && x[at(order[i])] == x[at(order[i - 1])];
    first[at(order[i])] = same ? first[at(order[i - 1])] : order[i];
  }
  return first;
}

}  // namespace corotet::inline v0_1::detail
