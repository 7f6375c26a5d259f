// Structured meshes of a box: beams and blocks.
#pragma once

#include <array>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/index_list.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// How each cell of the grid is cut into tetrahedra.
enum class BlockSplit {
  kuhn6,        ///< six around the main diagonal; all cells alike, so the mesh leans to one side
  alternating5  ///< one regular and four corner tetrahedra, mirrored from cell to cell; leans to no side
};

/// A box of `size` with its least corner at `corner`, cut into a grid of `cells`.
struct BlockOptions {
  Vec3<double> corner = Vec3<double>::Zero();   ///< m
  Vec3<double> size = Vec3<double>::Ones();     ///< m, each > 0
  std::array<Index, 3> cells{1, 1, 1};          ///< along x, y, z, each >= 1
  BlockSplit split = BlockSplit::alternating5;  ///< of each cell into tetrahedra
  int order = 1;                                ///< 1: Tet4; 2: Tet10 with straight edges
};

/// The mesh of a box. Vertices are numbered along x first, then y, then z (mid-edge vertices of order 2 follow).
/// Errors: invalid_argument for a size, cell count or order outside its range.
[[nodiscard]] COROTET_COLD inline Result<MeshData> make_block(const BlockOptions& options) {
  const auto [nx, ny, nz] = options.cells;
  if (nx < 1 || ny < 1 || nz < 1)
    return detail::error(ErrorCode::invalid_argument, "cells", "must be at least 1 along each axis");
  if (!(options.size.minCoeff() > 0) || !options.size.allFinite() || !options.corner.allFinite())
    return detail::error(ErrorCode::invalid_argument, "size", "must be positive and finite along each axis");
  if (options.order != 1 && options.order != 2)
    return detail::error(ErrorCode::invalid_argument, {"order"}, {"must be 1 or 2, is ", options.order});
  if ((double{1} + nx) * (double{1} + ny) * (double{1} + nz) > (std::numeric_limits<Index>::max)() / 240.0)
    return detail::error(ErrorCode::invalid_argument, "cells", "too many for 32-bit indices");

  MeshData mesh;
  const auto vertex = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i)
        mesh.positions.emplace_back(
            options.corner + options.size.cwiseProduct(Vec3<double>(double(i) / nx, double(j) / ny, double(k) / nz)));

  // Cell corners are numbered by bits: 1 = +x, 2 = +y, 4 = +z.
  constexpr std::array<std::array<int, 4>, 6> kuhn{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  constexpr std::array<std::array<int, 4>, 5> five{
      {{0, 5, 3, 6}, {0, 1, 3, 5}, {0, 3, 2, 6}, {0, 5, 6, 4}, {3, 6, 5, 7}}};
  const auto add = [&](const std::array<int, 4>& tet, Index i, Index j, Index k, int mirror) {
    std::array<Index, 4> nodes;
    for (std::size_t c = 0; c < 4; ++c) {
      const int bits = tet[c] ^ mirror;
      nodes[c] = vertex(i + (bits & 1), j + ((bits >> 1) & 1), k + ((bits >> 2) & 1));
    }
    if (mirror != 0) std::swap(nodes[1], nodes[2]);  // a mirror image has the opposite winding
    detail::append(mesh.connectivity, nodes.data(), nodes.size());
  };
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        if (options.split == BlockSplit::kuhn6)
          for (const auto& tet : kuhn) add(tet, i, j, k, 0);
        else
          for (const auto& tet : five) add(tet, i, j, k, (i + j + k) % 2);
      }
  if (options.order == 2) return raise_order(std::move(mesh));
  return mesh;
}

}  // namespace corotet::inline v0_1
