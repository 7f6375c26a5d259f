/// @defgroup group_mesh Meshes
/// Tetrahedral meshes and surfaces in memory: made from arrays or as a block of cells, of order 1 or 2.
///
/// Files are in @ref group_io; quality measures and mesh generation in @ref group_meshing.
#pragma once

#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/element_lines.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/detail/mesh/raise_order.hpp>
#include <corotet/detail/mesh/surface_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/mesh/vertex_normals.hpp>
