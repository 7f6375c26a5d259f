// The policy slot "how is the linear system of a step solved", and the concepts around it.
#pragma once

#include <concepts>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>

namespace corotet {

/// What iterative solvers multiply by. Law: linear, symmetric and positive definite; `apply(x, y, executor)` sets
/// y = A x for fields of `rows()` entries and gives the same bits on any executor.
template <class A, class Scalar>
concept LinearOperator = requires(const A& a, const Field<Scalar>& x, Field<Scalar>& y, SerialExecutor& executor) {
  { a.rows() } -> std::convertible_to<Index>;
  a.apply(x, y, executor);
};

/// Approximates the inverse of a matrix. Law: `apply` is linear, symmetric and positive definite.
/// `update(matrix, executor)` takes new values on the pattern that it was made for, without allocating.
template <class P, class Scalar>
concept Preconditioner = requires(const P& p, P& changing, const BlockMatrix<Scalar>& matrix, const Field<Scalar>& r,
                                  Field<Scalar>& z, SerialExecutor& executor) {
  changing.update(matrix, executor);
  p.apply(r, z, executor);
};

/// How a solve ended.
enum class SolveStatus {
  converged,        ///< the residual is below the tolerance
  iteration_limit,  ///< `max_iterations` reached first
  stagnated,        ///< rounding keeps the residual above the tolerance
  invalid_options,  ///< a tolerance or limit outside its range; nothing was solved
  breakdown         ///< the matrix is not positive definite in this precision, or not finite
};

struct SolveReport {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;   ///< of conjugate gradients, or corrections of a direct solution
  double residual = 0;  ///< |b - A x| / |b|, in the norm that the solver names
};

/// Law: after `analyze(pattern)`, which may allocate, any number of `solve(matrix, b, x, executor)` with matrices on
/// that pattern: x holds the solution to the solver's tolerance, or the report says why not; no allocation.
template <class S, class Scalar>
concept LinearSolver = requires(S& s, const BlockMatrix<Scalar>& matrix, const Field<Scalar>& b, Field<Scalar>& x,
                                SerialExecutor& executor) {
  s.analyze(matrix.pattern());
  { s.solve(matrix, b, x, executor) } -> std::same_as<SolveReport>;
};

}  // namespace corotet
