// Sparse Cholesky factorisation by small blocks: for direct solutions of small bodies, and inside preconditioners.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/block_factor.hpp>
#include <corotet/solve/fill_reducing_order.hpp>
#include <corotet/solve/small_cholesky.hpp>
#include <cstddef>
#include <limits>
#include <vector>

namespace corotet {

/// A = P^T L L^T P with a fill-reducing permutation of the vertices (approximate minimum degree, by Eigen). Eigen's own
/// sparse factorisations work number by number and allocate in every factorisation; this one works on blocks and
/// allocates in `analyze` alone. Up-looking, after Davis 2006, "Direct Methods for Sparse Linear Systems", sections
/// 4.3-4.7.
template <std::floating_point Scalar, int B = 3>
class BlockCholesky {
 public:
  using Block = Matrix<Scalar, B, B>;

  /// Ordering, elimination tree and pattern of L. O(|L|) memory for the blocks of L comes with `allocate()`.
  void analyze(const BlockPattern& pattern) {
    const Index n = pattern.rows();
    factor_.order = fill_reducing_order(pattern);
    find_rows_of_upper(pattern);
    find_tree(n);
    count_columns(n);
  }

  /// True if the factor can be indexed; `allocate` and `factorize` need that.
  [[nodiscard]] bool fits() const { return blocks_ <= std::size_t{(std::numeric_limits<Index>::max)()}; }

  /// Blocks in L, the diagonal included.
  [[nodiscard]] std::size_t factor_blocks() const { return blocks_; }

  /// Multiplications and additions of one factorisation.
  [[nodiscard]] double factor_flops() const { return flops_; }

  /// Reserves the factor; after `analyze`, before `factorize`.
  void allocate() {
    const std::size_t n = factor_.order.size();
    factor_.row.assign(blocks_, 0);
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
  struct UpperEntry {
    Index row;   ///< permuted, <= the column that lists it
    Index slot;  ///< in the matrix, of block (column, row)
  };

  void find_rows_of_upper(const BlockPattern& pattern) {
    std::vector<Index> place(factor_.order.size());
    for (std::size_t k = 0; k < factor_.order.size(); ++k) place[at(factor_.order[k])] = static_cast<Index>(k);
    upper_start_.assign(1, 0);
    upper_.clear();
    for (const Index i : factor_.order) {
      const Index k = place[at(i)];
      for (Index s = pattern.row_start[at(i)]; s < pattern.row_start[at(i) + 1]; ++s)
        if (const Index j = place[at(pattern.column[at(s)])]; j <= k) upper_.push_back({j, s});
      upper_start_.push_back(size_of(upper_));
    }
  }

  /// Elimination tree (Davis 2006, section 4.1).
  void find_tree(Index n) {
    parent_.assign(at(n), -1);
    std::vector<Index> ancestor(at(n), -1);
    for (Index k = 0; k < n; ++k)
      for (Index e = upper_start_[at(k)]; e < upper_start_[at(k) + 1]; ++e)
        for (Index j = upper_[at(e)].row; j != -1 && j < k;) {
          const Index next = ancestor[at(j)];
          ancestor[at(j)] = k;
          if (next == -1) parent_[at(j)] = k;
          j = next;
        }
  }

  /// Walks the row subtrees; the time is that of writing down the pattern of L once.
  void count_columns(Index n) {
    std::vector<Index> count(at(n), 1), mark(at(n), -1);
    for (Index k = 0; k < n; ++k) {
      mark[at(k)] = k;
      for (Index e = upper_start_[at(k)]; e < upper_start_[at(k) + 1]; ++e)
        for (Index j = upper_[at(e)].row; mark[at(j)] != k; j = parent_[at(j)]) {
          ++count[at(j)];
          mark[at(j)] = k;
        }
    }
    factor_.column_start.assign(1, 0);
    flops_ = 0;
    blocks_ = 0;
    for (const Index c : count) {
      blocks_ += at(c);
      factor_.column_start.push_back(
          static_cast<Index>(std::min<std::size_t>(blocks_, (std::numeric_limits<Index>::max)())));
      flops_ += 1.0 * B * B * B * c * c;  // c^2/2 block products of 2 B^3 operations
    }
  }

  /// Spreads row k of the lower triangle into `work_`; the columns of row k of L, in the order in which they must be
  /// eliminated, go to stack_[top ... n). Returns top. (Davis 2006, section 4.2.)
  [[nodiscard]] Index scatter_row(const BlockMatrix<Scalar, B>& matrix, Index k) {
    Index top = size_of(factor_.order);
    marked_[at(k)] = k;
    for (Index e = upper_start_[at(k)]; e < upper_start_[at(k) + 1]; ++e) {
      const auto [row, slot] = upper_[at(e)];
      work_[at(row)] = matrix.block(slot);
      Index length = 0;
      for (Index j = row; marked_[at(j)] != k; j = parent_[at(j)]) {
        stack_[at(length++)] = j;
        marked_[at(j)] = k;
      }
      while (length > 0) stack_[at(--top)] = stack_[at(--length)];
    }
    return top;
  }

  std::vector<Index> upper_start_;
  std::vector<UpperEntry> upper_;
  std::vector<Index> parent_;
  std::size_t blocks_ = 0;
  double flops_ = 0;

  BlockFactor<Scalar, B> factor_;
  std::vector<Block> work_;
  std::vector<Index> stack_, marked_, filled_;
};

}  // namespace corotet
