// Iterative refinement: turns a factorisation, rounded as it is, into a solution whose residual is known.
#pragma once

#include <cmath>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/solver.hpp>

namespace corotet::inline v0_1::detail {

/// Solves with a factorisation of the matrix, measures the residual, and corrects until it is small enough. Keeps its
/// vectors between solves. (Golub & Van Loan 2013, section 3.5.3.)
template <std::floating_point Scalar>
class Refinement {
 public:
  Refinement() = default;
  explicit Refinement(Index vertices)
      : residual_(at(vertices), Vec3<Scalar>::Zero()), correction_(residual_), sum_(vertices) {}

  /// Solves A x = b by `factor(r, y)`, which sets y to nearly A^-1 r, to a Euclidean residual of `tolerance` * |b|.
  /// Each correction counts as an iteration. Ends as breakdown if a residual is not finite.
  template <class Factor>
  COROTET_COLD SolveReport solve(const BlockMatrix<Scalar>& matrix, Factor&& factor, const Field<Scalar>& b,
                                 Field<Scalar>& x, double tolerance, ExecutorRef executor) {
    SolveReport report;
    const double size = sum_(executor, [&](Index i, Index j) { return range_dot(b, b, i, j); });
    std::fill(x.begin(), x.end(), Vec3<Scalar>::Zero());
    if (is_zero(size)) return report;
    residual_ = b;
    for (;;) {
      factor(residual_, correction_);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction_[i];
      matrix.apply(x, residual_, executor);
      for (std::size_t i = 0; i < b.size(); ++i) residual_[i] = b[i] - residual_[i];
      report.residual = detail::square_root(
          sum_(executor, [&](Index i, Index j) { return range_dot(residual_, residual_, i, j); }) / size);
      if (!std::isfinite(report.residual)) return {SolveStatus::breakdown, report.iterations, 1.0};
      if (report.residual <= tolerance) return report;
      if (report.iterations == max_corrections) {
        report.status = SolveStatus::stagnated;
        return report;
      }
      ++report.iterations;
    }
  }

  [[nodiscard]] MemoryUse memory() const {
    return MemoryUse{bytes_of(residual_) + bytes_of(correction_), 0} + sum_.memory();
  }

 private:
  static constexpr int max_corrections = 3;  // each gains the digits that the factor has: more would gain nothing

  Field<Scalar> residual_, correction_;
  DeterministicSum sum_;
};

}  // namespace corotet::inline v0_1::detail
