// What the tests of readers and writers share: where the data lies, and what makes two meshes the same.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/mesh/validate.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

namespace corotet {

inline std::filesystem::path data_dir() { return std::filesystem::path(__FILE__).parent_path().parent_path() / "data"; }

/// A folder of this test alone, removed at its end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::path(::testing::TempDir()) / "corotet-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// True if the command line works here; for the tests that run other programs.
inline bool runs(const std::string& command) { return std::system((command + " > /dev/null 2>&1").c_str()) == 0; }

inline void expect_same(const MeshData& a, const MeshData& b) {
  EXPECT_EQ(a.nodes_per_element, b.nodes_per_element);
  EXPECT_EQ(a.connectivity, b.connectivity);
  EXPECT_EQ(a.regions, b.regions);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (std::size_t v = 0; v < a.positions.size(); ++v) EXPECT_EQ(a.positions[v], b.positions[v]) << "vertex " << v;
}

/// Greatest distance of a mid-edge node from the middle of its edge, m: 0 for a straight mesh in the right node order.
inline double worst_middle(const MeshData& mesh) {
  double worst = 0;
  for (std::size_t first = 0; mesh.nodes_per_element == 10 && first < mesh.connectivity.size(); first += 10) {
    const auto node = [&](std::size_t k) -> const Vec3<double>& {
      return mesh.positions[at(mesh.connectivity[first + k])];
    };
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3<double> middle = (node(tet_edges[k].a) + node(tet_edges[k].b)) / 2;
      worst = std::max(worst, (node(4 + k) - middle).norm());
    }
  }
  return worst;
}

/// Volume of each region, m^3.
inline std::map<int, double> region_volumes(const MeshData& mesh) {
  std::map<int, double> volumes;
  for (std::size_t e = 0; e < at(mesh.element_count()); ++e)
    volumes[mesh.regions.empty() ? 0 : mesh.regions[e]] += std::abs(detail::corner_volume(
        mesh.positions, mesh.connectivity.data() + e * static_cast<std::size_t>(mesh.nodes_per_element)));
  return volumes;
}

inline bool is_valid_mesh(MeshData mesh) {
  if (mesh.nodes_per_element == 4) return TetMesh<double, Tet4>::create(remove_unreferenced(std::move(mesh))).ok();
  return TetMesh<double, Tet10>::create(remove_unreferenced(std::move(mesh))).ok();
}

/// A block with coordinates that have no short decimal form, and regions that change within and between runs.
inline MeshData awkward_mesh(int order, bool with_regions) {
  BlockOptions options;
  options.cells = {3, 2, 2};
  options.size = {1.0 / 3, 2e-7 / 7, 1e5 / 3};
  options.corner = {-0.1, 1e-300, 12345.678901234567};
  options.order = order;
  MeshData mesh = make_block(options).value();
  for (Index e = 0; with_regions && e < mesh.element_count(); ++e) mesh.regions.push_back((e / 3 % 4) * 5 - 5);
  return mesh;
}

}  // namespace corotet
