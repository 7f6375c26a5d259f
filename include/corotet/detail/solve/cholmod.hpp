// Opt-in: SuiteSparse's sparse Cholesky as the solver of a step. Link corotet::cholmod. Its supernodal module is GPL.
#pragma once

#include <corotet/detail/core/macros_off.hpp>

#include <Eigen/CholmodSupport>

#include <corotet/detail/core/macros_on.hpp>

#include <algorithm>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/eigen.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/refinement.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <limits>
#include <memory>

namespace corotet::inline v0_1 {

/// How CholmodSolver factors and refines.
struct CholmodOptions {
  double tolerance = 1e-9;  ///< Euclidean residual, relative to |b|; reached by refinement where Scalar allows it
};

/// Supernodal factorisation in double, whatever Scalar is (Chen, Davis, Hager & Rajamanickam 2008). For large, stiff
/// bodies where conjugate gradients need very many iterations. CHOLMOD allocates in every solve, and runs on the
/// threads of the BLAS that it is linked to: the promises of no allocation and of same bits on any number of threads
/// end here.
template <std::floating_point Scalar>
class CholmodSolver {
 public:
  using Options = CholmodOptions;  ///< what it is made with

  CholmodSolver() = default;
  /// Checks nothing: a solve reports options that are out of range.
  explicit CholmodSolver(const Options& options) : options_(options) {}
  /// Shares nothing: CHOLMOD's factors cannot be copied, and the copy does the symbolic work again.
  CholmodSolver(const CholmodSolver& other)
      : options_(other.options_),
        matrix_(other.matrix_),
        right_side_(other.right_side_),
        refinement_(other.refinement_) {
    if (matrix_.rows() > 0) cholmod_->analyzePattern(matrix_);
  }
  CholmodSolver(CholmodSolver&&) noexcept = default;
  /// Copies begin anew: the next solve factors.
  CholmodSolver& operator=(const CholmodSolver& other) {
    if (this != &other) *this = CholmodSolver(other);
    return *this;
  }
  CholmodSolver& operator=(CholmodSolver&&) noexcept = default;
  ~CholmodSolver() = default;

  /// Ordering and symbolic factorisation.
  void analyze(const std::shared_ptr<const BlockPattern>& shared_pattern, const Field<Scalar>& /*rest*/) {
    const BlockPattern& pattern = *shared_pattern;
    COROTET_ASSERT(pattern.blocks() <= (std::numeric_limits<Index>::max)() / 9, "too large for 32-bit indices");
    refinement_ = detail::Refinement<Scalar>(pattern.rows());
    const Index n = 3 * pattern.rows();
    matrix_.resize(n, n);
    matrix_.resizeNonZeros(Eigen::Index{9} * pattern.blocks());
    right_side_.resize(n);
    // Symmetric, so that row i of blocks gives columns 3i, 3i + 1 and 3i + 2.
    Index* start = matrix_.outerIndexPtr();
    Index* row = matrix_.innerIndexPtr();
    for (Index i = 0; i < pattern.rows(); ++i)
      for (int c = 0; c < 3; ++c) {
        *start++ = static_cast<Index>(row - matrix_.innerIndexPtr());
        for (Index k = pattern.row_start[at(i)]; k < pattern.row_start[at(i) + 1]; ++k)
          for (int r = 0; r < 3; ++r) *row++ = 3 * pattern.column[at(k)] + r;
      }
    *start = static_cast<Index>(row - matrix_.innerIndexPtr());
    std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
    cholmod_->analyzePattern(matrix_);
  }

  /// See LinearSolver.
  SolveReport solve(const StepSystem<Scalar>& system, Field<Scalar>& x, ExecutorRef executor) {
    if (system.coupling != nullptr) return {SolveStatus::invalid_options, 0, 1.0};
    const BlockMatrix<Scalar>& matrix = system.matrix;
    double* value = matrix_.valuePtr();
    const BlockPattern& pattern = matrix.pattern();
    for (Index i = 0; i < pattern.rows(); ++i)
      for (int c = 0; c < 3; ++c)
        for (Index k = pattern.row_start[at(i)]; k < pattern.row_start[at(i) + 1]; ++k)
          for (int r = 0; r < 3; ++r) *value++ = static_cast<double>(matrix.block(k)(c, r));
    cholmod_->factorize(matrix_);
    constexpr Eigen::ComputationInfo success{};  // Eigen's own name of it is a macro of X11
    if (cholmod_->info() != success) return {SolveStatus::breakdown, 0, 1.0};
    const auto factor = [this](const Field<Scalar>& residual, Field<Scalar>& y) {
      right_side_ = flat(residual).template cast<double>();
      flat(y) = cholmod_->solve(right_side_).template cast<Scalar>();
    };
    return refinement_.solve(matrix, factor, system.right_side, x, options_.tolerance, executor);
  }

 private:
  Options options_;
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> matrix_;
  // Behind a pointer because Eigen's wrapper cannot be moved, and an integrator takes its solver by value.
  using Factorization = Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double, Eigen::ColMajor, Index>>;
  std::unique_ptr<Factorization> cholmod_ = std::make_unique<Factorization>();
  Eigen::VectorXd right_side_;
  detail::Refinement<Scalar> refinement_;
};

}  // namespace corotet::inline v0_1
