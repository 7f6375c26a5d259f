// The policy slot "how is the linear system of a step solved", and the concepts around it.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/step_system.hpp>

namespace corotet::inline v0_1 {

/// Approximates the inverse of a matrix.
/// `analyze(pattern, rest)` does the symbolic work for matrices on a pattern, and may allocate. `rest`: rest positions,
/// m, one a row of the pattern.
/// `update(system, executor)` takes new values on that pattern, without allocating; after a copy it comes first.
/// `apply(r, z, executor)` sets z to P r and returns r . z, without allocating. Law: P is linear, symmetric and
/// positive definite, with the same bits on any number of threads; it returns not-a-number if it cannot be applied.
/// `estimator_delay`: see Pcg.
template <class P, class Scalar>
concept Preconditioner = requires(P& p, const StepSystem<Scalar>& system, const Field<Scalar>& rest,
                                  const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
  p.analyze(system.matrix.shared_pattern(), rest);
  p.update(system, executor);
  { p.apply(r, z, executor) } -> std::same_as<double>;
  { P::estimator_delay } -> std::convertible_to<int>;
};

namespace detail {

/// Refers to a preconditioner of any type, which must outlive it.
template <std::floating_point Scalar>
class PreconditionerRef {
 public:
  /// The largest `estimator_delay` that a preconditioner may ask for.
  static constexpr int max_estimator_delay = 16;

  template <Preconditioner<Scalar> P>
  PreconditionerRef(P& preconditioner)  // NOLINT(google-explicit-constructor): as the preconditioner
      : object_(&preconditioner),
        apply_([](void* object, const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
          return static_cast<P*>(object)->apply(r, z, executor);
        }),
        estimator_delay_(P::estimator_delay) {
    static_assert(P::estimator_delay >= 0 && P::estimator_delay <= max_estimator_delay);
  }

  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) const {
    return apply_(object_, r, z, executor);
  }
  [[nodiscard]] int estimator_delay() const { return estimator_delay_; }

 private:
  void* object_;
  double (*apply_)(void*, const PaddedField<Scalar>&, PaddedField<Scalar>&, ExecutorRef);
  int estimator_delay_;
};

}  // namespace detail

/// How a solve ended.
enum class SolveStatus {
  converged,        ///< the residual is below the tolerance
  iteration_limit,  ///< `max_iterations` reached first
  stagnated,        ///< rounding keeps the residual above the tolerance
  invalid_options,  ///< a tolerance or limit outside its range; nothing was solved
  breakdown         ///< the matrix is not positive definite in this precision, or not finite
};

namespace detail {

/// Whether a tolerance is in its range. (Not a number is asked for first: comparing it may trap.)
[[nodiscard]] inline bool is_tolerance(double tolerance) {
  return std::isfinite(tolerance) && tolerance > 0 && tolerance < 1;
}

}  // namespace detail

/// How a linear solve ended.
struct SolveReport {
  SolveStatus status = SolveStatus::converged;  ///< how it ended
  int iterations = 0;                           ///< of conjugate gradients, or corrections of a direct solution
  double residual = 0;  ///< of the solution returned, relative, in the norm that the solver names
};

/// Law: after `analyze(pattern, rest)`, which may allocate, any number of `solve(system, x, executor)` with matrices on
/// that pattern: x holds the solution to the solver's tolerance, or the report says why not; no allocation. `rest`:
/// rest positions, m, one a row of the pattern.
template <class S, class Scalar>
concept LinearSolver = requires(S& s, const StepSystem<Scalar>& system, const Field<Scalar>& rest, Field<Scalar>& x,
                                ExecutorRef executor) {
  s.analyze(system.matrix.shared_pattern(), rest);
  { s.solve(system, x, executor) } -> std::same_as<SolveReport>;
};

namespace detail {

/// A solver of the same options, as before `analyze` if it knows how.
template <class Solver>
[[nodiscard]] Solver unanalyzed(const Solver& solver) {
  if constexpr (requires {
                  { solver.unanalyzed() } -> std::same_as<Solver>;
                })
    return solver.unanalyzed();
  else
    return solver;
}

}  // namespace detail

}  // namespace corotet::inline v0_1
