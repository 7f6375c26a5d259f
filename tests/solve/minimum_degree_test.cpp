// The order of elimination: a permutation whatever the graph, the same every time, and with as little fill as that of
// the well-known implementation.
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/solve/minimum_degree.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <gtest/gtest.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "support/bodies.hpp"

namespace corotet::minimum_degree_test {
namespace {

using testing::Random;

/// Of the graph with these edges and no others, the diagonal there.
BlockPattern pattern_of(Index vertices, const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<std::set<Index>> rows(at(vertices));
  for (Index i = 0; i < vertices; ++i) rows[at(i)].insert(i);
  for (const auto& [a, b] : edges) {
    rows[at(a)].insert(b);
    rows[at(b)].insert(a);
  }
  BlockPattern p;
  p.row_start.assign(1, 0);
  for (Index i = 0; i < vertices; ++i) {
    p.column.insert(p.column.end(), rows[at(i)].begin(), rows[at(i)].end());
    p.row_start.push_back(size_of(p.column));
    p.diagonal.push_back(p.slot(i, i));
  }
  return p;
}

template <class Element>
BlockPattern beam(std::array<Index, 3> cells, BlockSplit split) {
  const auto mesh = testing::block<double, Element>({.size = {1, 0.2, 0.2}, .cells = cells, .split = split});
  return BlockPattern::of(mesh.elements(), mesh.vertex_count());
}

/// The edges of a random graph on vertices [first, first + vertices).
void add_random_edges(Random& random, Index first, Index vertices, Index count,
                      std::vector<std::pair<Index, Index>>& edges) {
  const auto vertex = [&] { return first + static_cast<Index>(random.uniform(0, vertices)); };
  for (Index e = 0; e < count; ++e) {
    const Index a = vertex(), b = vertex();
    edges.emplace_back(a, b);
  }
}

std::vector<Index> natural_order(const BlockPattern& pattern) {
  std::vector<Index> order(at(pattern.rows()));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<Index> order_by_eigen(const BlockPattern& pattern) {
  using Graph = Eigen::SparseMatrix<char, Eigen::ColMajor, Index>;
  const std::vector<char> ones(pattern.column.size(), 1);
  const Graph graph = Eigen::Map<const Graph>(pattern.rows(), pattern.rows(), pattern.blocks(),
                                              pattern.row_start.data(), pattern.column.data(), ones.data());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> permutation;
  Eigen::AMDOrdering<Index>()(graph, permutation);
  return {permutation.indices().data(), permutation.indices().data() + pattern.rows()};
}

/// Blocks of L in that order, the diagonal included.
std::size_t fill(const BlockPattern& pattern, std::vector<Index> order) {
  return detail::SymbolicFactor(pattern, std::move(order)).blocks;
}

/// The least that a factor can have: the lower triangle of the matrix.
std::size_t lower_blocks(const BlockPattern& pattern) { return at(pattern.blocks() + pattern.rows()) / 2; }

void expect_lawful(const BlockPattern& pattern) {
  const std::vector<Index> order = detail::MinimumDegree::order(pattern);
  std::vector<Index> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted, natural_order(pattern)) << "not a permutation";
  EXPECT_EQ(detail::MinimumDegree::order(pattern), order);
}

constexpr std::array both_splits{BlockSplit::kuhn6, BlockSplit::alternating5};

TEST(MinimumDegree, GivesAPermutationForBeams) {
  for (const BlockSplit split : both_splits)
    for (const std::array<Index, 3>& cells : {std::array<Index, 3>{1, 1, 1}, {5, 1, 1}, {8, 3, 2}, {20, 4, 4}}) {
      expect_lawful(beam<Tet4>(cells, split));
      expect_lawful(beam<Tet10>(cells, split));
    }
}

/// Of one part or several, from hardly any edges to nearly all, with rows that hold nothing but the diagonal.
TEST(MinimumDegree, GivesAPermutationForRandomGraphs) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<std::pair<Index, Index>> edges;
    Index vertices = 0;
    for (auto parts = static_cast<int>(random.uniform(1, 4)); parts > 0; --parts) {
      const auto count = static_cast<Index>(random.uniform(1, 40));
      const double most = 0.5 * count * count, density = random.uniform();
      add_random_edges(random, vertices, count, static_cast<Index>(density * density * most), edges);
      vertices += count;
    }
    const BlockPattern pattern = pattern_of(vertices + static_cast<Index>(random.uniform(0, 5)), edges);
    expect_lawful(pattern);
    EXPECT_LE(fill(pattern, detail::MinimumDegree::order(pattern)), fill(pattern, order_by_eigen(pattern)) * 5 / 4 + 5)
        << "blocks " << pattern.blocks();
  }
}

TEST(MinimumDegree, GivesAPermutationForTheSmallestGraphs) {
  expect_lawful(pattern_of(0, {}));
  expect_lawful(pattern_of(1, {}));
  expect_lawful(pattern_of(2, {{0, 1}}));
  expect_lawful(pattern_of(7, {}));
}

/// Where an order without fill exists and least degrees lead to it, there is none.
TEST(MinimumDegree, FillsNothingInTreesAndDenseGraphs) {
  constexpr Index n = 200;
  Random random(1);
  std::vector<Index> name(n);  // so that their numbers do not help
  std::iota(name.begin(), name.end(), 0);
  for (Index i = n - 1; i > 0; --i) std::swap(name[at(i)], name[at(static_cast<Index>(random.uniform(0, i + 1)))]);
  std::vector<std::pair<Index, Index>> path, star, tree, dense;
  for (Index i = 1; i < n; ++i) {
    path.emplace_back(name[at(i - 1)], name[at(i)]);
    star.emplace_back(name[0], name[at(i)]);
    tree.emplace_back(name[at(static_cast<Index>(random.uniform(0, i)))], name[at(i)]);
    for (Index j = 0; j < i; ++j) dense.emplace_back(i, j);
  }
  for (const auto* edges : {&path, &star, &tree, &dense}) {
    const BlockPattern pattern = pattern_of(n, *edges);
    expect_lawful(pattern);
    EXPECT_EQ(fill(pattern, detail::MinimumDegree::order(pattern)), lower_blocks(pattern));
  }
}

TEST(MinimumDegree, FillsAboutAsLittleAsEigensOrder) {
  for (const BlockSplit split : both_splits)
    for (const std::array<Index, 3>& cells :
         {std::array<Index, 3>{6, 2, 2}, {20, 2, 2}, {20, 4, 4}, {40, 6, 6}, {10, 10, 10}})
      for (const bool quadratic : {false, true}) {
        if (quadratic && cells[1] > 4) continue;
        const BlockPattern pattern = quadratic ? beam<Tet10>(cells, split) : beam<Tet4>(cells, split);
        const std::size_t ours = fill(pattern, detail::MinimumDegree::order(pattern)),
                          eigens = fill(pattern, order_by_eigen(pattern));
        std::printf("%s %d x %d x %d cells, order %d: %.3f of the blocks\n",
                    split == BlockSplit::kuhn6 ? "Kuhn" : "alternating", cells[0], cells[1], cells[2],
                    quadratic ? 2 : 1, double(ours) / double(eigens));
        EXPECT_LE(double(ours), 1.25 * double(eigens));
      }
}

/// Numbers along x first, as a grid has, give a band that is as wide as a layer along x and y.
TEST(MinimumDegree, FillsFarLessThanTheOrderOfAGrid) {
  for (const BlockSplit split : both_splits) {
    const BlockPattern pattern = beam<Tet4>({40, 6, 6}, split);
    EXPECT_LT(fill(pattern, detail::MinimumDegree::order(pattern)), fill(pattern, natural_order(pattern)) / 4);
  }
}

}  // namespace
}  // namespace corotet::minimum_degree_test
