// Medians of repeated measurements.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>
#include <vector>

namespace corotet::program {

/// The median of `values`, which must not be empty; the upper one of two.
[[nodiscard]] inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median time of `work()`, us: of 11 to 1001 calls, for some 50 ms.
template <class Work>
[[nodiscard]] double median_us(Work&& work) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> samples;
  const Clock::time_point start = Clock::now();
  while (samples.size() < 11 || (samples.size() < 1001 && Clock::now() - start < std::chrono::milliseconds(50))) {
    const Clock::time_point begin = Clock::now();
    work();
    samples.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  return median_of(std::move(samples));
}

}  // namespace corotet::program
