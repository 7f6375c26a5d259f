// The default solver of a step: conjugate gradients, or a direct factorisation where that is cheaper.
#pragma once

#include <algorithm>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/deep_pointer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/shared.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/block_cholesky.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/iteration_watch.hpp>
#include <corotet/detail/solve/pcg.hpp>
#include <corotet/detail/solve/prepared_preconditioner.hpp>
#include <corotet/detail/solve/refinement.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/solve_cost.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

namespace corotet::inline v0_1 {

/// How AutoSolver solves.
enum class SolverMethod {
  automatic,  ///< by predicted cost
  pcg,        ///< conjugate gradients
  cholesky    ///< a factorisation of the matrix in each step
};
/// The preconditioner of conjugate gradients.
enum class PreconditionerKind {
  automatic,         ///< by predicted cost
  jacobi,            ///< the inverse of the diagonal
  block_jacobi,      ///< the inverses of the 3x3 blocks on the diagonal
  rigid_aggregates,  ///< block-Jacobi and the rigid motions of groups of vertices: RigidAggregates
  warped_cholesky    ///< a factor of an earlier matrix that turns with the body: WarpedCholesky
};

/// As in a scene file: "jacobi", ...; "auto" for automatic.
[[nodiscard]] constexpr std::string_view name_of(PreconditionerKind kind) {
  switch (kind) {
    case PreconditionerKind::jacobi:
      return "jacobi";
    case PreconditionerKind::block_jacobi:
      return "block_jacobi";
    case PreconditionerKind::rigid_aggregates:
      return "rigid_aggregates";
    case PreconditionerKind::warped_cholesky:
      return "warped_cholesky";
    case PreconditionerKind::automatic:
      break;
  }
  return "auto";
}

/// How the linear systems of a step are solved. The defaults suit most scenes.
/// @snippet steps.cpp solver
struct SolverOptions {
  SolverMethod method = SolverMethod::automatic;                      ///< iterative, direct, or as the system asks
  PreconditionerKind preconditioner = PreconditionerKind::automatic;  ///< of the iterative method
  double tolerance = 1e-3;    ///< relative residual, 0 < tolerance < 1, see PcgOptions
  int max_iterations = 2000;  ///< of PCG, >= 0
};

/// The default solver: conjugate gradients, whose preconditioner it chooses by predicted cost.
///
/// Name another (PcgSolver, CholmodSolver) only to compare, or to add your own.
/// @snippet steps.cpp solver
/// It chooses rigid aggregates to begin with, and for a small body a factor of the whole,
/// as soon as a dozen solves took so many iterations that it would be cheaper: when the body is stiff. See
/// `preconditioner()` for the choice; all memory is there after `analyze`. A factor too large for 32-bit indices is
/// never chosen, not even when asked for. Copies share all that follows from the pattern and the rest configuration.
template <std::floating_point Scalar>
class AutoSolver {
 public:
  using Options = SolverOptions;  ///< what it is made with

  /// Checks nothing: a solve reports options that are out of range.
  explicit AutoSolver(const Options& options = {});
  /// Copies share the symbolic part.
  AutoSolver(const AutoSolver&);
  AutoSolver(AutoSolver&&) noexcept;
  AutoSolver& operator=(const AutoSolver&);
  AutoSolver& operator=(AutoSolver&&) noexcept;
  ~AutoSolver();

  /// Symbolic work and memory for matrices on this pattern.
  COROTET_COLD void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest);

  /// Solves to `options().tolerance`: an error in the energy norm as Pcg knows it, or a Euclidean residual (Cholesky,
  /// refined where one substitution is not enough).
  COROTET_COLD SolveReport solve(const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor);

  /// The preconditioner in use, for the matrix as it is now; empty if there is none.
  [[nodiscard]] COROTET_COLD std::optional<detail::PreparedPreconditioner<Scalar>> prepare(
      const StepSystem<Scalar>& system, ExecutorRef executor);

  /// What is used now.
  [[nodiscard]] SolverMethod method() const { return method_; }
  /// The preconditioner in use.
  [[nodiscard]] PreconditionerKind preconditioner() const { return preconditioner_; }

  /// What a solve with it should cost, in products: see SolveCost. 0 where nothing is predicted.
  [[nodiscard]] double predicted_products() const { return predicted_products_; }

  /// What it was made with.
  [[nodiscard]] const Options& options() const { return options_; }

  /// One of the same options, as before `analyze`: cheaper to compile than a copy.
  [[nodiscard]] AutoSolver unanalyzed() const { return AutoSolver(options_); }

  /// Bytes of its own, and those that copies share.
  [[nodiscard]] COROTET_COLD MemoryUse memory() const;

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive);

 private:
  template <class P>
  SolveReport solve_by(P& preconditioner, const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor) {
    preconditioner.update(system, executor);
    return methods_->pcg.solve(system, preconditioner, x, {options_.tolerance, options_.max_iterations}, executor);
  }

  COROTET_COLD SolveReport solve_directly(const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor);

  /// Whether the factor of the whole body would have been cheaper than solves of so many iterations.
  COROTET_COLD void compare(std::optional<double> iterations);

  COROTET_COLD void choose_preconditioner(const std::shared_ptr<const BlockPattern>& pattern,
                                          const Field<Scalar>& rest);

  // The factor of a larger body takes many times the memory of its matrix, and rarely pays.
  static constexpr Index max_vertices_of_a_small_body = 2000;
  // Size of the factor in double, to that of the matrix: more is not reserved for a choice that may never be made, and
  // a factor of so many blocks seldom pays.
  static constexpr double max_factor_memory = 2.5;

  Options options_;
  SolverMethod method_ = SolverMethod::pcg;
  PreconditionerKind preconditioner_ = PreconditionerKind::block_jacobi;
  detail::SolveCost cost_;
  double predicted_products_ = 0, warped_products_ = std::numeric_limits<double>::infinity();
  bool may_change_ = false;
  detail::IterationWatch watch_;
  /// What the methods work with; empty where a method is not used.
  struct Methods {
    Pcg<Scalar> pcg;
    BlockJacobi<Scalar> diagonal;
    RigidAggregates<Scalar> rigid;
    WarpedCholesky<Scalar> warped;
    BlockCholesky<Scalar> cholesky;
    detail::Refinement<Scalar> refinement;
  };
  detail::DeepPointer<Methods> methods_;
};

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <std::floating_point Scalar>
AutoSolver<Scalar>::AutoSolver(const Options& options) : options_(options) {}
template <std::floating_point Scalar>
AutoSolver<Scalar>::AutoSolver(const AutoSolver&) = default;
template <std::floating_point Scalar>
AutoSolver<Scalar>::AutoSolver(AutoSolver&&) noexcept = default;
template <std::floating_point Scalar>
AutoSolver<Scalar>& AutoSolver<Scalar>::operator=(const AutoSolver&) = default;
template <std::floating_point Scalar>
AutoSolver<Scalar>& AutoSolver<Scalar>::operator=(AutoSolver&&) noexcept = default;
template <std::floating_point Scalar>
AutoSolver<Scalar>::~AutoSolver() = default;

template <std::floating_point Scalar>
void AutoSolver<Scalar>::analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& rest) {
  *this = AutoSolver(options_);
  method_ = options_.method == SolverMethod::automatic ? SolverMethod::pcg : options_.method;
  if (method_ == SolverMethod::cholesky) {
    methods_->cholesky.analyze(*pattern);
    if (methods_->cholesky.is_ready()) {
      methods_->refinement = detail::Refinement<Scalar>(pattern->rows());
      return;
    }
    method_ = SolverMethod::pcg;
    methods_->cholesky = {};
  }
  methods_->pcg = Pcg<Scalar>(pattern->rows());
  choose_preconditioner(pattern, rest);
}

template <std::floating_point Scalar>
void AutoSolver<Scalar>::choose_preconditioner(const std::shared_ptr<const BlockPattern>& pattern,
                                               const Field<Scalar>& rest) {
  using enum PreconditionerKind;
  const Index vertices = pattern->rows();
  cost_ = detail::SolveCost(pattern->blocks(), vertices);
  preconditioner_ = options_.preconditioner;
  if (preconditioner_ == jacobi || preconditioner_ == block_jacobi) {
    methods_->diagonal = BlockJacobi<Scalar>(preconditioner_ == block_jacobi);
    methods_->diagonal.analyze(pattern, rest);
    return;
  }
  detail::Shared<detail::SymbolicFactor> symbolic;
  if (preconditioner_ == warped_cholesky ||
      (preconditioner_ == automatic && vertices <= max_vertices_of_a_small_body)) {
    symbolic = detail::Shared<detail::SymbolicFactor>::make(*pattern);
    if (symbolic->fits()) warped_products_ = cost_.warped_cholesky(double(symbolic->blocks));
  }
  if (preconditioner_ == warped_cholesky && symbolic->fits()) {
    predicted_products_ = warped_products_;
    methods_->warped.analyze(pattern, rest, symbolic);
    return;
  }
  methods_->rigid.analyze(pattern, rest);
  predicted_products_ = cost_.rigid_aggregates(double(methods_->rigid.factor_blocks()));
  constexpr double max_iterations = 25;
  may_change_ =
      preconditioner_ == automatic &&
      warped_products_ < cost_.rigid_aggregates(double(methods_->rigid.factor_blocks()), max_iterations) &&
      double(symbolic->blocks) * sizeof(double) < max_factor_memory * double(pattern->blocks()) * sizeof(Scalar);
  preconditioner_ = rigid_aggregates;
  if (may_change_) methods_->warped.analyze(pattern, rest, symbolic);
}

template <std::floating_point Scalar>
void AutoSolver<Scalar>::visit_state(detail::StateArchive& archive) {
  archive.expect(static_cast<std::uint64_t>(method_));
  archive(preconditioner_);
  archive(predicted_products_);
  watch_.visit_state(archive);
  methods_->pcg.visit_state(archive);
  methods_->rigid.visit_state(archive);
  methods_->warped.visit_state(archive);
}

template <std::floating_point Scalar>
MemoryUse AutoSolver<Scalar>::memory() const {
  const Methods& p = *methods_;
  return MemoryUse{sizeof(Methods), 0} + p.pcg.memory() + p.diagonal.memory() + p.rigid.memory() + p.warped.memory() +
         p.cholesky.memory() + p.refinement.memory();
}

template <std::floating_point Scalar>
SolveReport AutoSolver<Scalar>::solve(const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor) {
  if (method_ == SolverMethod::cholesky) return solve_directly(system, x, executor);
  if (may_change_ && watch_.begins(system.lag_key)) preconditioner_ = PreconditionerKind::rigid_aggregates;
  if (preconditioner_ == PreconditionerKind::warped_cholesky) return solve_by(methods_->warped, system, x, executor);
  if (preconditioner_ == PreconditionerKind::rigid_aggregates) {
    const SolveReport report = solve_by(methods_->rigid, system, x, executor);
    if (may_change_) compare(watch_.add(report.iterations));
    return report;
  }
  return solve_by(methods_->diagonal, system, x, executor);
}

template <std::floating_point Scalar>
std::optional<detail::PreparedPreconditioner<Scalar>> AutoSolver<Scalar>::prepare(const StepSystem<Scalar>& system,
                                                                                  ExecutorRef executor) {
  const auto prepared = [&](auto& preconditioner) {
    preconditioner.update(system, executor);
    return detail::PreparedPreconditioner<Scalar>{preconditioner, options_.tolerance, options_.max_iterations};
  };
  if (method_ == SolverMethod::cholesky) return std::nullopt;
  if (preconditioner_ == PreconditionerKind::warped_cholesky) return prepared(methods_->warped);
  if (preconditioner_ == PreconditionerKind::rigid_aggregates) return prepared(methods_->rigid);
  return prepared(methods_->diagonal);
}

template <std::floating_point Scalar>
SolveReport AutoSolver<Scalar>::solve_directly(const StepSystem<Scalar>& system, Field<Scalar>& x,
                                               ExecutorRef executor) {
  std::fill(x.begin(), x.end(), Vec3<Scalar>::Zero());
  if (!detail::is_tolerance(options_.tolerance) || system.coupling != nullptr)
    return {SolveStatus::invalid_options, 0, 1.0};
  if (!methods_->cholesky.factorize(system.matrix)) return {SolveStatus::breakdown, 0, 1.0};
  const auto factor = [this](const Field<Scalar>& r, Field<Scalar>& y) { methods_->cholesky.solve(r, y); };
  return methods_->refinement.solve(system.matrix, factor, system.right_side, x, options_.tolerance, executor);
}

template <std::floating_point Scalar>
void AutoSolver<Scalar>::compare(std::optional<double> iterations) {
  if (!iterations) return;
  predicted_products_ = cost_.rigid_aggregates(double(methods_->rigid.factor_blocks()), *iterations);
  if (warped_products_ >= predicted_products_) return;
  predicted_products_ = warped_products_;
  preconditioner_ = PreconditionerKind::warped_cholesky;
}

COROTET_INSTANCES_OF_SCALAR(AutoSolver)

}  // namespace corotet::inline v0_1
