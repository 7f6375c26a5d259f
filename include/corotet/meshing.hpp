// Meshes made and examined: isosurface stuffing of a closed surface, and measures of quality.
#pragma once

#include <corotet/mesh/quality.hpp>
#include <corotet/mesh/stuffing/isosurface_stuffing.hpp>
#include <corotet/mesh/validate.hpp>
