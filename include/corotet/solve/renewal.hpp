// When what was factored once should be factored again.
#pragma once

#include <algorithm>
#include <cstdint>

namespace corotet::inline v0_1 {

/// A preconditioner that follows the body's rotations grows worse as the body strains. It is renewed when the system
/// changes for other reasons than motion (a new era), and when a solve took half as many applications again as the best
/// one did, but then not often: a renewal costs as much as many solves. Counts alone decide, no clock: the same on
/// every machine.
class Renewal {
 public:
  /// Asked once a solve, before it. True if the factorisation shall be made now.
  [[nodiscard]] bool due(std::uint64_t era) {
    const int last = applications_;
    applications_ = 0;
    ++age_;
    const bool first = era_ != era;
    if (!first && last > 0) fewest_ = fewest_ == 0 ? last : (std::min)(fewest_, last);
    const bool worn = age_ >= least_age && last > fewest_ + (std::max)(fewest_ / 2, 4);
    if (!first && !worn) return false;
    era_ = era;
    age_ = 0;
    fewest_ = 0;
    return true;
  }

  /// The factorisation that was due could not be made: it is due again.
  void failed() { era_ = 0; }

  /// Called at each application.
  void count() { ++applications_; }

 private:
  static constexpr int least_age = 50;  // solves

  std::uint64_t era_ = 0;  // no system has era 0
  int age_ = 0, applications_ = 0, fewest_ = 0;
};

}  // namespace corotet::inline v0_1
