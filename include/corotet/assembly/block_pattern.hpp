// Which 3x3 blocks of a body's matrix are not zero, and which element contributes what to each: found once.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/core/types.hpp>
#include <numeric>
#include <vector>

namespace corotet {

/// Compressed rows of a structurally symmetric block matrix over the vertices, plus, for each block on or above the
/// diagonal, the element contributions that sum to it, in a fixed order: assembly is a gather, free of races and the
/// same bits on any number of threads.
struct BlockPattern {
  std::vector<Index> row_start;  ///< n + 1 entries
  std::vector<Index> column;     ///< block columns, ascending within a row
  std::vector<Index> diagonal;   ///< slot of block (i, i), one a row

  /// A block (row, col) on or above the diagonal.
  struct UpperBlock {
    Index slot;    ///< its place in `column`
    Index mirror;  ///< the place of block (col, row); the same as `slot` on the diagonal
  };
  std::vector<UpperBlock> upper;
  std::vector<Index> contribution_start;  ///< upper.size() + 1 entries
  std::vector<Index> contribution;        ///< (element * nodes + a) * nodes + b

  std::vector<Index> incidence_start;  ///< n + 1 entries
  std::vector<Index> incidence;        ///< element * nodes + a, ascending, for each vertex

  [[nodiscard]] Index rows() const { return size_of(diagonal); }
  [[nodiscard]] Index blocks() const { return size_of(column); }

  /// The slot of block (row, col), which must be there.
  [[nodiscard]] Index slot(Index row, Index col) const {
    const auto begin = column.begin() + row_start[at(row)], end = column.begin() + row_start[at(row) + 1];
    return static_cast<Index>(std::lower_bound(begin, end, col) - column.begin());
  }

  /// The pattern of a mesh of `vertices` vertices. O(elements * nodes^2 * log(blocks in a row)).
  template <std::size_t N>
  [[nodiscard]] static BlockPattern of(const std::vector<std::array<Index, N>>& elements, Index vertices) {
    BlockPattern p;
    p.find_incidence(elements, vertices);
    p.find_blocks(elements);
    p.find_contributions(elements);
    return p;
  }

 private:
  template <std::size_t N>
  void find_incidence(const std::vector<std::array<Index, N>>& elements, Index vertices) {
    incidence_start.assign(at(vertices) + 1, 0);
    for (const auto& nodes : elements)
      for (const Index v : nodes) ++incidence_start[at(v) + 1];
    std::partial_sum(incidence_start.begin(), incidence_start.end(), incidence_start.begin());
    incidence.resize(elements.size() * N);
    std::vector<Index> next(incidence_start.begin(), incidence_start.end() - 1);
    for (std::size_t e = 0; e < elements.size(); ++e)
      for (std::size_t a = 0; a < N; ++a) incidence[at(next[at(elements[e][a])]++)] = static_cast<Index>(e * N + a);
  }

  template <std::size_t N>
  void find_blocks(const std::vector<std::array<Index, N>>& elements) {
    const std::size_t n = incidence_start.size() - 1;
    row_start.assign(1, 0);
    row_start.reserve(n + 1);
    diagonal.reserve(n);
    std::vector<Index> row;
    for (std::size_t i = 0; i < n; ++i) {
      row.clear();
      for (Index k = incidence_start[i]; k < incidence_start[i + 1]; ++k) {
        const auto& nodes = elements[at(incidence[at(k)]) / N];
        row.insert(row.end(), nodes.begin(), nodes.end());
      }
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      column.insert(column.end(), row.begin(), row.end());
      row_start.push_back(size_of(column));
      diagonal.push_back(slot(static_cast<Index>(i), static_cast<Index>(i)));
    }
    for (Index i = 0; i < rows(); ++i)
      for (Index k = diagonal[at(i)]; k < row_start[at(i) + 1]; ++k) upper.push_back({k, slot(column[at(k)], i)});
  }

  template <std::size_t N>
  void find_contributions(const std::vector<std::array<Index, N>>& elements) {
    std::vector<Index> upper_of_slot(column.size(), -1);
    for (std::size_t u = 0; u < upper.size(); ++u) upper_of_slot[at(upper[u].slot)] = static_cast<Index>(u);

    contribution_start.assign(upper.size() + 1, 0);
    std::vector<Index> target;  // the upper block of each contribution, in element order
    target.reserve(elements.size() * N * (N + 1) / 2);
    const auto for_each_pair = [&](auto&& visit) {
      for (std::size_t e = 0; e < elements.size(); ++e)
        for (std::size_t a = 0; a < N; ++a)
          for (std::size_t b = 0; b < N; ++b)
            if (elements[e][a] <= elements[e][b]) visit(e, a, b);
    };
    for_each_pair([&](std::size_t e, std::size_t a, std::size_t b) {
      target.push_back(upper_of_slot[at(slot(elements[e][a], elements[e][b]))]);
      ++contribution_start[at(target.back()) + 1];
    });
    std::partial_sum(contribution_start.begin(), contribution_start.end(), contribution_start.begin());
    contribution.resize(target.size());
    std::vector<Index> next(contribution_start.begin(), contribution_start.end() - 1);
    std::size_t k = 0;
    for_each_pair([&](std::size_t e, std::size_t a, std::size_t b) {
      contribution[at(next[at(target[k++])]++)] = static_cast<Index>((e * N + a) * N + b);
    });
  }
};

}  // namespace corotet
