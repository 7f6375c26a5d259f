/// @defgroup group_meshing Meshing and mesh quality
/// Isosurface stuffing of a closed surface, and measures of the quality of elements.
#pragma once

#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/mesh/element_quality.hpp>
#include <corotet/detail/mesh/quality.hpp>
#include <corotet/detail/mesh/stuffing/isosurface_stuffing.hpp>
