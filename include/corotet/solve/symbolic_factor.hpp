// What a sparse Cholesky factorisation finds out from the pattern alone.
#pragma once

#include <algorithm>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/minimum_degree.hpp>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// Ordering, elimination tree and column counts of L, A = P^T L L^T P (Davis 2006, "Direct Methods for Sparse Linear
/// Systems", sections 4.1 to 4.4), by blocks of any size.
struct SymbolicFactor {
  struct UpperEntry {
    Index row;   ///< permuted, <= the column that lists it
    Index slot;  ///< in the matrix, of block (column, row)
  };

  std::vector<Index> order;         ///< order[k]: the row eliminated as k-th
  std::vector<Index> upper_start;   ///< rows + 1 entries
  std::vector<UpperEntry> upper;    ///< the upper triangle of the permuted matrix, by columns
  std::vector<Index> parent;        ///< in the elimination tree, -1 for a root
  std::vector<Index> column_start;  ///< of L, rows + 1 entries
  std::size_t blocks = 0;           ///< in L, the diagonal included
  double squares = 0;               ///< sum over columns of the square of their blocks

  SymbolicFactor() = default;
  explicit SymbolicFactor(const BlockPattern& pattern) : SymbolicFactor(pattern, MinimumDegree::order(pattern)) {}
  /// With a permutation of the rows as the order.
  COROTET_COLD SymbolicFactor(const BlockPattern& pattern, std::vector<Index> elimination)
      : order(std::move(elimination)) {
    find_upper(pattern);
    find_tree(pattern.rows());
    count_columns(pattern.rows());
  }

  /// True if the factor can be indexed.
  [[nodiscard]] bool fits() const { return blocks <= std::size_t{(std::numeric_limits<Index>::max)()}; }

 private:
  COROTET_COLD void find_upper(const BlockPattern& pattern) {
    std::vector<Index> place(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) place[at(order[k])] = static_cast<Index>(k);
    upper_start.assign(1, 0);
    for (const Index i : order) {
      const Index k = place[at(i)];
      for (Index s = pattern.row_start[at(i)]; s < pattern.row_start[at(i) + 1]; ++s)
        if (const Index j = place[at(pattern.column[at(s)])]; j <= k) upper.push_back({j, s});
      upper_start.push_back(size_of(upper));
    }
  }

  COROTET_COLD void find_tree(Index n) {
    parent.assign(at(n), -1);
    std::vector<Index> ancestor(at(n), -1);
    for (Index k = 0; k < n; ++k)
      for (Index e = upper_start[at(k)]; e < upper_start[at(k) + 1]; ++e)
        for (Index j = upper[at(e)].row; j != -1 && j < k;) {
          const Index next = ancestor[at(j)];
          ancestor[at(j)] = k;
          if (next == -1) parent[at(j)] = k;
          j = next;
        }
  }

  /// Walks the row subtrees; the time is that of writing down the pattern of L once.
  COROTET_COLD void count_columns(Index n) {
    std::vector<Index> count(at(n), 1), mark(at(n), -1);
    for (Index k = 0; k < n; ++k) {
      mark[at(k)] = k;
      for (Index e = upper_start[at(k)]; e < upper_start[at(k) + 1]; ++e)
        for (Index j = upper[at(e)].row; mark[at(j)] != k; j = parent[at(j)]) {
          ++count[at(j)];
          mark[at(j)] = k;
        }
    }
    column_start.assign(1, 0);
    for (const Index c : count) {
      blocks += at(c);
      column_start.push_back(static_cast<Index>((std::min)(blocks, std::size_t{(std::numeric_limits<Index>::max)()})));
      squares += 1.0 * c * c;
    }
  }
};

}  // namespace corotet::inline v0_1
