/// @defgroup group_thread_pool Thread pool (opt-in)
/// An executor of threads of its own, for programs without a job system. Link Threads::Threads.
#pragma once

#include <corotet/detail/core/thread_pool.hpp>
