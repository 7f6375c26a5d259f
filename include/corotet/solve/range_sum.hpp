// Sums over a field that give the same bits on any number of threads.
#pragma once

#include <array>
#include <concepts>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace corotet {

/// The entries [begin, end) of a field as one column of numbers; those of padded fields with their zeros.
template <class FieldType>
[[nodiscard]] auto range_of(FieldType& field, Index begin, Index end) {
  using Numbers = std::remove_reference_t<decltype(field.front()[0])>;  // const if the field is
  constexpr Eigen::Index each = sizeof(field.front()) / sizeof(Numbers);
  using Column = Eigen::Matrix<std::remove_const_t<Numbers>, Eigen::Dynamic, 1>;
  using View = Eigen::Map<std::conditional_t<std::is_const_v<Numbers>, const Column, Column>>;
  return View(field.empty() ? nullptr : field.front().data() + each * begin, each * (end - begin));
}

/// a . b over the entries [begin, end).
template <class A, class B>
[[nodiscard]] double range_dot(const A& a, const B& b, Index begin, Index end) {
  return static_cast<double>(range_of(a, begin, end).dot(range_of(b, begin, end)));
}

/// K sums at once: over ranges of fixed length, each by one task, then over the ranges in order and in double.
template <std::size_t K>
class RangeSums {
 public:
  using Sums = std::array<double, K>;

  RangeSums() = default;
  explicit RangeSums(Index count) : count_(count), partial_(at((count + grain - 1) / grain), Sums{}) {}

  /// The sums of `part(begin, end)`, which returns Sums, over all ranges.
  template <Executor E, std::invocable<Index, Index> Part>
  [[nodiscard]] Sums operator()(E& executor, Part&& part) {
    for_ranges(executor, count_, grain,
               [&](Index begin, Index end) { partial_[at(begin / grain)] = part(begin, end); });
    Sums sums{};
    for (const Sums& p : partial_)
      for (std::size_t k = 0; k < K; ++k) sums[k] += p[k];
    return sums;
  }

  /// Entries a task.
  static constexpr Index grain = 256;

 private:
  Index count_ = 0;
  std::vector<Sums> partial_;
};

/// One sum.
class RangeSum {
 public:
  RangeSum() = default;
  explicit RangeSum(Index count) : sums_(count) {}

  /// The sum of `part(begin, end)`, which returns a double, over all ranges.
  template <Executor E, std::invocable<Index, Index> Part>
  [[nodiscard]] double operator()(E& executor, Part&& part) {
    return sums_(executor, [&](Index begin, Index end) { return RangeSums<1>::Sums{part(begin, end)}; })[0];
  }

  static constexpr Index grain = RangeSums<1>::grain;

 private:
  RangeSums<1> sums_;
};

}  // namespace corotet
