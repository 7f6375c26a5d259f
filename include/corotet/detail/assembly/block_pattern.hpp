// Which 3x3 blocks of a body's matrix are not zero, and which element contributes what to each: found once.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/types.hpp>
#include <numeric>
#include <vector>

namespace corotet::inline v0_1 {

/// Sets of vertices that a term of the energy couples besides those of an element: group g has the vertices
/// vertex[start[g]] ... vertex[start[g + 1] - 1], each once.
struct Stencils {
  std::vector<Index> start;   ///< groups + 1 entries, or none
  std::vector<Index> vertex;  ///< at most `max_vertices` a group

  static constexpr Index max_vertices = 16;  ///< of one stencil

  /// Number of stencils.
  [[nodiscard]] Index count() const { return start.empty() ? 0 : size_of(start) - 1; }
};

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
  std::vector<UpperBlock> upper;          ///< those blocks
  std::vector<Index> contribution_start;  ///< upper.size() + 1 entries
  std::vector<Index> contribution;        ///< (element * nodes + a) * nodes + b

  /// The same for groups of vertices; both empty if there are none.
  std::vector<Index> stencil_contribution_start;
  std::vector<Index> stencil_contribution;  ///< see row_of_stencil, column_of_stencil

  /// Places in Stencils::vertex of the row and the column of a group's contribution.
  [[nodiscard]] static std::size_t row_of_stencil(Index code) { return at(code / code_range); }
  /// The place of the column: see row_of_stencil.
  [[nodiscard]] static std::size_t column_of_stencil(Index code) {
    return at(code / code_range + code % code_range - Stencils::max_vertices);
  }
  /// Members of all groups that a pattern can number.
  static constexpr std::size_t max_stencil_members = (std::size_t{1} << 31) / (2 * Stencils::max_vertices);

  std::vector<Index> incidence_start;  ///< n + 1 entries
  std::vector<Index> incidence;        ///< element * nodes + a, ascending, for each vertex

  /// Number of block rows.
  [[nodiscard]] Index rows() const { return size_of(diagonal); }
  /// Number of stored blocks, both triangles and the diagonal.
  [[nodiscard]] Index blocks() const { return size_of(column); }

  /// Bytes on the heap.
  [[nodiscard]] std::size_t bytes() const {
    return detail::bytes_of(row_start) + detail::bytes_of(column) + detail::bytes_of(diagonal) +
           detail::bytes_of(upper) + detail::bytes_of(contribution_start) + detail::bytes_of(contribution) +
           detail::bytes_of(stencil_contribution_start) + detail::bytes_of(stencil_contribution) +
           detail::bytes_of(incidence_start) + detail::bytes_of(incidence);
  }

  /// The slot of block (row, col), which must be there.
  [[nodiscard]] Index slot(Index row, Index col) const {
    const auto begin = column.begin() + row_start[at(row)], end = column.begin() + row_start[at(row) + 1];
    return static_cast<Index>(std::lower_bound(begin, end, col) - column.begin());
  }

  /// Whether block (row, col) is there.
  [[nodiscard]] bool has(Index row, Index col) const {
    const Index k = slot(row, col);
    return k < row_start[at(row) + 1] && column[at(k)] == col;
  }

  /// The pattern of a mesh of `vertices` vertices, with the blocks of `groups` and `couplings` besides those of the
  /// elements; nothing is known of what contributes to those of `couplings`.
  /// O(elements * nodes^2 * log(blocks in a row)).
  template <std::size_t N>
  [[nodiscard]] COROTET_COLD static BlockPattern of(const std::vector<std::array<Index, N>>& elements, Index vertices,
                                                    const Stencils& groups = {}, const Stencils& couplings = {}) {
    COROTET_ASSERT(groups.vertex.size() <= max_stencil_members, "too many groups for 32-bit indices");
    BlockPattern p;
    p.find_incidence(elements, vertices);
    p.find_blocks(elements, groups, couplings);
    const auto code = [](std::size_t e, std::size_t a, std::size_t b) { return (e * N + a) * N + b; };
    p.find_contributions(
        [&](auto&& visit) {
          for (std::size_t e = 0; e < elements.size(); ++e)
            for (std::size_t a = 0; a < N; ++a)
              for (std::size_t b = 0; b < N; ++b) visit(elements[e][a], elements[e][b], code(e, a, b));
        },
        elements.size() * N * (N + 1) / 2, p.contribution_start, p.contribution);
    if (groups.count() > 0) p.find_stencil_contributions(groups);
    return p;
  }

 private:
  template <std::size_t N>
  COROTET_COLD void find_incidence(const std::vector<std::array<Index, N>>& elements, Index vertices) {
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
  COROTET_COLD void find_blocks(const std::vector<std::array<Index, N>>& elements, const Stencils& groups,
                                const Stencils& couplings) {
    const std::size_t n = incidence_start.size() - 1;
    const auto groups_of_vertices = [n](const Stencils& several) {
      std::vector<std::vector<Index>> groups_of(several.count() > 0 ? n : 0);
      for (Index g = 0; g < several.count(); ++g)
        for (Index k = several.start[at(g)]; k < several.start[at(g) + 1]; ++k)
          groups_of[at(several.vertex[at(k)])].push_back(g);
      return groups_of;
    };
    const auto groups_of = groups_of_vertices(groups), couplings_of = groups_of_vertices(couplings);
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
      const auto add_groups = [&](const Stencils& several, const std::vector<std::vector<Index>>& of_vertex) {
        if (of_vertex.empty()) return;
        for (const Index g : of_vertex[i])
          row.insert(row.end(), several.vertex.begin() + several.start[at(g)],
                     several.vertex.begin() + several.start[at(g) + 1]);
      };
      add_groups(groups, groups_of);
      add_groups(couplings, couplings_of);
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      column.insert(column.end(), row.begin(), row.end());
      row_start.push_back(size_of(column));
      diagonal.push_back(slot(static_cast<Index>(i), static_cast<Index>(i)));
    }
    for (Index i = 0; i < rows(); ++i)
      for (Index k = diagonal[at(i)]; k < row_start[at(i) + 1]; ++k) upper.push_back({k, slot(column[at(k)], i)});
  }

  static constexpr Index code_range = 2 * Stencils::max_vertices;

  COROTET_COLD void find_stencil_contributions(const Stencils& groups) {
    const auto code = [](Index row, Index column_place) {
      return at(row) * at(code_range) + at(column_place - row + Stencils::max_vertices);
    };
    find_contributions(
        [&](auto&& visit) {
          for (Index g = 0; g < groups.count(); ++g)
            for (Index a = groups.start[at(g)]; a < groups.start[at(g) + 1]; ++a)
              for (Index b = groups.start[at(g)]; b < groups.start[at(g) + 1]; ++b)
                visit(groups.vertex[at(a)], groups.vertex[at(b)], code(a, b));
        },
        groups.vertex.size(), stencil_contribution_start, stencil_contribution);
  }

  /// Sorts contributions by their block. `for_each_pair` visits (row vertex, column vertex, code) of each, below the
  /// diagonal too, twice in the same order; about `expected` of them are not below it.
  template <class ForEachPair>
  COROTET_COLD void find_contributions(const ForEachPair& for_each_pair, std::size_t expected,
                                       std::vector<Index>& start, std::vector<Index>& list) const {
    std::vector<Index> upper_of_slot(column.size(), -1);
    for (std::size_t u = 0; u < upper.size(); ++u) upper_of_slot[at(upper[u].slot)] = static_cast<Index>(u);

    start.assign(upper.size() + 1, 0);
    std::vector<Index> target;  // the upper block of each contribution, in the order of the visits
    target.reserve(expected);
    for_each_pair([&](Index i, Index j, std::size_t) {
      if (i > j) return;
      target.push_back(upper_of_slot[at(slot(i, j))]);
      ++start[at(target.back()) + 1];
    });
    std::partial_sum(start.begin(), start.end(), start.begin());
    list.resize(target.size());
    std::vector<Index> next(start.begin(), start.end() - 1);
    std::size_t k = 0;
    for_each_pair([&](Index i, Index j, std::size_t code) {
      if (i <= j) list[at(next[at(target[k++])]++)] = static_cast<Index>(code);
    });
  }
};

}  // namespace corotet::inline v0_1
