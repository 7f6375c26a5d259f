// The default solver of a step: conjugate gradients, or a direct factorisation where that is cheaper.
#pragma once

#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/pcg.hpp>
#include <corotet/solve/refinement.hpp>
#include <corotet/solve/solver.hpp>

namespace corotet {

enum class SolverMethod { automatic, pcg, cholesky };
enum class PreconditionerKind { automatic, jacobi, block_jacobi };

struct SolverOptions {
  SolverMethod method = SolverMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  double tolerance = 1e-3;    ///< relative residual, 0 < tolerance < 1, see PcgOptions
  int max_iterations = 2000;  ///< of PCG, >= 0
};

/// Chooses once, in `analyze`, by counting operations; see `method()` for the choice. A factor too large for 32-bit
/// indices is never chosen, not even when asked for.
template <std::floating_point Scalar>
class AutoSolver {
 public:
  using Options = SolverOptions;

  AutoSolver() = default;
  explicit AutoSolver(const Options& options) : options_(options) {}

  /// Symbolic work and memory for matrices on this pattern.
  void analyze(const BlockPattern& pattern) {
    method_ = options_.method;
    if (method_ != SolverMethod::pcg) {
      cholesky_.analyze(pattern);
      if (method_ == SolverMethod::automatic) method_ = cheaper_method(pattern);
      if (!cholesky_.fits()) method_ = SolverMethod::pcg;
    }
    preconditioner_ = options_.preconditioner == PreconditionerKind::automatic ? PreconditionerKind::block_jacobi
                                                                               : options_.preconditioner;
    if (method_ == SolverMethod::cholesky) {
      cholesky_.allocate();
      refinement_ = Refinement<Scalar>(pattern.rows());
      return;
    }
    cholesky_ = {};
    pcg_ = Pcg<Scalar>(pattern.rows());
    if (preconditioner_ == PreconditionerKind::jacobi)
      jacobi_ = Jacobi<Scalar>(pattern);
    else
      block_jacobi_ = BlockJacobi<Scalar>(pattern);
  }

  /// Solves A x = b from x = 0, to `options().tolerance` in the residual: measured by the preconditioner (PCG), or
  /// Euclidean (Cholesky, refined where one substitution is not enough).
  template <Executor E>
  SolveReport solve(const BlockMatrix<Scalar>& matrix, const Field<Scalar>& b, Field<Scalar>& x, E& executor) {
    if (method_ == SolverMethod::cholesky) {
      if (!(options_.tolerance > 0 && options_.tolerance < 1)) return {SolveStatus::invalid_options, 0, 1.0};
      if (!cholesky_.factorize(matrix)) return {SolveStatus::breakdown, 0, 1.0};
      const auto factor = [this](const Field<Scalar>& r, Field<Scalar>& y) { cholesky_.solve(r, y); };
      return refinement_.solve(matrix, factor, b, x, options_.tolerance, executor);
    }
    const PcgOptions options{options_.tolerance, options_.max_iterations};
    if (preconditioner_ == PreconditionerKind::jacobi) {
      jacobi_.update(matrix, executor);
      return pcg_.solve(matrix, jacobi_, b, x, options, executor);
    }
    block_jacobi_.update(matrix, executor);
    return pcg_.solve(matrix, block_jacobi_, b, x, options, executor);
  }

  /// What `analyze` chose.
  [[nodiscard]] SolverMethod method() const { return method_; }
  [[nodiscard]] PreconditionerKind preconditioner() const { return preconditioner_; }

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  [[nodiscard]] SolverMethod cheaper_method(const BlockPattern& pattern) const {
    const double product = 18.0 * pattern.blocks();
    const double direct = cholesky_.factor_flops() + 4 * 18.0 * double(cholesky_.factor_blocks());
    return direct < expected_iterations * product ? SolverMethod::cholesky : SolverMethod::pcg;
  }

  // Iterations of block-Jacobi PCG to 1e-3 on bodies small enough for the question to arise (E = 5e5 Pa, h = 1/60 s).
  static constexpr double expected_iterations = 70;

  Options options_;
  SolverMethod method_ = SolverMethod::pcg;
  PreconditionerKind preconditioner_ = PreconditionerKind::block_jacobi;
  Pcg<Scalar> pcg_;
  Jacobi<Scalar> jacobi_;
  BlockJacobi<Scalar> block_jacobi_;
  BlockCholesky<Scalar> cholesky_;
  Refinement<Scalar> refinement_;
};

static_assert(LinearSolver<AutoSolver<float>, float> && LinearSolver<AutoSolver<double>, double>);

}  // namespace corotet
