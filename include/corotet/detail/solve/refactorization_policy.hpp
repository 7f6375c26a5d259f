// When a lagged factor should be made again.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/state_archive.hpp>
#include <cstdint>

namespace corotet::inline v0_1 {

/// Tells a preconditioner when to make its factor again.
///
/// A factor that follows the body's rotations approximates the matrix less well as the body strains. The policy asks
/// for a new one when StepSystem::lag_key changes, and when a solve took half as many applications again as the best
/// one did. That happens seldom, because a factor costs as much as many solves. Counts decide, not a clock: so the same
/// steps refactor on every machine.
class RefactorizationPolicy {
 public:
  /// True if the factor shall be made now. To be called once a solve, before it.
  [[nodiscard]] bool should_refactor(std::uint64_t lag_key) {
    const int last = applications_;
    applications_ = 0;
    ++age_;
    const bool first = lag_key_ != lag_key;
    if (!first && last > 0) fewest_ = fewest_ == 0 ? last : (std::min)(fewest_, last);
    const bool worn = age_ >= min_age && last > fewest_ + (std::max)(fewest_ / 2, 4);
    if (!first && !worn) return false;
    lag_key_ = lag_key;
    age_ = 0;
    fewest_ = 0;
    return true;
  }

  /// The share of its diagonal that is added to the matrix: the next where the one before has no factor. Rounding can
  /// make the matrix of a very stiff body indefinite (Manteuffel 1980, "An incomplete factorization technique for
  /// positive definite linear systems").
  static constexpr std::array<double, 3> shifts{0, 1e-6, 1e-3};

  /// The factor could not be made: the next call asks for it again.
  void failed() { lag_key_ = 0; }

  /// To be called at each application.
  void count() { ++applications_; }

  /// For snapshots.
  void visit_state(detail::StateArchive& archive) {
    archive(lag_key_);
    archive(age_);
    archive(applications_);
    archive(fewest_);
  }

 private:
  static constexpr int min_age = 50;  // solves

  std::uint64_t lag_key_ = 0;  // no system has this one
  int age_ = 0, applications_ = 0, fewest_ = 0;
};

}  // namespace corotet::inline v0_1
