// The policy slot "how is the linear system of a step solved", and the concepts around it.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/core/executor.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/step_system.hpp>

namespace corotet {

/// Approximates the inverse of a matrix. Law: `apply` is linear, symmetric and positive definite, and returns r . z.
/// `error_delay`: see Pcg.
/// `update(system, executor)` takes new values on the pattern that it was made for, without allocating.
template <class P, class Scalar>
concept Preconditioner = requires(P& p, const StepSystem<Scalar>& system, const PaddedField<Scalar>& r,
                                  PaddedField<Scalar>& z, SerialExecutor& executor) {
  p.update(system, executor);
  { p.apply(r, z, executor) } -> std::same_as<double>;
  { P::error_delay } -> std::convertible_to<int>;
};

/// How a solve ended.
enum class SolveStatus {
  converged,        ///< the residual is below the tolerance
  iteration_limit,  ///< `max_iterations` reached first
  stagnated,        ///< rounding keeps the residual above the tolerance
  invalid_options,  ///< a tolerance or limit outside its range; nothing was solved
  breakdown         ///< the matrix is not positive definite in this precision, or not finite
};

/// Whether a tolerance is in its range. (Not a number is asked for first: comparing it may trap.)
[[nodiscard]] inline bool is_tolerance(double tolerance) {
  return std::isfinite(tolerance) && tolerance > 0 && tolerance < 1;
}

struct SolveReport {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;   ///< of conjugate gradients, or corrections of a direct solution
  double residual = 0;  ///< of the solution returned, relative, in the norm that the solver names
};

/// Law: after `analyze(pattern, rest)`, which may allocate, any number of `solve(system, x, executor)` with matrices on
/// that pattern: x holds the solution to the solver's tolerance, or the report says why not; no allocation. `rest`:
/// rest positions, m, one a row of the pattern.
template <class S, class Scalar>
concept LinearSolver = requires(S& s, const StepSystem<Scalar>& system, const Field<Scalar>& rest, Field<Scalar>& x,
                                SerialExecutor& executor) {
  s.analyze(system.matrix.shared_pattern(), rest);
  { s.solve(system, x, executor) } -> std::same_as<SolveReport>;
};

}  // namespace corotet
