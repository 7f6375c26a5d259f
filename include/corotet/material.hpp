/// @defgroup group_material Materials
/// Young's modulus, Poisson's ratio and density, one for a body or one for each element.
#pragma once

#include <corotet/detail/material/material.hpp>
