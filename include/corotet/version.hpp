/// @defgroup group_version Version
/// The version of the library, as macros and as constants.
#pragma once

#include <corotet/detail/core/version.hpp>
