// Threads of the caller: an ExecutorRef refers to any parallel loop, and each call that works hard takes one.
#pragma once

#include <corotet/core/executor.hpp>
