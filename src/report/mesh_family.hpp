// The same body in meshes of several sizes.
#pragma once

#include <array>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <optional>
#include <string>
#include <vector>

namespace corotet::program {

struct MeshLevel {
  std::string name;              ///< "10x2x2", or "mesh", "mesh/2", "mesh/4"
  double size = 0;               ///< cube root of the mean volume of its elements, m
  MeshData linear;               ///< of 4-node elements
  std::array<Index, 3> cells{};  ///< of a grid along its axes; 0 if it is none
};

/// Coarse meshes first.
struct MeshFamily {
  std::vector<MeshLevel> levels;
  int own = 0;        ///< the level of the mesh that it was made from
  std::string notes;  ///< what was lost on the way: curved edges

  /// `level` in elements of 4 (order 1) or 10 nodes (2).
  [[nodiscard]] MeshData mesh(int level, int order) const;

  [[nodiscard]] const MeshLevel& operator[](int level) const { return levels[at(level)]; }
  [[nodiscard]] int count() const { return size_of(levels); }
};

/// Boxes of `block.size` in each of `cells`.
[[nodiscard]] MeshFamily make_family(const BlockOptions& block, const std::vector<std::array<Index, 3>>& cells);

/// Around any mesh. One that is a box cut into a grid of cells (by make_block, say) is cut anew into coarser and finer
/// grids; of any other there are refinements only (refine_red), as long as they have at most `max_elements`.
[[nodiscard]] MeshFamily make_family(const MeshData& mesh, Index max_elements);

/// The box and cells of a mesh whose vertices form an even grid that fills their bounding box.
[[nodiscard]] std::optional<BlockOptions> find_grid(const MeshData& linear);

}  // namespace corotet::program
