// Opt-in: an executor over oneTBB. Link corotet::tbb.
#pragma once

#include <corotet/core/tbb_executor.hpp>
