/// @defgroup group_types Numbers, vectors, rotations
/// The types in which the library takes and returns quantities. All units are SI.
#pragma once

#include <corotet/core/matrix.hpp>
#include <corotet/core/types.hpp>
#include <corotet/rotation/quaternion.hpp>
