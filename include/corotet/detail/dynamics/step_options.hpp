// How a step solves its nonlinear equation.
#pragma once

#include <corotet/detail/assembly/twist_modes.hpp>

namespace corotet::inline v0_1 {

/// How a step solves its nonlinear equation (docs/theory.md, equations 11 to 17). The defaults suit most scenes.
struct StepOptions {
  /// Linear solves a step, at most, >= 1. One: the force is linearised once (Müller & Gross 2004), which is enough for
  /// most scenes, and costs no search. More: Newton's method with a line search on the incremental energy, until
  /// `tolerance`.
  int iterations = 1;
  /// Stop when the error of the new velocity is `tolerance` times the change of velocity in the step, both in the
  /// energy norm of the step's matrix, 0 < tolerance < 1; or when rounding hides what is left. The error is estimated
  /// from the last correction. The linear solver's tolerance bounds what one iteration can gain.
  double tolerance = 1e-3;
  Tangent tangent = Tangent::stabilized;  ///< which stiffness the equation has
  /// Whether a body without pins keeps its angular momentum exactly and turns without growing, see TurningFrame. If
  /// not, as far as the integrator does.
  bool keeps_angular_momentum = true;
  /// Whether a step with one solve that ends with more energy than the body had, and than forces and pins gave it, is
  /// solved again: by Newton's method, one of Bdf2 by backward Euler. See EnergyBound.
  bool bounds_energy = true;
};

}  // namespace corotet::inline v0_1
