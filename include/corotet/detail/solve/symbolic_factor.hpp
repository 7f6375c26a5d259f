// The part of a sparse Cholesky factorisation that follows from the pattern of the matrix alone.
#pragma once

#include <algorithm>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/minimum_degree.hpp>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Ordering and pattern of L, A = P^T L L^T P, by blocks of any size. Copies of a factor share one (Davis 2006, "Direct
/// Methods for Sparse Linear Systems", sections 4.1 to 4.4).
struct SymbolicFactor {
  std::vector<Index> order;         ///< order[k]: the row eliminated as k-th
  std::vector<Index> place;         ///< place[order[k]] == k
  std::vector<Index> column_start;  ///< of L, rows + 1 entries
  std::vector<Index> row;           ///< of each block of L, ascending in a column, the diagonal first; see `fits`
  std::vector<Index> position;      ///< in L, of each slot of A; -1 above the diagonal of the permuted A; see `fits`
  std::size_t blocks = 0;           ///< in L, the diagonal included
  double squares = 0;               ///< sum over columns of the square of their blocks

  explicit SymbolicFactor(const BlockPattern& pattern) : SymbolicFactor(pattern, MinimumDegree::order(pattern)) {}
  /// With a permutation of the rows as the order.
  COROTET_COLD SymbolicFactor(const BlockPattern& pattern, std::vector<Index> elimination)
      : order(std::move(elimination)), place(order.size()) {
    for (Index k = 0; k < rows(); ++k) place[at(order[at(k)])] = k;
    const std::vector<Index> parent = elimination_tree(pattern);
    count_columns(pattern, parent);
    if (fits()) find_rows(pattern, parent);
  }

  [[nodiscard]] Index rows() const { return size_of(order); }

  /// True if the factor can be indexed; otherwise `row` and `position` are empty.
  [[nodiscard]] bool fits() const { return blocks <= std::size_t{(std::numeric_limits<Index>::max)()}; }

  /// Blocks of the longest column.
  [[nodiscard]] std::size_t max_column() const {
    Index most = 0;
    for (std::size_t k = 1; k < column_start.size(); ++k)
      most = (std::max)(most, column_start[k] - column_start[k - 1]);
    return at(most);
  }

  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(order) + bytes_of(place) + bytes_of(column_start) + bytes_of(row) + bytes_of(position);
  }

 private:
  /// Calls `visit(j, slot)` for each block (k, j), j <= k, of the permuted matrix.
  template <class Visit>
  void for_row(const BlockPattern& pattern, Index k, Visit&& visit) const {
    const Index i = order[at(k)];
    for (Index s = pattern.row_start[at(i)]; s < pattern.row_start[at(i) + 1]; ++s)
      if (const Index j = place[at(pattern.column[at(s)])]; j <= k) visit(j, s);
  }

  /// The parent of each column; -1 for a root.
  [[nodiscard]] COROTET_COLD std::vector<Index> elimination_tree(const BlockPattern& pattern) const {
    std::vector<Index> parent(order.size(), -1), ancestor(order.size(), -1);
    for (Index k = 0; k < rows(); ++k)
      for_row(pattern, k, [&](Index j, Index) {
        while (j != -1 && j < k) {
          const Index next = ancestor[at(j)];
          ancestor[at(j)] = k;
          if (next == -1) parent[at(j)] = k;
          j = next;
        }
      });
    return parent;
  }

  /// Calls `visit(j)` once for each column j < k in which row k of L has a block.
  template <class Visit>
  void for_row_of_factor(const BlockPattern& pattern, const std::vector<Index>& parent, std::vector<Index>& mark,
                         Index k, Visit&& visit) const {
    mark[at(k)] = k;
    for_row(pattern, k, [&](Index j, Index) {
      for (; mark[at(j)] != k; j = parent[at(j)]) {
        mark[at(j)] = k;
        visit(j);
      }
    });
  }

  COROTET_COLD void count_columns(const BlockPattern& pattern, const std::vector<Index>& parent) {
    std::vector<Index> count(order.size(), 1), mark(order.size(), -1);
    for (Index k = 0; k < rows(); ++k) for_row_of_factor(pattern, parent, mark, k, [&](Index j) { ++count[at(j)]; });
    constexpr std::size_t most{(std::numeric_limits<Index>::max)()};
    column_start.reserve(order.size() + 1);
    column_start.push_back(0);
    for (const Index c : count) {
      blocks += at(c);
      column_start.push_back(static_cast<Index>(blocks < most ? blocks : most));
      squares += 1.0 * c * c;
    }
  }

  COROTET_COLD void find_rows(const BlockPattern& pattern, const std::vector<Index>& parent) {
    row.resize(blocks);
    position.assign(pattern.column.size(), -1);
    std::vector<Index> last = column_start, mark(order.size(), -1);  // the last block of each column so far
    for (Index k = 0; k < rows(); ++k) {
      row[at(last[at(k)])] = k;
      for_row_of_factor(pattern, parent, mark, k, [&](Index j) { row[at(++last[at(j)])] = k; });
      for_row(pattern, k, [&](Index j, Index slot) { position[at(slot)] = last[at(j)]; });
    }
  }
};

}  // namespace corotet::inline v0_1::detail
