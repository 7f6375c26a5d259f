/// @defgroup group_executor Executors
/// Threads of the caller: an ExecutorRef refers to any parallel loop. Each call that works hard takes one.
#pragma once

#include <corotet/detail/core/executor.hpp>
