// Sums over a field that give the same bits on any number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <span>
#include <type_traits>

namespace corotet::inline v0_1 {

namespace detail {

/// The numbers of a field's entries [begin, end), vertex-major; those of padded fields with their zeros.
template <class FieldType>
[[nodiscard]] auto range_of(FieldType& field, Index begin, Index end) {
  using Number = std::remove_reference_t<decltype(field.front()[0])>;  // const if the field is
  constexpr std::size_t each = sizeof(field.front()) / sizeof(Number);
  return std::span<Number>(field.empty() ? nullptr : field.front().data() + each * at(begin), each * at(end - begin));
}

/// out = f(in...) number by number over the entries [begin, end). `f` is called with registers and with numbers; `out`
/// may be one of `in`.
template <class Out, class F, class... In>
COROTET_ALWAYS_INLINE void map_range(Index begin, Index end, Out& out, F&& f, const In&... in) {
  using Scalar = std::remove_reference_t<decltype(out.front()[0])>;
  using Several = SimdVec<Scalar, 32 / sizeof(Scalar)>;
  constexpr std::size_t width = 32 / sizeof(Scalar);
  const std::span<Scalar> to = range_of(out, begin, end);
  const auto run = [&](const auto*... from) {
    std::size_t i = 0;
    for (; i + width <= to.size(); i += width) Several(f(Several::load(from + i)...)).store(to.data() + i);
    for (; i < to.size(); ++i) to[i] = f(from[i]...);
  };
  run(range_of(in, begin, end).data()...);
}

template <std::floating_point Scalar>
[[nodiscard]] COROTET_NOINLINE double dot(const Scalar* x, const Scalar* y, std::size_t count) {
  constexpr std::size_t width = 64 / sizeof(Scalar);
  using Several = SimdVec<Scalar, int{width}>;
  Several sums(Scalar(0));
  std::size_t i = 0;
  for (; i + width <= count; i += width) sums += Several::load(x + i) * Several::load(y + i);
  std::array<Scalar, width> part;
  sums.store(part.data());
  for (std::size_t half = width / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) part[k] += part[k + half];
  Scalar total = part[0];
  for (; i < count; ++i) total += x[i] * y[i];
  return static_cast<double>(total);
}

/// a . b over the entries [begin, end). The order of the sum is the same with every instruction set.
template <class A, class B>
[[nodiscard]] double range_dot(const A& a, const B& b, Index begin, Index end) {
  const auto x = range_of(a, begin, end);
  return dot(x.data(), range_of(b, begin, end).data(), x.size());
}

/// Sums over ranges of fixed length, each by one task, then over the ranges in order and in double.
class SumsOfRanges {
 public:
  SumsOfRanges() = default;
  /// Of a field with so many entries; so many sums at once.
  SumsOfRanges(Index count, std::size_t sums) : count_(count), partial_(at((count + grain - 1) / grain) * sums) {}

  /// Sets `sums`, a std::array, to the sums of `part(begin, end)`, which returns what that can be made of.
  template <class Sums, class Part>
  void add_up(ExecutorRef executor, Part& part, Sums& sums) {
    add_up(executor, address_of(part), &write_part<Sums, Part>, sums.data(), sums.size());
  }

  [[nodiscard]] MemoryUse memory() const { return {bytes_of(partial_), 0}; }

  /// Entries a task.
  static constexpr Index grain = 256;

 private:
  struct Job {
    void* part;
    double* partial;
  };

  template <class Sums, class Part>
  static void write_part(void* job, Index begin, Index end) {
    const Sums sums{(*static_cast<Part*>(static_cast<Job*>(job)->part))(begin, end)};
    std::copy(sums.begin(), sums.end(), static_cast<Job*>(job)->partial + at(begin / grain) * sums.size());
  }

  COROTET_NOINLINE void add_up(ExecutorRef executor, void* part, void (*write)(void*, Index, Index), double* sums,
                               std::size_t count) {
    Job job{part, partial_.data()};
    run_ranges(executor, count_, grain, &job, write);
    for (std::size_t k = 0; k < count; ++k) sums[k] = 0;
    for (std::size_t p = 0; p < partial_.size(); p += count)
      for (std::size_t k = 0; k < count; ++k) sums[k] += partial_[p + k];
  }

  Index count_ = 0;
  Scratch<double> partial_;  // the sums of each range
};

/// K sums at once: over ranges of fixed length, each by one task, then over the ranges in order and in double.
template <std::size_t K>
class DeterministicReduction {
 public:
  using Sums = std::array<double, K>;

  DeterministicReduction() = default;
  explicit DeterministicReduction(Index count) : ranges_(count, K) {}

  /// The sums of `part(begin, end)`, which returns Sums, over all ranges.
  template <std::invocable<Index, Index> Part>
  [[nodiscard]] Sums operator()(ExecutorRef executor, Part&& part) {
    Sums sums;
    ranges_.add_up(executor, part, sums);
    return sums;
  }

  [[nodiscard]] MemoryUse memory() const { return ranges_.memory(); }

  /// Entries a task.
  static constexpr Index grain = SumsOfRanges::grain;

 private:
  SumsOfRanges ranges_;
};

}  // namespace detail

/// One sum.
class DeterministicSum {
 public:
  DeterministicSum() = default;
  /// Of a field with so many entries.
  explicit DeterministicSum(Index count) : ranges_(count, 1) {}

  /// The sum of `part(begin, end)`, which returns a double, over all ranges.
  template <std::invocable<Index, Index> Part>
  [[nodiscard]] double operator()(ExecutorRef executor, Part&& part) {
    std::array<double, 1> sum;
    ranges_.add_up(executor, part, sum);
    return sum[0];
  }

  /// Bytes of its own.
  [[nodiscard]] MemoryUse memory() const { return ranges_.memory(); }

  static constexpr Index grain = detail::SumsOfRanges::grain;  ///< entries a task

 private:
  detail::SumsOfRanges ranges_;
};

}  // namespace corotet::inline v0_1
