// When what was learnt of a step's matrix no longer holds.
#pragma once

#include <cmath>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <cstdint>

namespace corotet::inline v0_1::detail {

/// Numbers the eras in which a step's matrix changes with the displacement alone, or nearly so: what a preconditioner
/// has factored serves until the next. Steps whose length varies from frame to frame are one era as long as they differ
/// little: a factor that is off by a quarter costs an iteration or two, making it anew costs as much as a step.
class LagKey {
 public:
  /// What the matrix depends on besides the displacement: that of `matrix = mass_factor * M + stiffness_factor * K'`,
  /// and the revisions of materials and pins.
  struct Settings {
    double mass_factor = 0, stiffness_factor = 0;
    Revision materials, pins;
  };

  /// The era of a step with these settings: 1, 2, ...
  [[nodiscard]] std::uint64_t of(const Settings& now) {
    const bool same = lag_key_ > 0 && now.materials == begin_.materials && now.pins == begin_.pins &&
                      is_near(now.mass_factor, begin_.mass_factor) &&
                      is_near(now.stiffness_factor, begin_.stiffness_factor);
    if (!same) {
      begin_ = now;
      ++lag_key_;
    }
    return lag_key_;
  }

  /// For snapshots. `now`: the present revisions, in place of those of the state that is read.
  void visit_state(StateArchive& archive, const Revision& materials, const Revision& pins) {
    archive(lag_key_);
    archive(begin_.mass_factor);
    archive(begin_.stiffness_factor);
    visit_revision(archive, begin_.materials, materials);
    visit_revision(archive, begin_.pins, pins);
  }

 private:
  [[nodiscard]] static bool is_near(double a, double b) { return std::fabs(a - b) <= 0.25 * b; }

  Settings begin_;  // of the first step of this era
  std::uint64_t lag_key_ = 0;
};

}  // namespace corotet::inline v0_1::detail
