// A preconditioner that is ready to be applied, for solves of more than the system that it was made for.
#pragma once

#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <optional>

namespace corotet::inline v0_1::detail {

/// What conjugate gradients over the systems of several bodies need of the solver of each.
template <std::floating_point Scalar>
struct PreparedPreconditioner {
  PreconditionerRef<Scalar> preconditioner;  ///< updated for the matrix as it is now
  double tolerance;                          ///< of the solver: see PcgOptions
  int max_iterations;                        ///< likewise
};

/// That of a solver; empty if it has none.
template <std::floating_point Scalar, class Solver>
[[nodiscard]] std::optional<PreparedPreconditioner<Scalar>> prepare(Solver& solver, const StepSystem<Scalar>& system,
                                                                    ExecutorRef executor) {
  if constexpr (requires { solver.prepare(system, executor); })
    return solver.prepare(system, executor);
  else
    return std::nullopt;
}

}  // namespace corotet::inline v0_1::detail
