// What all readers of tetrahedral meshes have in common: gathering elements, and the last checks and notes.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Where in the file's list of an element's nodes each of our nodes stands (4-node elements use the first four). Our
/// order is VTK's: corners, then the midpoints of the edges 01 12 02 03 13 23.
using NodeOrder = std::array<std::size_t, 10>;

/// VTK; also Medit, as libMeshb defines TetrahedraP2 and as gmsh writes it.
inline constexpr NodeOrder vtk_order{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
/// gmsh (reference manual, "Node ordering"): its last two edges are 23 and 13.
inline constexpr NodeOrder gmsh_order{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
/// TetGen with -o2: its edges are 23 03 01 12 13 02, found from the coordinates that TetGen 1.5 writes.
inline constexpr NodeOrder tetgen_order{0, 1, 2, 3, 6, 7, 9, 5, 8, 4};

/// The mesh being read.
class TetMeshBuilder {
 public:
  MeshData mesh;

  /// Announces elements of `nodes` (4 or 10) nodes. Fails the scanner if the mesh has elements of the other kind.
  template <class Scanner>
  bool begin(Scanner& in, int nodes) {
    if (!mesh.connectivity.empty() && mesh.nodes_per_element != nodes) {
      in.fail("the mesh mixes tetrahedra of 4 and of 10 nodes", ErrorCode::unsupported);
      return false;
    }
    mesh.nodes_per_element = nodes;
    return true;
  }

  /// Adds an element whose vertex indices are in the order of the file.
  void add(const std::array<Index, 10>& file_nodes, const NodeOrder& order, int region) {
    for (std::size_t k = 0; k < at(mesh.nodes_per_element); ++k) mesh.connectivity.push_back(file_nodes[order[k]]);
    mesh.regions.push_back(region);
  }

  /// Counts elements that are not tetrahedra of 4 or 10 nodes.
  void ignore(bool is_volume, std::size_t elements) { (is_volume ? ignored_volumes_ : ignored_others_) += elements; }

  void note(std::string text) { mesh.notes.push_back(std::move(text)); }

  /// The mesh with its notes; an Error if it has no vertices or no tetrahedra. `name` is the file's.
  Result<MeshData> finish(std::string_view name) {
    if (ignored_others_ != 0)
      note("ignored " + std::to_string(ignored_others_) + " points, lines and surface elements");
    if (ignored_volumes_ != 0)
      note("ignored " + std::to_string(ignored_volumes_) +
           " volume elements that are not tetrahedra of 4 or 10 nodes: the mesh has holes in their place");
    if (mesh.positions.empty()) return Error{ErrorCode::empty_mesh, std::string(name), "it has no vertices"};
    if (mesh.connectivity.empty()) {
      const std::string what = "it has no tetrahedra of 4 or 10 nodes";
      return Error{ErrorCode::empty_mesh, std::string(name),
                   mesh.notes.empty() ? what : what + " (" + mesh.notes.back() + ")"};
    }
    // All zero means that the file knows no regions: that is how gmsh and Medit write "none".
    if (std::all_of(mesh.regions.begin(), mesh.regions.end(), [](int r) { return r == 0; })) mesh.regions.clear();
    std::vector<bool> used(mesh.positions.size(), false);
    for (const Index v : mesh.connectivity) used[at(v)] = true;
    if (const auto lonely = std::count(used.begin(), used.end(), false); lonely != 0)
      note(std::to_string(lonely) + " vertices belong to no tetrahedron");
    return std::move(mesh);
  }

 private:
  std::size_t ignored_others_ = 0, ignored_volumes_ = 0;
};

/// Vertex numbers of formats that number their vertices without gaps from 0 or 1.
struct VertexRange {
  std::int64_t first = 0;
  std::size_t count = 0;

  /// The 0-based index of vertex `number`; fails the scanner if there is no such vertex.
  template <class Scanner>
  Index find(Scanner& in, std::int64_t number) const {
    if (!in.ok()) return 0;
    if (number < first || number - first >= static_cast<std::int64_t>(count)) {
      in.fail("an element names vertex " + std::to_string(number) + ", but the vertices are numbered " +
                  std::to_string(first) + " to " + std::to_string(first + static_cast<std::int64_t>(count) - 1),
              ErrorCode::index_out_of_range);
      return 0;
    }
    return static_cast<Index>(number - first);
  }
};

}  // namespace corotet::inline v0_1::detail
