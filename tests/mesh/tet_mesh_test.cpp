// What TetMesh::create promises, and refuses by name; raising and lowering the order; structured blocks.
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "support/bodies.hpp"

namespace corotet {
namespace {

using testing::must;

MeshData one_tet(int nodes = 4) {
  MeshData data;
  data.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  data.connectivity = {0, 1, 2, 3};
  return nodes == 10 ? raise_order(std::move(data)) : data;
}

template <class Element, class Scalar = double>
void expect_refused(const MeshData& data, ErrorCode code, const std::string& where) {
  const auto mesh = TetMesh<Scalar, Element>::create(data);
  ASSERT_FALSE(mesh.ok()) << where;
  EXPECT_EQ(mesh.error().code, code) << mesh.error().message();
  EXPECT_EQ(mesh.error().where, where);
  EXPECT_FALSE(mesh.error().reason.empty());
}

TEST(TetMeshCreate, RefusesEveryKindOfBadMeshByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  expect_refused<Tet4>({}, ErrorCode::empty_mesh, "mesh");
  MeshData no_elements = one_tet();
  no_elements.connectivity.clear();
  expect_refused<Tet4>(no_elements, ErrorCode::empty_mesh, "mesh");

  for (const Index bad : {4, -1, std::numeric_limits<Index>::max(), std::numeric_limits<Index>::min()}) {
    MeshData data = one_tet();
    data.connectivity[2] = bad;
    expect_refused<Tet4>(data, ErrorCode::index_out_of_range, "element 0");
  }
  MeshData twice = one_tet();
  twice.connectivity[3] = 1;
  expect_refused<Tet4>(twice, ErrorCode::duplicate_node, "element 0");

  MeshData lonely = one_tet();
  lonely.positions.emplace_back(5, 5, 5);
  expect_refused<Tet4>(lonely, ErrorCode::unreferenced_vertex, "vertex 4");

  for (const double bad : {nan, infinity, -infinity}) {
    MeshData data = one_tet();
    data.positions[1].y() = bad;
    expect_refused<Tet4>(data, ErrorCode::non_finite_value, "vertex 1");
  }
  MeshData huge = one_tet();  // fits double, not float
  huge.positions[3].z() = 1e300;
  expect_refused<Tet4, float>(huge, ErrorCode::non_finite_value, "vertex 3");

  MeshData flat_tet = one_tet();
  flat_tet.positions[3] = {0.5, 0.5, 0};
  expect_refused<Tet4>(flat_tet, ErrorCode::degenerate_element, "element 0");
  MeshData line = one_tet();
  for (Index v = 0; v < 4; ++v) line.positions[at(v)] = {double(v), 2.0 * v, 0};
  expect_refused<Tet4>(line, ErrorCode::degenerate_element, "element 0");
  MeshData point = one_tet();
  for (auto& x : point.positions) x.setZero();
  expect_refused<Tet4>(point, ErrorCode::degenerate_element, "element 0");
  MeshData folded = one_tet(10);
  folded.positions[at(folded.connectivity[4])] = {3, 3, 3};  // a mid-edge node far off its edge
  expect_refused<Tet10>(folded, ErrorCode::degenerate_element, "element 0");

  expect_refused<Tet10>(one_tet(), ErrorCode::invalid_argument, "mesh");
  expect_refused<Tet4>(one_tet(10), ErrorCode::invalid_argument, "mesh");
  MeshData ragged = one_tet();
  ragged.connectivity.push_back(0);
  expect_refused<Tet4>(ragged, ErrorCode::invalid_argument, "mesh");
  MeshData tags = one_tet();
  tags.regions = {1, 2};
  expect_refused<Tet4>(tags, ErrorCode::invalid_argument, "mesh");
}

/// A sliver is poor, but a body can have it: only volumes within rounding of zero are refused, at any size and place.
TEST(TetMeshCreate, JudgesVolumeRelativeToRounding) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    MeshData sliver = one_tet();
    sliver.positions[3] = {0.5, 0.5, 1e-3};
    for (auto& x : sliver.positions) x *= size;
    EXPECT_TRUE((TetMesh<float, Tet4>::create(sliver).ok())) << size;
    sliver.positions[3].z() = 1e-9 * size;
    EXPECT_FALSE((TetMesh<float, Tet4>::create(sliver).ok())) << size;
  }
  MeshData far = one_tet();
  for (auto& x : far.positions) x += Vec3<double>(1e9, 0, 0);  // a float grid of 64 m out there
  EXPECT_FALSE((TetMesh<float, Tet4>::create(far).ok()));
  const auto local = must(TetMesh<float, Tet4>::create(far, Vec3<double>(1e9, 0, 0)));
  EXPECT_EQ(local.position(1).x(), 1);
  EXPECT_EQ(local.data().positions[1].x(), 1e9 + 1);
}

template <class T>
class Winding : public ::testing::Test {};
using Elements = ::testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(Winding, Elements);

TYPED_TEST(Winding, IsFixedAndSaid) {
  MeshData data = must(make_block({.size = {1, 2, 3}, .cells = {2, 1, 1}, .order = TypeParam::order}));
  const auto straight = must(TetMesh<double, TypeParam>::create(data));
  EXPECT_EQ(straight.flipped_elements(), 0);

  // Mirror the first element's node order: an odd permutation of corners, with mid-edge nodes following their edges.
  MeshData mirrored = data;
  constexpr std::array<std::size_t, 10> exchange{1, 0, 2, 3, 4, 6, 5, 8, 7, 9};  // corners 0 and 1
  for (std::size_t a = 0; a < TypeParam::nodes; ++a) mirrored.connectivity[a] = data.connectivity[exchange[a]];
  const auto fixed = must(TetMesh<double, TypeParam>::create(mirrored));
  EXPECT_EQ(fixed.flipped_elements(), 1);
  const auto& nodes = fixed.element(0);
  EXPECT_GT(detail::corner_volume(data.positions, nodes.data()), 0);
  for (std::size_t e = 0; e + 4 < nodes.size(); ++e) {
    const auto [a, b] = tet_edges[e];
    const Vec3<double> middle = (fixed.position(nodes[a]) + fixed.position(nodes[b])) / 2;
    EXPECT_LT((fixed.position(nodes[4 + e]) - middle).norm(), 1e-15) << "mid-edge node " << e;
  }
}

TEST(RaiseOrder, PutsOneVertexInTheMiddleOfEachEdgeAndLowersBack) {
  MeshData data = must(make_block({.cells = {3, 2, 2}}));
  std::set<std::pair<Index, Index>> edges;
  for (std::size_t first = 0; first < data.connectivity.size(); first += 4)
    for (const auto [a, b] : tet_edges)
      edges.insert(std::minmax(data.connectivity[first + a], data.connectivity[first + b]));
  const MeshData raised = raise_order(data);
  EXPECT_EQ(raised.vertex_count(), data.vertex_count() + static_cast<Index>(edges.size()));
  for (std::size_t first = 0; first < raised.connectivity.size(); first += 10)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto x = [&](std::size_t a) { return raised.positions[at(raised.connectivity[first + a])]; };
      EXPECT_EQ(x(4 + e), ((x(tet_edges[e].a) + x(tet_edges[e].b)) / 2));
    }
  const MeshData lowered = lower_order(raised);
  EXPECT_EQ(lowered.connectivity, data.connectivity);
  EXPECT_EQ(lowered.positions, data.positions);
  EXPECT_EQ(raise_order(raised).connectivity, raised.connectivity);
}

TEST(RemoveUnreferenced, DropsRenumbersAndSaysSo) {
  MeshData data = one_tet();
  data.positions.insert(data.positions.begin(), Vec3<double>(9, 9, 9));
  data.positions.emplace_back(8, 8, 8);
  for (Index& v : data.connectivity) ++v;
  const MeshData clean = remove_unreferenced(data);
  EXPECT_EQ(clean.positions, one_tet().positions);
  EXPECT_EQ(clean.connectivity, one_tet().connectivity);
  ASSERT_EQ(clean.notes.size(), 1u);
  EXPECT_NE(clean.notes[0].find('2'), std::string::npos);
  EXPECT_TRUE(remove_unreferenced(one_tet()).notes.empty());
}

TEST(MakeBlock, FillsTheBoxWithElementsOfEitherSplitAndOrder) {
  for (const BlockSplit split : {BlockSplit::kuhn6, BlockSplit::alternating5})
    for (const int order : {1, 2}) {
      const MeshData data = must(
          make_block({.corner = {-1, 0, 2}, .size = {3, 2, 1}, .cells = {4, 3, 2}, .split = split, .order = order}));
      EXPECT_EQ(data.element_count(), 4 * 3 * 2 * (split == BlockSplit::kuhn6 ? 6 : 5));
      double volume = 0;
      for (Index e = 0; e < data.element_count(); ++e) {
        const double v = detail::corner_volume(data.positions, &data.connectivity[at(e * data.nodes_per_element)]);
        EXPECT_GT(v, 0);
        volume += v;
      }
      EXPECT_NEAR(volume, 6, 1e-13);
      Vec3<double> least = data.positions.front(), most = least;
      for (const auto& x : data.positions) {
        least = least.cwiseMin(x);
        most = most.cwiseMax(x);
      }
      EXPECT_LT((least - Vec3<double>(-1, 0, 2)).norm() + (most - Vec3<double>(2, 2, 3)).norm(), 1e-15);
    }
}

TEST(MakeBlock, RefusesWhatItCannotMakeByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const BlockOptions& options, const char* where) {
    const auto block = make_block(options);
    ASSERT_FALSE(block.ok());
    EXPECT_EQ(block.error().where, where);
  };
  refused({.cells = {0, 1, 1}}, "cells");
  refused({.cells = {1, -3, 1}}, "cells");
  refused({.cells = {2000000000, 2000000000, 2}}, "cells");
  refused({.size = {1, 0, 1}}, "size");
  refused({.size = {1, nan, 1}}, "size");
  refused({.order = 3}, "order");
}

}  // namespace
}  // namespace corotet
