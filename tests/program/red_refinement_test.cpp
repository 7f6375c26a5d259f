// Each element in eight: the same body, conforming, right side out.
#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <utility>

#include "report/red_refinement.hpp"

namespace red_refinement_test {
namespace {

using namespace corotet;

double volume(const MeshData& mesh, std::size_t element) {
  const auto x = [&](std::size_t k) { return mesh.positions[at(mesh.connectivity[4 * element + k])]; };
  return (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6;
}

TEST(RedRefinement, SplitsEachElementInEightOfTheSameVolume) {
  for (const BlockSplit split : {BlockSplit::kuhn6, BlockSplit::alternating5})
    for (const int order : {1, 2}) {
      MeshData block = *make_block({.size = {1, 2, 3}, .cells = {2, 1, 2}, .split = split, .order = order});
      // Off the grid, and one element the other way round: nothing may depend on either.
      for (Vec3<double>& x : block.positions) x += 0.1 * Vec3<double>(x.y() * x.z(), x.x() * x.x(), 0);
      block = lower_order(std::move(block));
      std::swap(block.connectivity[0], block.connectivity[1]);
      block.regions.assign(at(block.element_count()), 3);
      block.regions.back() = 4;
      const Index elements = block.element_count();
      const MeshData fine = program::refine_red(block);
      ASSERT_EQ(fine.element_count(), 8 * elements);
      ASSERT_EQ(fine.regions.size(), at(fine.element_count()));
      EXPECT_EQ(std::count(fine.regions.begin(), fine.regions.end(), 4), 8);
      for (Index e = 0; e < elements; ++e)
        for (Index child = 8 * e; child < 8 * e + 8; ++child)
          EXPECT_NEAR(volume(fine, at(child)), volume(block, at(e)) / 8, 1e-12) << e << " " << child - 8 * e;

      // Conforming: the boundary has four triangles for each one before, and no more.
      const auto coarse_boundary = extract_boundary(block), fine_boundary = extract_boundary(fine);
      ASSERT_TRUE(coarse_boundary && fine_boundary);
      EXPECT_EQ(fine_boundary->triangles.size(), 4 * coarse_boundary->triangles.size());
      EXPECT_TRUE((TetMesh<double, Tet4>::create(fine)));
    }
}

}  // namespace
}  // namespace red_refinement_test
