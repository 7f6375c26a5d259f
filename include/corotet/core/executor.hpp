// How the library uses a host's threads: it creates none, it hands numbered tasks to an executor.
#pragma once

#include <algorithm>
#include <concepts>
#include <corotet/core/compiler.hpp>
#include <corotet/core/types.hpp>

namespace corotet {

/// Law: `executor(count, task)` calls `task(i)` exactly once for every i in [0, count), in any order and on any
/// threads, and returns when all of them have returned. A job system is adapted by a lambda:
///   `auto jobs = [&](corotet::Index count, auto&& task) { engine.parallel_for(count, task); };`
template <class E>
concept Executor = requires(E& executor, Index count, void (*task)(Index)) { executor(count, task); };

/// The default: everything on the calling thread, in order.
struct SerialExecutor {
  template <std::invocable<Index> Task>
  void operator()(Index count, Task&& task) const {
    for (Index i = 0; i < count; ++i) task(i);
  }
};

namespace detail {

/// A call that is compiled once for every loop. Inlined, it would be compiled again for each way in which an executor
/// runs its tasks, and a compiler that may contract a * b + c contracts differently where it sees different code: then
/// the number of threads would change the last bits.
template <class Body>
COROTET_NEVER_INLINE void run_range(Body& body, Index begin, Index end) {
  body(begin, end);
}

}  // namespace detail

/// Splits [0, count) into ranges of `grain` and calls `body(begin, end)` for each. The ranges depend on `count` and
/// `grain` alone, never on the number of threads, so that results are the same bits on any executor.
template <Executor E, std::invocable<Index, Index> Body>
void for_ranges(E& executor, Index count, Index grain, Body&& body) {
  const Index ranges = (count + grain - 1) / grain;
  executor(ranges, [&](Index range) {
    const Index begin = range * grain;
    detail::run_range(body, begin, std::min<Index>(begin + grain, count));
  });
}

}  // namespace corotet
