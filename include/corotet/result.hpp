/// @defgroup group_result Errors
/// Result for bad data; COROTET_ASSERT and its handler for mistakes of the calling program.
#pragma once

#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/result.hpp>
