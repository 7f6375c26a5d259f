// Numbers, vectors, matrices, fields and rotations: the types in which the library takes and returns quantities.
#pragma once

#include <corotet/core/elementary.hpp>
#include <corotet/core/matrix.hpp>
#include <corotet/core/types.hpp>
#include <corotet/rotation/quaternion.hpp>
