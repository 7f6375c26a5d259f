// Sparse Cholesky factorisation by small blocks: for direct solutions of small bodies, and inside preconditioners.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/small_cholesky.hpp>
#include <corotet/solve/symbolic_factor.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1 {

/// A = P^T L L^T P with a fill-reducing permutation of the vertices (MinimumDegree). Eigen's own
/// sparse factorisations work number by number and allocate in every factorisation; this one works on blocks and
/// allocates in `analyze` alone. Up-looking, after Davis 2006, "Direct Methods for Sparse Linear Systems", section 4.7.
template <std::floating_point Scalar, int B = 3>
class BlockCholesky {
 public:
  using Block = Matrix<Scalar, B, B>;

  /// Ordering, elimination tree and pattern of L. O(|L|) memory for the blocks of L comes with `allocate()`.
  COROTET_COLD void analyze(const BlockPattern& pattern) {
    symbolic_ = SymbolicFactor(pattern);
    factor_.order = symbolic_.order;
    factor_.column_start = symbolic_.column_start;
  }

  /// True if the factor can be indexed; `allocate` and `factorize` need that.
  [[nodiscard]] bool fits() const { return symbolic_.fits(); }

  /// Blocks in L, the diagonal included.
  [[nodiscard]] std::size_t factor_blocks() const { return symbolic_.blocks; }

  /// Multiplications and additions of one factorisation: c^2/2 block products of 2 B^3 operations a column of c.
  [[nodiscard]] double factor_flops() const { return 1.0 * B * B * B * symbolic_.squares; }

  /// Reserves the factor; after `analyze`, before `factorize`.
  COROTET_COLD void allocate() {
    const std::size_t n = factor_.order.size();
    factor_.row.assign(symbolic_.blocks, 0);
    factor_.allocate();
    work_.assign(n, Block::Zero());
    stack_.assign(n, 0);
    marked_.assign(n, -1);
    filled_.assign(n, 0);
  }

  /// False if a pivot is not positive definite to rounding; the factor is then of no use.
  [[nodiscard]] bool factorize(const BlockMatrix<Scalar, B>& matrix) {
    const Index n = size_of(factor_.order);
    std::fill(marked_.begin(), marked_.end(), -1);
    for (Index k = 0; k < n; ++k) {
      const Index top = scatter_row(matrix, k);
      Block diagonal = work_[at(k)];
      work_[at(k)].setZero();
      for (Index s = top; s < n; ++s) {
        const Index j = stack_[at(s)];
        const Index begin = factor_.column_start[at(j)], end = filled_[at(j)];
        // L_kj = A_kj L_jj^-T; the diagonal slot of column j holds L_jj^-1.
        const Block l = work_[at(j)] * factor_.block(begin).transpose();
        work_[at(j)].setZero();
        for (Index p = begin + 1; p < end; ++p) work_[at(factor_.row[at(p)])] -= l * factor_.block(p).transpose();
        diagonal -= l * l.transpose();
        factor_.row[at(end)] = k;
        factor_.block(end) = l;
        ++filled_[at(j)];
      }
      Block inverse;
      if (!inverse_cholesky(diagonal, inverse)) return false;
      const Index first = factor_.column_start[at(k)];
      factor_.row[at(first)] = k;
      factor_.block(first) = inverse;
      filled_[at(k)] = first + 1;
    }
    return true;
  }

  /// What `factorize` made.
  [[nodiscard]] BlockFactor<Scalar, B>& factor() { return factor_; }
  [[nodiscard]] const BlockFactor<Scalar, B>& factor() const { return factor_; }

 private:
  /// Spreads row k of the lower triangle into `work_`; the columns of row k of L, in the order in which they must be
  /// eliminated, go to stack_[top ... n). Returns top. (Davis 2006, section 4.2.)
  [[nodiscard]] Index scatter_row(const BlockMatrix<Scalar, B>& matrix, Index k) {
    Index top = size_of(factor_.order);
    marked_[at(k)] = k;
    for (Index e = symbolic_.upper_start[at(k)]; e < symbolic_.upper_start[at(k) + 1]; ++e) {
      const auto [row, slot] = symbolic_.upper[at(e)];
      work_[at(row)] = matrix.block(slot);
      Index length = 0;
      for (Index j = row; marked_[at(j)] != k; j = symbolic_.parent[at(j)]) {
        stack_[at(length++)] = j;
        marked_[at(j)] = k;
      }
      while (length > 0) stack_[at(--top)] = stack_[at(--length)];
    }
    return top;
  }

  SymbolicFactor symbolic_;
  BlockFactor<Scalar, B> factor_;
  detail::Buffer<Block> work_;
  std::vector<Index> stack_, marked_, filled_;
};

}  // namespace corotet::inline v0_1
