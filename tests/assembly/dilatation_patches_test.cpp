// Patches of mean dilatation: what every grouping must be, and what comes out for structured and for ragged meshes.
#include <corotet/detail/assembly/dilatation_patches.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/bodies.hpp"

namespace corotet::dilatation_patches_test {
namespace {

using testing::distorted_block;

/// Each element once, and the vertices of each patch those of its elements, few enough for the pattern.
void expect_partition(const TetMesh<double, Tet4>& mesh, const detail::DilatationPatches& patches) {
  std::vector<int> uses(at(mesh.element_count()), 0);
  ASSERT_EQ(patches.vertices.count(), patches.count());
  for (Index p = 0; p < patches.count(); ++p) {
    std::set<Index> vertices;
    for (Index k = patches.start[at(p)]; k < patches.start[at(p) + 1]; ++k) {
      ++uses[at(patches.element[at(k)])];
      const auto& nodes = mesh.element(patches.element[at(k)]);
      vertices.insert(nodes.begin(), nodes.end());
    }
    const auto begin = patches.vertices.vertex.begin();
    EXPECT_EQ(std::vector<Index>(vertices.begin(), vertices.end()),
              std::vector<Index>(begin + patches.vertices.start[at(p)], begin + patches.vertices.start[at(p) + 1]));
    EXPECT_LE(vertices.size(), 12U);
  }
  EXPECT_TRUE(std::all_of(uses.begin(), uses.end(), [](int n) { return n == 1; }));
}

[[nodiscard]] Index elements_of(const detail::DilatationPatches& patches, Index p) {
  return patches.start[at(p) + 1] - patches.start[at(p)];
}

/// make_block writes cell after cell, so that a whole cell is a run of five or six elements. In float, rounding of the
/// positions must not change that; nor must long or flat cells.
template <class Scalar>
void expect_whole_cells(const Vec3<double>& size, BlockSplit split) {
  const Index of_cell = split == BlockSplit::kuhn6 ? 6 : 5;
  const auto mesh = testing::block<Scalar, Tet4>({.size = size, .cells = {7, 4, 3}, .split = split});
  const detail::DilatationPatches patches = detail::dilatation_patches(mesh);
  EXPECT_EQ(patches.count(), 7 * 4 * 3);
  for (Index p = 0; p < patches.count(); ++p) {
    const Index first = patches.element[at(patches.start[at(p)])];
    EXPECT_EQ(first % of_cell, 0);
    EXPECT_EQ(elements_of(patches, p), of_cell);
    EXPECT_EQ(patches.element[at(patches.start[at(p) + 1] - 1)], first + of_cell - 1);
  }
}

TEST(DilatationPatches, AreTheCellsOfABlock) {
  for (const Vec3<double>& size : {Vec3<double>(7, 4, 3), Vec3<double>(0.7, 0.4, 0.45), Vec3<double>(14, 4, 3)})
    for (const BlockSplit split : {BlockSplit::kuhn6, BlockSplit::alternating5}) {
      expect_whole_cells<double>(size, split);
      expect_whole_cells<float>(size, split);
    }
}

/// A distorted block from which half of the elements were taken, in lumps and singly: patches have to be made of what
/// is left. Where they can be joined they are not small.
TEST(DilatationPatches, CoverAnyMesh) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const BlockSplit split : {BlockSplit::kuhn6, BlockSplit::alternating5}) {
      MeshData data =
          distorted_block<double, Tet4>({.size = {6, 5, 4}, .cells = {6, 5, 4}, .split = split}, 0.3, seed).data();
      testing::Random random(seed);
      MeshData ragged = data;
      ragged.connectivity.clear();
      for (std::size_t e = 0; 4 * e < data.connectivity.size(); ++e) {
        const Vec3<double>& x = data.positions[at(data.connectivity[4 * e])];
        const double keep = x.x() < 3 ? 1 : 0.5;
        if (random.uniform(0, 1) < keep)
          ragged.connectivity.insert(ragged.connectivity.end(), data.connectivity.begin() + std::ptrdiff_t(4 * e),
                                     data.connectivity.begin() + std::ptrdiff_t(4 * e + 4));
      }
      const auto mesh = testing::must(TetMesh<double, Tet4>::create(remove_unreferenced(std::move(ragged))));
      const detail::DilatationPatches patches = detail::dilatation_patches(mesh);
      expect_partition(mesh, patches);
      Index small = 0;
      for (Index p = 0; p < patches.count(); ++p) small += elements_of(patches, p) < 3 ? 1 : 0;
      EXPECT_LT(small, patches.count() / 5);
    }
}

TEST(DilatationPatches, OneElementIsOnePatch) {
  MeshData data;
  data.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  data.connectivity = {0, 1, 2, 3};
  const auto mesh = testing::must(TetMesh<double, Tet4>::create(data));
  const detail::DilatationPatches patches = detail::dilatation_patches(mesh);
  ASSERT_EQ(patches.count(), 1);
  expect_partition(mesh, patches);
}

/// Blocks of the pattern: those of elements, and of patches besides; each group's pair contributes once to its block.
TEST(DilatationPatches, WidenThePattern) {
  const auto mesh = distorted_block<double, Tet4>({.size = {3, 2, 2}, .cells = {3, 2, 2}}, 0.2, 3);
  const Stencils groups = detail::dilatation_patches(mesh).vertices;
  const BlockPattern pattern = BlockPattern::of(mesh.elements(), mesh.vertex_count(), groups);
  std::set<std::pair<Index, Index>> expected;
  const auto add_all = [&](auto begin, auto end) {
    for (auto i = begin; i != end; ++i)
      for (auto j = begin; j != end; ++j) expected.insert({*i, *j});
  };
  for (const auto& nodes : mesh.elements()) add_all(nodes.begin(), nodes.end());
  const std::size_t of_elements = expected.size();
  for (Index g = 0; g < groups.count(); ++g)
    add_all(groups.vertex.begin() + groups.start[at(g)], groups.vertex.begin() + groups.start[at(g) + 1]);
  EXPECT_GT(expected.size(), of_elements);
  ASSERT_EQ(at(pattern.blocks()), expected.size());
  for (const auto& [i, j] : expected) EXPECT_EQ(pattern.column[at(pattern.slot(i, j))], j);

  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t u = 0; u < pattern.upper.size(); ++u)
    for (Index c = pattern.stencil_contribution_start[u]; c < pattern.stencil_contribution_start[u + 1]; ++c) {
      const Index code = pattern.stencil_contribution[at(c)];
      const std::size_t row = BlockPattern::row_of_stencil(code), column = BlockPattern::column_of_stencil(code);
      EXPECT_EQ(groups.vertex[row], pattern.column[at(pattern.upper[u].mirror)]);
      EXPECT_EQ(groups.vertex[column], pattern.column[at(pattern.upper[u].slot)]);
      EXPECT_TRUE(pairs.insert({row, column}).second);
    }
  std::size_t all = 0;
  for (Index g = 0; g < groups.count(); ++g) {
    const auto n = at(groups.start[at(g) + 1] - groups.start[at(g)]);
    all += n * (n + 1) / 2;
  }
  EXPECT_EQ(pairs.size(), all);
}

}  // namespace
}  // namespace corotet::dilatation_patches_test
