// Inner products that give the same bits on any number of threads.
#pragma once

#include <algorithm>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <vector>

namespace corotet {

/// Sums over ranges of fixed length, then over the ranges in order. Accumulates across ranges in double.
class DotProduct {
 public:
  DotProduct() = default;
  explicit DotProduct(Index vertices) : partial_(at((vertices + grain - 1) / grain), 0.0) {}

  template <std::floating_point Scalar, Executor E>
  [[nodiscard]] double operator()(const Field<Scalar>& a, const Field<Scalar>& b, E& executor) {
    for_ranges(executor, size_of(a), grain, [&](Index begin, Index end) {
      const Eigen::Index first = Eigen::Index{3} * begin, length = Eigen::Index{3} * (end - begin);
      partial_[at(begin / grain)] = double(flat(a).segment(first, length).dot(flat(b).segment(first, length)));
    });
    double sum = 0;
    for (const double part : partial_) sum += part;
    return sum;
  }

  /// Vertices a task.
  static constexpr Index grain = 1024;

 private:
  std::vector<double> partial_;
};

}  // namespace corotet
