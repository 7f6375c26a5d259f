// How many iterations solves take, as long as the system changes with the motion alone.
#pragma once

#include <corotet/detail/core/state_archive.hpp>
#include <cstdint>
#include <optional>

namespace corotet::inline v0_1::detail {

/// Counts alone, no clock: the same on every machine and in every run.
class IterationWatch {
 public:
  /// True if the system changed for other reasons than motion since the last call (StepSystem::era).
  [[nodiscard]] bool begins(std::uint64_t lag_key) {
    if (lag_key == lag_key_) return false;
    *this = {};
    lag_key_ = lag_key;
    return true;
  }

  /// The mean of the last twelve solves, at every twelfth. The first solves of an era are left out: they have no
  /// solutions to start from.
  [[nodiscard]] std::optional<double> add(int iterations) {
    constexpr int first = 4, window = 12;
    if (++solves_ <= first) return {};
    sum_ += iterations;
    if (solves_ < first + window) return {};
    const double mean = double(sum_) / window;
    solves_ = first;
    sum_ = 0;
    return mean;
  }

  void visit_state(StateArchive& archive) {
    archive(lag_key_);
    archive(solves_);
    archive(sum_);
  }

 private:
  std::uint64_t lag_key_ = 0;  // no system has era 0
  int solves_ = 0, sum_ = 0;
};

}  // namespace corotet::inline v0_1::detail
