// What is done with lists of indices in many places of the set-up, compiled once.
#pragma once

#include <algorithm>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Puts `count` indices behind those of the list.
COROTET_NOINLINE inline void append(std::vector<Index>& list, const Index* first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) list.push_back(first[i]);
}
inline void append(std::vector<Index>& list, const std::vector<Index>& more) { append(list, more.data(), more.size()); }

/// Sorts the list, and leaves one of equals.
COROTET_NOINLINE inline void sort_and_unite(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.resize(static_cast<std::size_t>(std::unique(list.begin(), list.end()) - list.begin()));
}

/// Where each of `count` values, 0 <= value < range, stands among them: the places of value v, ascending, are
/// place[start[v]] ... place[start[v + 1] - 1].
COROTET_COLD inline void find_places(const Index* value, std::size_t count, std::size_t range,
                                     std::vector<Index>& start, std::vector<Index>& place) {
  start.assign(range + 1, 0);
  for (std::size_t k = 0; k < count; ++k) ++start[at(value[k]) + 1];
  for (std::size_t v = 0; v < range; ++v) start[v + 1] += start[v];
  place.resize(count);
  std::vector<Index> next = start;
  for (std::size_t k = 0; k < count; ++k) place[at(next[at(value[k])]++)] = static_cast<Index>(k);
}

}  // namespace corotet::inline v0_1::detail
