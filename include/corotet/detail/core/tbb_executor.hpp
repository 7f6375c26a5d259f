// Opt-in: runs the library's tasks on oneTBB's threads. Link corotet::tbb.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1 {

/// An Executor on the oneTBB arena of the calling thread: call from inside `arena.execute(...)`, or set a
/// `tbb::global_control`, to bound the number of threads. oneTBB keeps its own pool of task objects: that a step
/// allocates nothing is promised for the library, not for oneTBB.
struct TbbExecutor {
  /// Runs tasks 0 ... count - 1 on the threads of oneTBB; returns when all have ended.
  void operator()(Index count, TaskRef task) const {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<Index>(0, count),
                              [task](const oneapi::tbb::blocked_range<Index>& range) {
                                for (Index i = range.begin(); i < range.end(); ++i) task(i);
                              });
  }
};

static_assert(Executor<TbbExecutor>);

}  // namespace corotet::inline v0_1
