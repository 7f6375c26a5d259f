// Meshes that gmsh and TetGen wrote: those in tests/data/real, and fresh ones where the programs are installed.
#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

/// gmsh writes 16 digits, so text and binary files of the same mesh differ in the last bits.
constexpr double last_digits = 4e-16;

MeshData read_real(const std::filesystem::path& path) {
  auto mesh = read_mesh(path);
  EXPECT_TRUE(mesh) << mesh.error().message();
  if (!mesh) return {};
  EXPECT_LE(worst_middle(*mesh), last_digits) << path;
  EXPECT_TRUE(is_valid_mesh(*mesh)) << path;
  return std::move(*mesh);
}

void expect_volumes(const MeshData& mesh, const std::map<int, double>& expected, const std::filesystem::path& path) {
  const auto volumes = region_volumes(mesh);
  EXPECT_EQ(volumes.size(), expected.size()) << path;
  for (const auto& [region, volume] : expected) {
    ASSERT_EQ(volumes.count(region), 1u) << path << ", region " << region;
    EXPECT_NEAR(volumes.find(region)->second, volume, 1e-12) << path << ", region " << region;
  }
}

/// CGAL's Medit file of a beam: it fills the box, apart from the four flat cells that CGAL leaves on the faces.
TEST(RealFiles, CgalCommitted) {
  const auto mesh = read_mesh(data_dir() / "real/medit/cgal.mesh");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->vertex_count(), 245);
  EXPECT_EQ(mesh->element_count(), 589);
  double volume = 0;
  for (Index e = 0; e < mesh->element_count(); ++e)
    volume += detail::corner_volume(mesh->positions, &mesh->connectivity[at(4 * e)]);
  EXPECT_NEAR(volume, 0.01, 1e-12);
}

/// All files of the two cubes: four .msh variants of one order hold the same mesh; physical groups are the regions.
void check_gmsh_folder(const std::filesystem::path& folder) {
  for (const std::string order : {"1", "2"}) {
    const MeshData first = read_real(folder / "msh" / ("ascii22-order" + order + ".msh"));
    EXPECT_EQ(first.nodes_per_element, order == "1" ? 4 : 10);
    for (const std::string variant : {"ascii22", "binary22", "ascii41", "binary41"}) {
      const auto path = folder / "msh" / (variant + "-order" + order + ".msh");
      const MeshData mesh = read_real(path);
      expect_volumes(mesh, {{7, 1.0}, {9, 1.0}}, path);
      ASSERT_EQ(mesh.notes.size(), 1u) << path;
      EXPECT_EQ(mesh.notes[0], "ignored 4 points, lines and surface elements");
      EXPECT_EQ(mesh.connectivity, first.connectivity) << path;
      EXPECT_EQ(mesh.regions, first.regions) << path;
      ASSERT_EQ(mesh.positions.size(), first.positions.size());
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        EXPECT_LE((mesh.positions[v] - first.positions[v]).norm(), last_digits) << path << ", vertex " << v;
    }
    // gmsh gives these two formats the numbers of its volumes, 1 and 2, and cells of .vtk no number that we read.
    const auto medit = folder / "medit" / ("order" + order + ".mesh");
    expect_volumes(read_real(medit), {{1, 1.0}, {2, 1.0}}, medit);
    EXPECT_EQ(read_real(medit).connectivity, first.connectivity);
    for (const std::string mode : {"ascii", "binary"}) {
      const auto vtk = folder / "vtk" / (mode + "-order" + order + ".vtk");
      expect_volumes(read_real(vtk), {{0, 2.0}}, vtk);
      EXPECT_EQ(read_real(vtk).connectivity, first.connectivity);
    }
  }
  // A volume in two physical groups counts once, in the first of them.
  for (const std::string variant :
       {"two_groups22", "two_groups22-binary", "two_groups41", "two_groups41-binary", "partitioned41"}) {
    const auto path = folder / "msh" / (variant + ".msh");
    expect_volumes(read_real(path), {{7, 1.0}}, path);
  }
}

void check_tetgen_folder(const std::filesystem::path& folder) {
  const MeshData from1 = read_real(folder / "tetgen/from1.1.ele"), from0 = read_real(folder / "tetgen/from0.1.node"),
                 curved = read_real(folder / "tetgen/order2.1.ele");
  expect_same(from1, from0);
  for (const MeshData& mesh : {from1, from0, curved}) expect_volumes(mesh, {{42, 1.0}}, folder);
  EXPECT_EQ(from1.notes, std::vector<std::string>{"vertex numbers start at 1"});
  EXPECT_EQ(from0.notes, std::vector<std::string>{"vertex numbers start at 0"});
  EXPECT_EQ(from1.nodes_per_element, 4);
  EXPECT_EQ(curved.nodes_per_element, 10);
}

TEST(RealFiles, GmshCommitted) { check_gmsh_folder(data_dir() / "real"); }

TEST(RealFiles, TetGenCommitted) { check_tetgen_folder(data_dir() / "real"); }

/// A copy of the inputs, from which make.sh makes everything afresh.
bool make_fresh(const TemporaryFolder& folder) {
  const std::string from = (data_dir() / "real/").string(), to = (folder / "").string();
  return runs("cp " + from + "make.sh " + from + "*.geo " + from + "brick.poly " + to + " && cd " + to +
              " && mkdir msh medit vtk tetgen && sh ./make.sh");
}

TEST(RealFiles, FreshFromGmshAndTetGen) {
  if (!runs("gmsh -version") || !runs("command -v tetgen")) GTEST_SKIP() << "gmsh or tetgen is not installed";
  const TemporaryFolder folder;
  ASSERT_TRUE(make_fresh(folder));
  check_gmsh_folder(folder / "");
  check_tetgen_folder(folder / "");
}

/// The node orders hold for curved meshes too: gmsh's own quality of a curved ball needs every Jacobian positive.
TEST(RealFiles, FreshCurvedBallFromGmsh) {
  if (!runs("gmsh -version")) GTEST_SKIP() << "gmsh is not installed";
  const TemporaryFolder folder;
  const std::string out = (folder / "ball.msh").string(), geo = (folder / "ball.geo").string();
  ASSERT_TRUE(write_file(geo,
                         "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\n"
                         "Mesh.MeshSizeMax = 0.7;\n"));
  ASSERT_TRUE(runs("gmsh -v 1 -3 -order 2 " + geo + " -format msh41 -bin -o " + out));
  const auto mesh = read_mesh(out);
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_GT(worst_middle(*mesh), 0.01);  // curved
  EXPECT_LT(worst_middle(*mesh), 0.2);   // but each node at its own edge
  EXPECT_TRUE(is_valid_mesh(*mesh));
  EXPECT_TRUE(mesh->regions.empty());
}

}  // namespace
}  // namespace corotet
