#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <limits>
#include <tuple>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

/// Version, binary, order, regions.
class MshVariants : public ::testing::TestWithParam<std::tuple<int, bool, int, bool>> {
 protected:
  MshOptions options{std::get<0>(GetParam()), std::get<1>(GetParam())};
  MeshData mesh = awkward_mesh(std::get<2>(GetParam()), std::get<3>(GetParam()));
};

TEST_P(MshVariants, RoundTripIsExact) {
  const auto content = format_msh(mesh, options);
  ASSERT_TRUE(content) << content.error().message();
  const auto back = read_msh(*content, "memory");
  ASSERT_TRUE(back) << back.error().message();
  expect_same(mesh, *back);
  EXPECT_TRUE(back->notes.empty());
}

TEST_P(MshVariants, RoundTripThroughAFileIsExact) {
  const TemporaryFolder folder;
  const Result<void> written = write_msh(folder / "mesh", mesh, options);
  ASSERT_TRUE(written) << written.error().message();
  const auto back = read_mesh(folder / "mesh");
  ASSERT_TRUE(back) << back.error().message();
  expect_same(mesh, *back);
}

TEST_P(MshVariants, VerticesWithoutAnElementAreKept) {
  mesh.positions.insert(mesh.positions.begin(), Vec3<double>(9, 9, 9));
  for (Index& v : mesh.connectivity) ++v;
  const auto back = read_msh(format_msh(mesh, options).value(), "memory");
  ASSERT_TRUE(back) << back.error().message();
  expect_same(mesh, *back);
  ASSERT_EQ(back->notes.size(), 1u);
  EXPECT_NE(back->notes[0].find("1 vertices belong to no tetrahedron"), std::string::npos);
}

/// Whatever the place where a file is cut, the result is an error or, behind the last element, the mesh; the places
/// near the start and the end are all tried, the others in steps.
TEST_P(MshVariants, TruncatedAnywhereIsAnError) {
  const std::string content = format_msh(mesh, options).value();
  const std::size_t last = content.size() - 1;  // the newline after $EndElements
  for (std::size_t size = 0; size < last; size += size < 200 || size + 200 > last ? 1 : 37) {
    const auto result = read_msh(std::string_view(content).substr(0, size), "cut");
    ASSERT_FALSE(result) << "cut at byte " << size;
    EXPECT_FALSE(result.error().where.empty());
    EXPECT_FALSE(result.error().reason.empty());
  }
}

std::vector<std::array<double, 3>> sorted(const std::vector<Vec3<double>>& positions) {
  std::vector<std::array<double, 3>> out;
  for (const Vec3<double>& x : positions) out.push_back({x[0], x[1], x[2]});
  std::sort(out.begin(), out.end());
  return out;
}

TEST_P(MshVariants, GmshReadsAndWritesItBack) {
  if (!runs("gmsh -version")) GTEST_SKIP() << "gmsh is not installed";
  if (!mesh.regions.empty())
    for (int& r : mesh.regions) r = std::abs(r) + 1;  // gmsh takes positive physical groups only
  const TemporaryFolder folder;
  ASSERT_TRUE(write_msh(folder / "in.msh", mesh, options));
  const std::string in = (folder / "in.msh").string(), out = (folder / "out.msh").string();
  ASSERT_TRUE(runs("gmsh -v 1 " + in + " -save -bin -format msh22 -o " + out));
  const auto back = read_mesh(out);
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(sorted(mesh.positions), sorted(back->positions));
  EXPECT_EQ(mesh.connectivity.size(), back->connectivity.size());
  // gmsh sorts vertices and elements by volume entity: compare what does not depend on their order.
  EXPECT_EQ(region_volumes(mesh).size(), region_volumes(*back).size());
  for (const auto& [region, volume] : region_volumes(mesh))
    EXPECT_NEAR(region_volumes(*back)[region], volume, 1e-12 * volume) << "region " << region;
  EXPECT_EQ(worst_middle(*back), worst_middle(mesh));
}

INSTANTIATE_TEST_SUITE_P(All, MshVariants,
                         ::testing::Combine(::testing::Values(22, 41), ::testing::Bool(), ::testing::Values(1, 2),
                                            ::testing::Bool()));

TEST(WriteMsh, RefusesBrokenMeshes) {
  MeshData mesh = awkward_mesh(1, false);
  EXPECT_EQ(format_msh(mesh, {40, false}).error().code, ErrorCode::invalid_argument);
  MeshData nan = mesh;
  nan.positions[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(format_msh(nan).error().code, ErrorCode::non_finite_value);
  EXPECT_EQ(format_msh(nan).error().where, "vertex 3");
  MeshData wild = mesh;
  wild.connectivity[5] = mesh.vertex_count();
  EXPECT_EQ(format_msh(wild).error().code, ErrorCode::index_out_of_range);
  MeshData odd = mesh;
  odd.nodes_per_element = 8;
  EXPECT_EQ(format_msh(odd).error().code, ErrorCode::invalid_argument);
  MeshData few = mesh;
  few.regions = {1, 2};
  EXPECT_EQ(format_msh(few).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(format_msh(MeshData{}).error().code, ErrorCode::empty_mesh);
}

TEST(WriteMsh, SaysWhereItCannotWrite) {
  const TemporaryFolder folder;
  const Result<void> status = write_msh(folder / "no/such/folder.msh", awkward_mesh(1, false));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::file_unreadable);
  EXPECT_NE(status.error().where.find("folder.msh"), std::string::npos);
}

}  // namespace
}  // namespace corotet
