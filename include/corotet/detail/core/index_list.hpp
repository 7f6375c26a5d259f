// What is done with lists of indices in many places of the set-up, compiled once.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Puts `count` indices behind those of the list.
COROTET_NOINLINE inline void append(std::vector<Index>& list, const Index* first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) list.push_back(first[i]);
}
inline void append(std::vector<Index>& list, const std::vector<Index>& more) { append(list, more.data(), more.size()); }

/// Sorts a short list: Shell's method, with the gaps of Ciura 2001. (Cheaper to compile than std::sort.)
COROTET_COLD inline void sort(Index* list, std::size_t count) {
  constexpr std::array<std::size_t, 8> gaps{701, 301, 132, 57, 23, 10, 4, 1};
  for (const std::size_t gap : gaps)
    for (std::size_t i = gap; i < count; ++i) {
      const Index value = list[i];
      std::size_t j = i;
      for (; j >= gap && list[j - gap] > value; j -= gap) list[j] = list[j - gap];
      list[j] = value;
    }
}

/// Sorts the list, and leaves one of equals.
COROTET_NOINLINE inline void sort_and_unite(std::vector<Index>& list) {
  sort(list.data(), list.size());
  list.resize(static_cast<std::size_t>(std::unique(list.begin(), list.end()) - list.begin()));
}

/// Puts the `least` indices in front that come first by `less`, a strict order of all that are there (Hoare's FIND).
template <class Less>
void put_in_front(Index* list, Index count, Index least, const Less& less) {
  Index first = 0, last = count - 1;
  while (first < last) {
    const Index pivot = list[first + (last - first) / 2];
    Index i = first, j = last;
    while (i <= j) {
      while (less(list[i], pivot)) ++i;
      while (less(pivot, list[j])) --j;
      if (i <= j) std::swap(list[i++], list[j--]);
    }
    if (j < least) first = i;
    if (least < i) last = j;
  }
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
