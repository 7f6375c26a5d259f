// How long a report may take, and how long a run will.
#pragma once

#include <chrono>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <map>

namespace corotet::program {

/// Learns from each run what an element costs a step, and expects the next to be alike.
class TimeBudget {
 public:
  explicit TimeBudget(double seconds) : seconds_(seconds) {}

  enum class Kind { timed_tet4, timed_tet10, tight_tet4, tight_tet10 };

  [[nodiscard]] static Kind kind(int order, bool tight) {
    if (order == 1) return tight ? Kind::tight_tet4 : Kind::timed_tet4;
    return tight ? Kind::tight_tet10 : Kind::timed_tet10;
  }

  /// s
  [[nodiscard]] double estimate(Kind kind, double elements, double steps) const {
    return rate_.at(kind).seconds * elements * steps;
  }
  void learn(Kind kind, double elements, double steps, double seconds) {
    Rate& rate = rate_[kind];
    if (elements < rate.elements) return;  // small meshes live in cache
    rate = {elements, seconds / (elements * steps)};
  }

  /// s
  [[nodiscard]] double left() const {
    return seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  struct Rate {
    double elements = 0;  // of the largest mesh that it was learnt from
    double seconds = 0;   // an element and step
  };
  double seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  // Before anything is known: an ordinary machine.
  std::map<Kind, Rate> rate_{{Kind::timed_tet4, {0, 3e-7}},
                             {Kind::timed_tet10, {0, 3e-6}},
                             {Kind::tight_tet4, {0, 2e-6}},
                             {Kind::tight_tet10, {0, 1.2e-5}}};
};

}  // namespace corotet::program
