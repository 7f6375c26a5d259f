/// @defgroup group_types Numbers, vectors, rotations
/// The types in which the library takes and returns quantities. All units are SI.
#pragma once

#include <corotet/detail/core/matrix.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
