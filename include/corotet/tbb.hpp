/// @defgroup group_tbb oneTBB (opt-in)
/// An executor over oneTBB. Link corotet::tbb.
#pragma once

#include <corotet/detail/core/tbb_executor.hpp>
