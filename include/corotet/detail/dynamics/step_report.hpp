// What a step tells its caller.
#pragma once

#include <algorithm>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <cstdint>

namespace corotet::inline v0_1 {

/// Why a step was refused. A refused step leaves the state as it was.
enum class StepError : std::uint8_t {
  none,              ///< it was accepted
  time_step,         ///< h is not positive and finite
  gravity,           ///< gravity is not finite
  external_force,    ///< the external force on `vertex` is not finite
  pin_target,        ///< the target of pin `vertex` is not finite
  solver_options,    ///< the solver's tolerance or iteration limit is out of range
  newton_options,    ///< the tolerance or iteration limit of Newton's method is out of range
  solver_breakdown,  ///< the matrix is not positive definite, or its entries left the range of the scalar
  overflow,          ///< the new velocity is not finite in this precision
  unreliable         ///< by SubsteppingIntegrator, for the reason in `warning`
};

/// Why SubsteppingIntegrator does not trust a step that the integrator did not refuse.
enum class StepWarning : std::uint8_t {
  none,      ///< it is trusted
  residual,  ///< the linear solve or Newton's method ended far from its solution
  inverted,  ///< elements were turned inside out
  strain     ///< the largest strain has grown too far in one step
};

/// How a step ended. What describes deformation is of the state after the step, and not filled in if the integrator
/// refused it; if SubsteppingIntegrator did, it is of the state that was thrown away.
struct StepReport {
  StepError error = StepError::none;  ///< why the step was refused; none: accepted
  Index vertex = -1;                  ///< the culprit, where `error` names one
  bool converged = true;              ///< each linear solve reached its tolerance
  SolveStatus solve =
      SolveStatus::converged;    ///< how the last linear solve ended that did not converge, or the last at its limit
  int iterations = 0;            ///< of conjugate gradients, or corrections of a direct solution, all solves together
  double residual = 0;           ///< relative residual of the linear solve, the worst
  int newton_iterations = 0;     ///< linear solves
  bool newton_converged = true;  ///< Newton's method reached its tolerance; true after one solve
  double newton_residual = 0;    ///< estimate of the error left, relative, see StepOptions; 0 after one solve
  Index inverted_elements = 0;   ///< elements turned inside out somewhere
  double max_rotation = 0;       ///< of any element against its rest orientation, rad, 0 ... pi
  double max_strain = 0;         ///< of any element, Frobenius norm of sym(R^T F) - I, dimensionless
  StepWarning warning =
      StepWarning::none;  ///< asked only by SubsteppingIntegrator; of sub-steps, the last that was not trusted
  int sub_steps = 1;      ///< that SubsteppingIntegrator divided the step into
  int steps_tried = 1;    ///< by SubsteppingIntegrator, those that were thrown away included

  /// Whether the body has moved: the step was not refused.
  [[nodiscard]] bool accepted() const { return error == StepError::none; }

  /// Accepted, and nothing to complain of.
  [[nodiscard]] bool ok() const {
    return accepted() && converged && newton_converged && inverted_elements == 0 && warning == StepWarning::none;
  }

  /// What to change, in one sentence; "" if all is well. The worst problem only.
  [[nodiscard]] const char* advice() const {
    switch (error) {
      case StepError::time_step:
        return "the time step must be positive and finite";
      case StepError::gravity:
        return "gravity must be finite";
      case StepError::external_force:
        return "the external force on the named vertex must be finite";
      case StepError::pin_target:
        return "the target position of the named pin must be finite";
      case StepError::solver_options:
        return "the solver's tolerance must be between 0 and 1, max_iterations not negative; direct solvers cannot "
               "move "
               "free obstacles";
      case StepError::newton_options:
        return "Newton's tolerance must be between 0 and 1, and its iterations at least 1";
      case StepError::solver_breakdown:
        return "the step's matrix is not positive definite in this precision: use double, a smaller time step, or "
               "better shaped elements";
      case StepError::overflow:
        return "the new state is too large for this precision: use smaller forces or steps";
      case StepError::unreliable:
        return warning_advice();
      case StepError::none:
        break;
    }
    if (solve == SolveStatus::stagnated)
      return "rounding keeps the solver from its tolerance: loosen the tolerance, or use double";
    if (!converged) return "the solver stopped short of its tolerance: raise max_iterations, or loosen the tolerance";
    if (!newton_converged)
      return "Newton's method stopped short of its tolerance: raise its iterations, use the exact tangent, or smaller "
             "steps";
    if (inverted_elements > 0) return "elements are inverted: use smaller steps, gentler pins, or a stiffer material";
    return warning_advice();
  }

 private:
  [[nodiscard]] const char* warning_advice() const {
    switch (warning) {
      case StepWarning::residual:
        return "the solve ended far from its solution: raise its limits, or use smaller steps";
      case StepWarning::inverted:
        return "elements were turned inside out: use smaller steps or gentler pins";
      case StepWarning::strain:
        return "the strain grew too far in one step: use smaller steps or gentler pins";
      case StepWarning::none:
        break;
    }
    return "";
  }
};

namespace detail {

/// The report of two pieces of a body that were stepped at the same time: of counts and residuals the larger, of what
/// went wrong the first.
[[nodiscard]] inline StepReport worse_of(const StepReport& a, const StepReport& b) {
  if (!a.accepted() || !b.accepted()) return a.accepted() ? b : a;
  StepReport all = a;
  all.converged = a.converged && b.converged;
  if (all.solve == SolveStatus::converged) all.solve = b.solve;
  all.iterations = (std::max)(a.iterations, b.iterations);
  all.residual = (std::max)(a.residual, b.residual);
  all.newton_iterations = (std::max)(a.newton_iterations, b.newton_iterations);
  all.newton_converged = a.newton_converged && b.newton_converged;
  all.newton_residual = (std::max)(a.newton_residual, b.newton_residual);
  all.inverted_elements += b.inverted_elements;
  all.max_rotation = (std::max)(a.max_rotation, b.max_rotation);
  all.max_strain = (std::max)(a.max_strain, b.max_strain);
  if (all.warning == StepWarning::none) all.warning = b.warning;
  all.sub_steps = (std::max)(a.sub_steps, b.sub_steps);
  all.steps_tried = (std::max)(a.steps_tried, b.steps_tried);
  return all;
}

}  // namespace detail

}  // namespace corotet::inline v0_1
