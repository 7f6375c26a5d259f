// Sparse Cholesky factorisation by 3x3 blocks: the direct solver for small bodies.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/fill_reducing_order.hpp>
#include <limits>
#include <vector>

namespace corotet {

/// A = P^T L L^T P with a fill-reducing permutation of the vertices (approximate minimum degree, by Eigen). Eigen's own
/// sparse factorisations work number by number and allocate in every factorisation; this one works on blocks and
/// allocates in `analyze` alone. Up-looking, after Davis 2006, "Direct Methods for Sparse Linear Systems", sections
/// 4.3-4.7.
template <std::floating_point Scalar>
class BlockCholesky {
 public:
  using Block = Mat3<Scalar>;

  /// Ordering, elimination tree and pattern of L. O(|L|) memory for the blocks of L comes with `allocate()`.
  void analyze(const BlockPattern& pattern) {
    const Index n = pattern.rows();
    order_ = fill_reducing_order(pattern);
    find_rows_of_upper(pattern);
    find_tree(n);
    count_columns(n);
  }

  /// True if the factor can be indexed; `allocate` and `factorize` need that.
  [[nodiscard]] bool fits() const { return blocks_ <= std::size_t{std::numeric_limits<Index>::max()}; }

  /// Blocks in L, the diagonal included.
  [[nodiscard]] std::size_t factor_blocks() const { return blocks_; }

  /// Multiplications and additions of one factorisation.
  [[nodiscard]] double factor_flops() const { return flops_; }

  /// Reserves the factor; after `analyze`, before `factorize`.
  void allocate() {
    const std::size_t n = order_.size();
    block_.assign(blocks_, Block::Zero());
    row_of_.assign(blocks_, 0);
    work_.assign(n, Block::Zero());
    stack_.assign(n, 0);
    marked_.assign(n, -1);
    filled_.assign(n, 0);
    permuted_.assign(n, Vec3<Scalar>::Zero());
  }

  /// False if a pivot is not positive definite to rounding; the factor is then of no use.
  [[nodiscard]] bool factorize(const BlockMatrix<Scalar>& matrix) {
    const Index n = size_of(order_);
    std::fill(marked_.begin(), marked_.end(), -1);
    for (Index k = 0; k < n; ++k) {
      const Index top = scatter_row(matrix, k);
      Block diagonal = work_[at(k)];
      work_[at(k)].setZero();
      for (Index s = top; s < n; ++s) {
        const Index j = stack_[at(s)];
        const Index begin = column_start_[at(j)], end = filled_[at(j)];
        // L_kj = A_kj L_jj^-T; the diagonal slot of column j holds L_jj^-1.
        const Block l = work_[at(j)] * block_[at(begin)].transpose();
        work_[at(j)].setZero();
        for (Index p = begin + 1; p < end; ++p) work_[at(row_of_[at(p)])] -= l * block_[at(p)].transpose();
        diagonal -= l * l.transpose();
        row_of_[at(end)] = k;
        block_[at(end)] = l;
        ++filled_[at(j)];
      }
      const Eigen::LLT<Block> pivot(diagonal);
      if (pivot.info() != Eigen::Success || !diagonal.allFinite()) return false;
      const Index first = column_start_[at(k)];
      row_of_[at(first)] = k;
      block_[at(first)] = pivot.matrixL().solve(Block::Identity());
      filled_[at(k)] = first + 1;
    }
    return true;
  }

  /// x = A^-1 b.
  void solve(const Field<Scalar>& b, Field<Scalar>& x) {
    const Index n = size_of(order_);
    for (Index k = 0; k < n; ++k) permuted_[at(k)] = b[at(order_[at(k)])];
    for (Index j = 0; j < n; ++j) {
      Vec3<Scalar>& y = permuted_[at(j)];
      y = (block_[at(column_start_[at(j)])] * y).eval();
      for (Index p = column_start_[at(j)] + 1; p < column_start_[at(j) + 1]; ++p)
        permuted_[at(row_of_[at(p)])] -= block_[at(p)] * y;
    }
    for (Index j = n - 1; j >= 0; --j) {
      Vec3<Scalar>& y = permuted_[at(j)];
      for (Index p = column_start_[at(j)] + 1; p < column_start_[at(j) + 1]; ++p)
        y -= block_[at(p)].transpose() * permuted_[at(row_of_[at(p)])];
      y = (block_[at(column_start_[at(j)])].transpose() * y).eval();
    }
    for (Index k = 0; k < n; ++k) x[at(order_[at(k)])] = permuted_[at(k)];
  }

 private:
  struct UpperEntry {
    Index row;   ///< permuted, <= the column that lists it
    Index slot;  ///< in the matrix, of block (column, row)
  };

  void find_rows_of_upper(const BlockPattern& pattern) {
    std::vector<Index> place(order_.size());
    for (std::size_t k = 0; k < order_.size(); ++k) place[at(order_[k])] = static_cast<Index>(k);
    upper_start_.assign(1, 0);
    upper_.clear();
    for (const Index i : order_) {
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
    column_start_.assign(1, 0);
    flops_ = 0;
    blocks_ = 0;
    for (const Index c : count) {
      blocks_ += at(c);
      column_start_.push_back(static_cast<Index>(std::min<std::size_t>(blocks_, std::numeric_limits<Index>::max())));
      flops_ += 27.0 * c * c;  // c^2/2 block products of 54 operations
    }
  }

  /// Spreads row k of the lower triangle into `work_`; the columns of row k of L, in the order in which they must be
  /// eliminated, go to stack_[top ... n). Returns top. (Davis 2006, section 4.2.)
  [[nodiscard]] Index scatter_row(const BlockMatrix<Scalar>& matrix, Index k) {
    Index top = size_of(order_);
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

  std::vector<Index> order_;  // order_[k]: the vertex eliminated as k-th
  std::vector<Index> upper_start_;
  std::vector<UpperEntry> upper_;
  std::vector<Index> parent_;
  std::vector<Index> column_start_;
  std::size_t blocks_ = 0;
  double flops_ = 0;

  std::vector<Block> block_;  // L by columns; the inverse of L_jj comes first in column j
  std::vector<Index> row_of_;
  std::vector<Block> work_;
  std::vector<Index> stack_, marked_, filled_;
  Field<Scalar> permuted_;
};

}  // namespace corotet
