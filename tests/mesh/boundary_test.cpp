#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <map>
#include <random>
#include <set>

namespace corotet {
namespace {

/// Volume enclosed by triangles wound outwards, by the divergence theorem: the sum of tetrahedra over a fixed point.
double enclosed_volume(const SurfaceMesh& surface) {
  double volume = 0;
  for (const auto& [a, b, c] : surface.triangles)
    volume += surface.positions[at(a)].cross(surface.positions[at(b)]).dot(surface.positions[at(c)]) / 6;
  return volume;
}

/// How often each directed edge is used.
std::map<std::pair<Index, Index>, int> directed_edges(const SurfaceMesh& surface) {
  std::map<std::pair<Index, Index>, int> uses;
  for (const auto& t : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++uses[{t[i], t[(i + 1) % 3]}];
  return uses;
}

void expect_closed(const SurfaceMesh& surface) {
  const auto uses = directed_edges(surface);
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(uses.count({edge.second, edge.first}), 1u);
  }
}

int euler_characteristic(const SurfaceMesh& surface) {
  std::set<std::pair<Index, Index>> edges;
  for (const auto& [edge, count] : directed_edges(surface)) edges.insert(std::minmax(edge.first, edge.second));
  return static_cast<int>(surface.positions.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(surface.triangles.size());
}

MeshData block(int order, BlockSplit split, std::array<Index, 3> cells) {
  BlockOptions options;
  options.cells = cells;
  options.corner = Vec3<double>(0.5, -2, 3);
  options.size = Vec3<double>(2, 1, 0.5);
  options.split = split;
  options.order = order;
  return make_block(options).value();
}

/// Moves every vertex a little (of 10-node meshes too: their edges become curved), and turns every third element round.
void disturb(MeshData& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> step(-0.01, 0.01);
  for (Vec3<double>& x : mesh.positions) x += Vec3<double>(step(random), step(random), step(random));
  for (Index e = 0; e < mesh.element_count(); e += 3) {
    Index* nodes = mesh.connectivity.data() + std::ptrdiff_t{e} * mesh.nodes_per_element;
    std::swap(nodes[1], nodes[2]);
    if (mesh.nodes_per_element == 10) {
      std::swap(nodes[4], nodes[6]);
      std::swap(nodes[8], nodes[9]);
    }
  }
}

/// The mesh cut by the four-triangle faces of its elements: what the boundary of a 10-node mesh encloses.
double element_volumes(const MeshData& mesh) {
  double volume = 0;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    MeshData one;
    one.positions = mesh.positions;
    one.nodes_per_element = mesh.nodes_per_element;
    const auto first = mesh.connectivity.begin() + std::ptrdiff_t{e} * mesh.nodes_per_element;
    one.connectivity.assign(first, first + mesh.nodes_per_element);
    volume += enclosed_volume(compact_surface(*extract_boundary(one), one.positions).surface);
  }
  return volume;
}

class Boundary : public ::testing::TestWithParam<std::tuple<int, BlockSplit>> {};

TEST_P(Boundary, IsClosedOutwardAndEnclosesTheVolume) {
  const auto [order, split] = GetParam();
  const MeshData mesh = block(order, split, {4, 3, 2});
  const CompactSurface compact = compact_surface(extract_boundary(mesh).value(), mesh.positions);
  expect_closed(compact.surface);
  EXPECT_EQ(euler_characteristic(compact.surface), 2);
  EXPECT_NEAR(enclosed_volume(compact.surface), 1.0, 1e-12);
  // Two triangles a cell side, four times as many with mid-edge nodes.
  EXPECT_EQ(compact.surface.triangles.size(), 2u * 2 * (4 * 3 + 3 * 2 + 4 * 2) * (order == 1 ? 1 : 4));
}

TEST_P(Boundary, OfDisturbedAndPartlyTurnedMeshEnclosesItsElements) {
  const auto [order, split] = GetParam();
  MeshData mesh = block(order, split, {3, 3, 3});
  disturb(mesh);
  const CompactSurface compact = compact_surface(extract_boundary(mesh).value(), mesh.positions);
  expect_closed(compact.surface);
  EXPECT_EQ(euler_characteristic(compact.surface), 2);
  EXPECT_NEAR(enclosed_volume(compact.surface), element_volumes(mesh), 1e-12);
  EXPECT_GT(enclosed_volume(compact.surface), 0.9);
}

TEST_P(Boundary, TrianglesNameTheElementBehindThem) {
  const auto [order, split] = GetParam();
  const MeshData mesh = block(order, split, {2, 2, 2});
  const BoundarySurface boundary = extract_boundary(mesh).value();
  ASSERT_EQ(boundary.elements.size(), boundary.triangles.size());
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    const auto first = mesh.connectivity.begin() + std::ptrdiff_t{boundary.elements[t]} * mesh.nodes_per_element;
    for (const Index v : boundary.triangles[t])
      EXPECT_NE(std::find(first, first + mesh.nodes_per_element, v), first + mesh.nodes_per_element);
  }
}

TEST_P(Boundary, OfCheckedMeshIsTheSame) {
  const auto [order, split] = GetParam();
  MeshData mesh = block(order, split, {2, 3, 2});
  disturb(mesh);
  const BoundarySurface expected = extract_boundary(mesh).value();
  const auto compare = [&]<class Element>(Element) {
    const auto checked = TetMesh<double, Element>::create(mesh);
    ASSERT_TRUE(checked.ok()) << checked.error().message();
    ASSERT_GT(checked->flipped_elements(), 0);
    const CompactSurface a = compact_surface(extract_boundary(*checked).value(), checked->positions());
    const CompactSurface b = compact_surface(expected, mesh.positions);
    EXPECT_EQ(a.volume_vertices, b.volume_vertices);
    EXPECT_EQ(a.surface.triangles.size(), b.surface.triangles.size());
    EXPECT_NEAR(enclosed_volume(a.surface), enclosed_volume(b.surface), 1e-13);
  };
  order == 1 ? compare(Tet4{}) : compare(Tet10{});
}

TEST_P(Boundary, CompactSurfaceKeepsPositionsAndMapsBack) {
  const auto [order, split] = GetParam();
  const MeshData mesh = block(order, split, {3, 3, 3});
  const BoundarySurface boundary = extract_boundary(mesh).value();
  const CompactSurface compact = compact_surface(boundary, mesh.positions);
  ASSERT_EQ(compact.volume_vertices.size(), compact.surface.positions.size());
  EXPECT_LT(compact.surface.positions.size(), mesh.positions.size());  // there are inner vertices
  EXPECT_TRUE(std::is_sorted(compact.volume_vertices.begin(), compact.volume_vertices.end()));
  for (std::size_t v = 0; v < compact.volume_vertices.size(); ++v)
    EXPECT_EQ(compact.surface.positions[v], mesh.positions[at(compact.volume_vertices[v])]);
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(compact.volume_vertices[at(compact.surface.triangles[t][i])], boundary.triangles[t][i]);
}

INSTANTIATE_TEST_SUITE_P(Meshes, Boundary,
                         testing::Combine(testing::Values(1, 2),
                                          testing::Values(BlockSplit::kuhn6, BlockSplit::alternating5)));

TEST(BoundaryTopology, OfARingHasEulerCharacteristicZero) {
  MeshData mesh = block(1, BlockSplit::alternating5, {3, 3, 1});
  MeshData ring = mesh;
  ring.connectivity.clear();
  for (Index e = 0; e < mesh.element_count(); ++e)
    if (e / 5 != 4)  // without the middle cell; cells come five elements at a time
      ring.connectivity.insert(ring.connectivity.end(), mesh.connectivity.begin() + 4 * e,
                               mesh.connectivity.begin() + 4 * e + 4);
  const CompactSurface compact = compact_surface(extract_boundary(ring).value(), ring.positions);
  expect_closed(compact.surface);
  EXPECT_EQ(euler_characteristic(compact.surface), 0);
  EXPECT_NEAR(enclosed_volume(compact.surface), 8.0 / 9.0, 1e-12);
}

TEST(BoundaryTopology, OfACavityIsWoundTowardsIt) {
  MeshData mesh = block(1, BlockSplit::kuhn6, {3, 3, 3});
  mesh.connectivity.erase(mesh.connectivity.begin() + 13 * 24, mesh.connectivity.begin() + 14 * 24);
  const CompactSurface compact = compact_surface(extract_boundary(mesh).value(), mesh.positions);
  EXPECT_EQ(euler_characteristic(compact.surface), 4);  // two spheres
  EXPECT_NEAR(enclosed_volume(compact.surface), 26.0 / 27.0, 1e-12);
}

MeshData three_at_a_face() {
  MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0.2, 0.2, 2}};
  mesh.connectivity = {0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5};
  return mesh;
}

TEST(BoundaryErrors, FaceOfThreeElementsIsNamed) {
  const auto result = extract_boundary(three_at_a_face());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(result.error().where, "element 0");
  EXPECT_NE(result.error().reason.find("(0, 1, 2) belongs to 3 elements"), std::string::npos);
}

TEST(BoundaryErrors, ElementsOnTheSameSideOfAFaceOverlap) {
  MeshData mesh = three_at_a_face();
  mesh.connectivity = {0, 1, 2, 3, 1, 0, 2, 5};
  const auto result = extract_boundary(mesh);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(result.error().reason.find("overlap"), std::string::npos);
  mesh.connectivity = {0, 1, 2, 3, 0, 1, 2, 3};
  EXPECT_FALSE(extract_boundary(mesh).ok());
  mesh.connectivity = {0, 1, 2, 3, 0, 1, 2, 4};
  EXPECT_TRUE(extract_boundary(mesh).ok());
}

TEST(BoundaryErrors, FlatElementIsTakenAsItIsWound) {
  MeshData mesh = three_at_a_face();
  mesh.positions[4] = {0.5, 0.5, 0};
  mesh.connectivity = {0, 1, 2, 3, 0, 2, 1, 4};
  const CompactSurface compact = compact_surface(extract_boundary(mesh).value(), mesh.positions);
  expect_closed(compact.surface);
  EXPECT_NEAR(enclosed_volume(compact.surface), 1.0 / 6, 1e-15);
}

TEST(BoundaryErrors, UncheckedArraysAreChecked) {
  MeshData mesh = three_at_a_face();
  mesh.connectivity = {0, 1, 2, 6};
  EXPECT_EQ(extract_boundary(mesh).error().code, ErrorCode::index_out_of_range);
  mesh.connectivity = {0, 1, 2, -1};
  EXPECT_EQ(extract_boundary(mesh).error().code, ErrorCode::index_out_of_range);
  mesh.connectivity = {0, 1, 2};
  EXPECT_EQ(extract_boundary(mesh).error().code, ErrorCode::invalid_argument);
  mesh.nodes_per_element = 0;
  EXPECT_EQ(extract_boundary(mesh).error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace corotet
