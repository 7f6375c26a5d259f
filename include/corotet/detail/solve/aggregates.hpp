// Boxes of neighbouring vertices, each of which may move as one.
#pragma once

#include <algorithm>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A partition of things that lie somewhere into boxes, no two of which differ in size by more than a few.
struct Aggregates {
  std::vector<Index> start;         ///< count() + 1 entries
  std::vector<Index> member;        ///< [start[a], start[a + 1]): the members of aggregate a, ascending
  std::vector<Index> aggregate_of;  ///< of each thing

  [[nodiscard]] Index count() const { return size_of(start) - 1; }

  [[nodiscard]] std::size_t bytes() const { return bytes_of(start) + bytes_of(member) + bytes_of(aggregate_of); }

  [[nodiscard]] std::span<const Index> members(Index a) const {
    return {member.data() + start[at(a)], at(start[at(a + 1)] - start[at(a)])};
  }

  /// Halves the box across its longest side until there are `count` aggregates, 1 <= count <= position.size().
  template <std::floating_point Scalar>
  [[nodiscard]] COROTET_COLD static Aggregates of_positions(const Field<Scalar>& position, Index count) {
    Aggregates aggregates;
    aggregates.member.resize(position.size());
    for (Index i = 0; i < size_of(position); ++i) aggregates.member[at(i)] = i;
    aggregates.aggregate_of.resize(position.size());
    aggregates.start.reserve(at(count) + 1);
    aggregates.start.push_back(0);
    aggregates.divide(position, 0, size_of(position), count);
    return aggregates;
  }

 private:
  template <std::floating_point Scalar>
  COROTET_COLD void divide(const Field<Scalar>& position, Index begin, Index end, Index count) {
    const auto first = member.begin() + begin, last = member.begin() + end;
    if (count <= 1) {
      sort(member.data() + begin, at(end - begin));
      for (auto m = first; m != last; ++m) aggregate_of[at(*m)] = size_of(start) - 1;
      start.push_back(end);
      return;
    }
    Vec3<Scalar> low = position[at(*first)], high = low;
    for (auto m = first; m != last; ++m) {
      low = low.cwiseMin(position[at(*m)]);
      high = high.cwiseMax(position[at(*m)]);
    }
    const int axis = (high - low).index_of_max();
    const Index half = count / 2;
    const Index split = begin + static_cast<Index>(std::int64_t{end - begin} * half / count);
    put_in_front(member.data() + begin, end - begin, split - begin, [&](Index a, Index b) {
      const Scalar xa = position[at(a)][axis], xb = position[at(b)][axis];
      return exactly_equal(xa, xb) ? a < b : xa < xb;  // a strict order, the same everywhere
    });
    divide(position, begin, split, half);
    divide(position, split, end, count - half);
  }
};

}  // namespace corotet::inline v0_1::detail
