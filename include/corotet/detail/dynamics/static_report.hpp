// How a static solution ended.
#pragma once

#include <corotet/detail/dynamics/step_report.hpp>

namespace corotet::inline v0_1 {

/// How `solve_static` ended.
struct StaticReport {
  bool converged = false;     ///< whether forces balance to the tolerance
  int steps = 0;              ///< of pseudo-time that were accepted
  int newton_iterations = 0;  ///< linear solves in these
  int iterations = 0;         ///< of the linear solver, in all
  double residual = 0;        ///< relative, see StaticOptions::tolerance
  StepReport last;            ///< of the last step: whether it was refused, strain, inverted elements

  /// What to change, in one sentence; "" if the body rests.
  [[nodiscard]] const char* advice() const {
    if (converged) return "";
    if (!last.accepted()) return last.advice();
    return "the body does not come to rest: pin each of its pieces so that it can neither move nor turn, or raise "
           "max_steps";
  }
};

}  // namespace corotet::inline v0_1
