/// @defgroup group_mesh Meshes
/// Tetrahedral meshes and surfaces in memory: made from arrays or as a block of cells, of order 1 or 2.
///
/// Files are in @ref group_io; quality measures and mesh generation in @ref group_meshing.
#pragma once

#include <corotet/element/tet10.hpp>
#include <corotet/element/tet4.hpp>
#include <corotet/mesh/boundary.hpp>
#include <corotet/mesh/element_lines.hpp>
#include <corotet/mesh/make_block.hpp>
#include <corotet/mesh/mesh_data.hpp>
#include <corotet/mesh/raise_order.hpp>
#include <corotet/mesh/surface_mesh.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <corotet/mesh/vertex_normals.hpp>
