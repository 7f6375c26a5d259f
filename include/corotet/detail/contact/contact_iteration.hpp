// What passes over contacts do with all of them: judging phases, and letting multipliers follow.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A body's springs together are at most so many times its mass: the error of the linear solve would move stiffer ones.
inline constexpr double spring_mass_ratio = 1000;
/// Of the points' extent: deeper, multipliers follow in the step.
inline constexpr double deep_share = 1e-3;
/// From this pass on, friction keeps its limits, so that passes converge.
inline constexpr int last_free_revision = 6;

/// Takes the phases that hold at the solution evaluated last, whose error is at most `error` in the energy norm,
/// sqrt(J) sqrt(s). True if one has changed. Impulses count against those of the same obstacle: what a light one bears
/// is little beside what carries the body.
template <std::derived_from<PointContact> Contact>
[[nodiscard]] bool judge(std::vector<Contact>& contacts, double error, bool keeps_limits) {
  constexpr double negligible = 1e-2;   // of the largest impulse
  constexpr double error_share = 0.03;  // of the solution's error that reaches one contact
  constexpr double tangential = 1e-3;
  const double noise = error_share * error;
  bool changed = false;
  for (auto first = contacts.begin(); first != contacts.end();) {
    auto last = first;
    double largest = 0;
    for (; last != contacts.end() && last->obstacle == first->obstacle; ++last)
      largest = (std::max)(largest, last->normal_trial);
    for (; first != last; ++first)
      changed = first->judge((std::max)(negligible * largest, noise * square_root(first->kappa)),
                             (std::max)(tangential * negligible * largest, noise * square_root(first->kappa_t)),
                             keeps_limits) ||
                changed;
  }
  return changed;
}

/// Lets multipliers follow forces in the same step (method of multipliers), a few times: where points end far deeper
/// than they were, by more than `deep` (m), and where pressure moves on, as under a ball that rolls. There the
/// multipliers of the last step lag behind it, and would drive the ball. An impact, where all forces are new, is left
/// to the springs.
class Augmentations {
 public:
  /// At each linearisation.
  void begin() { count_ = 0; }

  /// True if multipliers have changed.
  template <std::derived_from<PointContact> Contact>
  [[nodiscard]] bool augment(std::vector<Contact>& contacts, double gamma, double deep) {
    constexpr int most = 3;
    constexpr double least_change = 0.02, most_change = 0.25;  // of all forces
    if (count_ == most) return false;
    double change = 0, all = 0;
    bool is_deep = false;
    for (const Contact& contact : contacts) {
      const double force = (std::max)(0.0, contact.normal_trial) / gamma;
      change += std::fabs(force - contact.multiplier);
      all += (std::max)(force, contact.multiplier);
      is_deep = is_deep || contact.depth(gamma) > deep;
    }
    const bool moves_on = change > least_change * all && change < most_change * all;
    if (!is_deep && !moves_on) return false;
    for (Contact& contact : contacts) contact.augment(gamma);
    ++count_;
    return true;
  }

 private:
  int count_ = 0;
};

}  // namespace corotet::inline v0_1::detail
