// Conjugate gradients with one preconditioner, as the solver of a step.
#pragma once

#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/pcg.hpp>
#include <corotet/detail/solve/prepared_preconditioner.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <memory>
#include <utility>

namespace corotet::inline v0_1 {

/// The LinearSolver of a Preconditioner: `ImplicitEuler<Body, PcgSolver<BlockJacobi<float>>>`, or one of your own
/// (docs/architecture.md, "How to add a preconditioner").
template <class P, std::floating_point Scalar = typename P::scalar_type>
  requires Preconditioner<P, Scalar>
class PcgSolver {
 public:
  using Options = PcgOptions;  ///< what it is made with

  /// Takes the preconditioner as it is; `analyze` prepares it.
  explicit PcgSolver(const Options& options = {}, P preconditioner = P())
      : options_(options), preconditioner_(std::move(preconditioner)) {}

  /// See LinearSolver.
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
    pcg_ = Pcg<Scalar>(pattern->rows());
    preconditioner_.analyze(pattern, rest);
  }

  /// See LinearSolver.
  SolveReport solve(const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor) {
    preconditioner_.update(system, executor);
    return pcg_.solve(system, preconditioner_, x, options_, executor);
  }

  /// See AutoSolver::prepare.
  [[nodiscard]] std::optional<detail::PreparedPreconditioner<Scalar>> prepare(const StepSystem<Scalar>& system,
                                                                              ExecutorRef executor) {
    preconditioner_.update(system, executor);
    return detail::PreparedPreconditioner<Scalar>{preconditioner_, options_.tolerance, options_.max_iterations};
  }

  /// What it was made with.
  [[nodiscard]] const Options& options() const { return options_; }
  /// The preconditioner in use.
  [[nodiscard]] const P& preconditioner() const { return preconditioner_; }

  /// For snapshots: with the preconditioner's state, if it has one.
  COROTET_COLD void visit_state(detail::StateArchive& archive) {
    pcg_.visit_state(archive);
    if constexpr (requires { preconditioner_.visit_state(archive); }) preconditioner_.visit_state(archive);
  }

  /// Bytes of its own and of the preconditioner, and those that copies share.
  [[nodiscard]] MemoryUse memory() const
    requires requires(const P& p) {
      { p.memory() } -> std::same_as<MemoryUse>;
    }
  {
    return pcg_.memory() + preconditioner_.memory();
  }

 private:
  Options options_;
  Pcg<Scalar> pcg_;
  P preconditioner_;
};

}  // namespace corotet::inline v0_1
