// How the steps of a run ended, counted.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_report.hpp>

namespace corotet::program {

/// Of accepted steps, unless it says otherwise.
struct StepCounts {
  Index accepted = 0;
  Index refused = 0;
  Index unconverged = 0;         ///< whose linear solver stopped before its tolerance, and said so
  Index at_iteration_limit = 0;  ///< of these, stopped by the limit of iterations
  Index newton_unconverged = 0;  ///< the same of Newton's method
  Index unreliable = 0;          ///< with a warning
  Index inverted = 0;            ///< that ended with inverted elements
  int max_iterations = 0;        ///< of the linear solver in a step

  void add(const StepReport& report) {
    if (!report.accepted()) {
      ++refused;
      return;
    }
    ++accepted;
    unconverged += report.converged ? 0 : 1;
    at_iteration_limit += report.solve == SolveStatus::iteration_limit ? 1 : 0;
    newton_unconverged += report.newton_converged ? 0 : 1;
    unreliable += report.warning == StepWarning::none ? 0 : 1;
    inverted += report.inverted_elements > 0 ? 1 : 0;
    max_iterations = std::max(max_iterations, report.iterations);
  }

  void add(const StepCounts& other) {
    accepted += other.accepted;
    refused += other.refused;
    unconverged += other.unconverged;
    at_iteration_limit += other.at_iteration_limit;
    newton_unconverged += other.newton_unconverged;
    unreliable += other.unreliable;
    inverted += other.inverted;
    max_iterations = std::max(max_iterations, other.max_iterations);
  }
};

}  // namespace corotet::program
