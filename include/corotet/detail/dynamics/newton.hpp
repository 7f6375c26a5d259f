// Newton's method with a line search on an energy.
#pragma once

#include <algorithm>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/dynamics/line_search.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/solve/solver.hpp>

namespace corotet::inline v0_1::detail {

/// A stationary point that Newton's method looks for, of an energy Phi (J) whose gradient at the iterate is g and whose
/// tangent is A. All refer to the problem's own iterate.
template <class P>
concept NewtonProblem = requires(P& problem, double fraction, bool first) {
  problem.linearize(first);                                    // A and g, for the next correction
  { problem.solve() } -> std::same_as<SolveStatus>;            // A d = -g
  { problem.decrement2() } -> std::convertible_to<double>;     // -g . d
  { problem.gradient_norm() } -> std::convertible_to<double>;  // any norm, the same each time
  { problem.project_tangent(first) } -> std::same_as<bool>;    // makes A semi-definite; false: it is, or cannot
  { problem.noise() } -> std::convertible_to<double>;          // what rounding may add to Phi, J
  { problem.rounding() } -> std::convertible_to<double>;       // of iterates, in the norm of A: sqrt(J)
  { problem.search(fraction, fraction) } -> std::convertible_to<double>;  // the fraction of d that lowers Phi, 0 ... 1
  { problem.apply(fraction) } -> std::same_as<bool>;                      // goes there; false: not finite
  problem.evaluate();                                                     // g at the new iterate
};

/// How Newton's method ended.
struct NewtonResult {
  SolveStatus solve =
      SolveStatus::converged;  ///< the last linear solve that did not converge, or the last at its limit
  bool all_solved = true;      ///< each linear solve reached its tolerance
  bool finite = true;
  int iterations = 0;
  bool converged = true;  ///< true after one iteration that was all that was asked for
  double residual = 0;    ///< estimate of the error left, relative to the first correction; 0 after one iteration
};

/// Corrects the iterate of `problem` until the error, in the norm of the tangent, is `tolerance` times the first
/// correction (see StepOptions), or rounding hides what is left; or `max_iterations` times. The error is estimated
/// from the last correction and the gradient before and after it (Deuflhard 2011, section 2.1). With max_iterations = 1
/// the correction is taken as it is. `searches`: whether the energy decides how far to go, from the second on.
template <NewtonProblem Problem>
[[nodiscard]] COROTET_COLD NewtonResult newton_solve(Problem& problem, int max_iterations, double tolerance,
                                                     bool searches) {
  NewtonResult result;
  const bool iterates = max_iterations > 1;
  double first_size = 0, last_decrement2 = 0;
  while (true) {
    const bool first = result.iterations == 0;
    problem.linearize(first);
    const SolveStatus status = problem.solve();
    const double decrement2 = iterates ? problem.decrement2() : 0;
    if ((status == SolveStatus::breakdown || decrement2 < 0) && problem.project_tangent(first)) continue;
    if (status != SolveStatus::converged && result.solve != SolveStatus::iteration_limit) result.solve = status;
    if (status == SolveStatus::breakdown || status == SolveStatus::invalid_options) return result;
    ++result.iterations;
    result.all_solved = result.all_solved && status == SolveStatus::converged;

    const double gradient = iterates ? problem.gradient_norm() : 0;
    // Of a change that is but rounding, the decrement may be negative.
    const double size = detail::square_root((std::max)(0.0, decrement2));
    if (first) first_size = size;
    double fraction = 1;
    bool rounding_hides = false;
    if (iterates && !first && searches) {  // the first iterate may not fulfil what is prescribed
      const double noise = problem.noise();
      rounding_hides = decrement2 <= problem.rounding() * problem.rounding() ||
                       (decrement2 <= noise && decrement2 > 0.8 * last_decrement2);
      fraction = problem.search(decrement2, noise);
    }
    result.finite = problem.apply(fraction);
    if (!iterates || !result.finite) return result;

    problem.evaluate();
    // What a correction of this size leaves if the error has shrunk as the gradient has.
    const double shrunk = gradient > 0 ? (std::min)(1.0, problem.gradient_norm() / gradient) : 0.0;
    const double error = size * shrunk;
    result.residual = first_size > 0 ? error / first_size : 0;
    result.converged = detail::exactly_equal(fraction, 1.0) && (error <= tolerance * first_size || rounding_hides);
    last_decrement2 = decrement2;
    if (result.converged || detail::is_zero(fraction) || result.iterations >= max_iterations) return result;
  }
}

}  // namespace corotet::inline v0_1::detail
