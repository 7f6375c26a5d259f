// Which 3x3 blocks of a body's matrix are not zero, and which element contributes what to each: found once.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/index_list.hpp>
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
  detail::Buffer<UpperBlock> upper;       ///< those blocks
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
  [[nodiscard]] static BlockPattern of(const std::vector<std::array<Index, N>>& elements, Index vertices,
                                       const Stencils& groups = {}, const Stencils& couplings = {}) {
    return of(elements.empty() ? nullptr : elements.front().data(), elements.size(), N, vertices, groups, couplings);
  }

 private:
  /// Of elements of `nodes` vertices each.
  [[nodiscard]] COROTET_COLD static BlockPattern of(const Index* vertex, std::size_t elements, std::size_t nodes,
                                                    Index vertices, const Stencils& groups, const Stencils& couplings) {
    COROTET_ASSERT(groups.vertex.size() <= max_stencil_members, "too many groups for 32-bit indices");
    BlockPattern p;
    detail::find_places(vertex, elements * nodes, at(vertices), p.incidence_start, p.incidence);
    p.find_blocks(vertex, nodes, groups, couplings);
    Contributions all(p, elements * nodes * (nodes + 1) / 2);
    for (std::size_t e = 0; e < elements; ++e)
      for (std::size_t a = e * nodes; a < (e + 1) * nodes; ++a)
        for (std::size_t b = 0; b < nodes; ++b) all.add(vertex[a], vertex[e * nodes + b], a * nodes + b);
    all.sort(p.contribution_start, p.contribution);
    if (groups.count() > 0) p.find_stencil_contributions(groups);
    return p;
  }

  /// The groups of each vertex.
  struct GroupsOfVertices {
    std::vector<Index> start, place, group;  // group: of each member of a group, `place` among these

    COROTET_COLD GroupsOfVertices(const Stencils& groups, std::size_t vertices) {
      for (Index g = 0; g < groups.count(); ++g)
        for (Index k = groups.start[at(g)]; k < groups.start[at(g) + 1]; ++k) group.push_back(g);
      const Index first = group.empty() ? 0 : groups.start.front();
      detail::find_places(groups.vertex.data() + first, group.size(), vertices, start, place);
    }

    /// Appends the members of all groups of a vertex.
    COROTET_COLD void append_to(std::vector<Index>& row, const Stencils& groups, std::size_t vertex) const {
      for (Index k = start[vertex]; k < start[vertex + 1]; ++k) {
        const std::size_t g = at(group[at(place[at(k)])]);
        detail::append(row, groups.vertex.data() + groups.start[g], at(groups.start[g + 1] - groups.start[g]));
      }
    }
  };

  COROTET_COLD void find_blocks(const Index* vertex, std::size_t nodes, const Stencils& groups,
                                const Stencils& couplings) {
    const std::size_t n = incidence_start.size() - 1;
    const GroupsOfVertices groups_of(groups, n), couplings_of(couplings, n);
    row_start.assign(1, 0);
    row_start.reserve(n + 1);
    diagonal.reserve(n);
    std::vector<Index> row;
    for (std::size_t i = 0; i < n; ++i) {
      row.clear();
      for (Index k = incidence_start[i]; k < incidence_start[i + 1]; ++k)
        detail::append(row, vertex + at(incidence[at(k)]) / nodes * nodes, nodes);
      groups_of.append_to(row, groups, i);
      couplings_of.append_to(row, couplings, i);
      detail::sort_and_unite(row);
      detail::append(column, row);
      row_start.push_back(size_of(column));
      diagonal.push_back(slot(static_cast<Index>(i), static_cast<Index>(i)));
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) count += at(row_start[i + 1] - diagonal[i]);
    upper = detail::Buffer<UpperBlock>(count);
    for (Index i = rows(), u = static_cast<Index>(count); i-- > 0;)
      for (Index k = row_start[at(i) + 1]; k-- > diagonal[at(i)];) upper[at(--u)] = {k, slot(column[at(k)], i)};
  }

  static constexpr Index code_range = 2 * Stencils::max_vertices;

  COROTET_COLD void find_stencil_contributions(const Stencils& groups) {
    Contributions all(*this, groups.vertex.size());
    for (Index g = 0; g < groups.count(); ++g)
      for (Index a = groups.start[at(g)]; a < groups.start[at(g) + 1]; ++a)
        for (Index b = groups.start[at(g)]; b < groups.start[at(g) + 1]; ++b)
          all.add(groups.vertex[at(a)], groups.vertex[at(b)],
                  at(a) * at(code_range) + at(b - a + Stencils::max_vertices));
    all.sort(stencil_contribution_start, stencil_contribution);
  }

  /// What is added to blocks on or above the diagonal.
  class Contributions {
   public:
    /// About `expected` of them.
    COROTET_COLD Contributions(const BlockPattern& pattern, std::size_t expected)
        : pattern_(pattern), upper_of_slot_(pattern.column.size(), -1) {
      for (std::size_t u = 0; u < pattern.upper.size(); ++u)
        upper_of_slot_[at(pattern.upper[u].slot)] = static_cast<Index>(u);
      target_.reserve(expected);
      code_.reserve(expected);
    }

    /// One of the vertices i and j, unless it lies below the diagonal.
    void add(Index i, Index j, std::size_t code) {
      if (i > j) return;
      target_.push_back(upper_of_slot_[at(pattern_.slot(i, j))]);
      code_.push_back(static_cast<Index>(code));
    }

    /// The codes of each upper block, in the order in which they were added.
    COROTET_COLD void sort(std::vector<Index>& start, std::vector<Index>& list) const {
      start.assign(pattern_.upper.size() + 1, 0);
      for (const Index u : target_) ++start[at(u) + 1];
      std::partial_sum(start.begin(), start.end(), start.begin());
      list.resize(target_.size());
      std::vector<Index> next(start.begin(), start.end() - 1);
      for (std::size_t k = 0; k < target_.size(); ++k) list[at(next[at(target_[k])]++)] = code_[k];
    }

   private:
    const BlockPattern& pattern_;
    std::vector<Index> upper_of_slot_;
    std::vector<Index> target_, code_;  // of each contribution, in the order of the calls
  };
};

}  // namespace corotet::inline v0_1
