// How the library uses a host's threads: it creates none, it hands numbered tasks to an executor.
#pragma once

#include <algorithm>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <memory>
#include <type_traits>

namespace corotet::inline v0_1 {

namespace detail {

/// Where an object lies, for a function that knows its type.
template <class T>
[[nodiscard]] void* address_of(T& object) {
  return const_cast<void*>(static_cast<const void*>(std::addressof(object)));
}

/// Calls the F that lies at `object`. (A lambda for each F would cost three functions to compile, not one.)
template <class Returned, class F, class... Arguments>
Returned call_object(void* object, Arguments... arguments) {
  if constexpr (std::is_void_v<Returned>)
    (*static_cast<F*>(object))(arguments...);
  else
    return (*static_cast<F*>(object))(arguments...);
}

}  // namespace detail

/// Refers to a callable task(i), which must outlive it.
class TaskRef {
 public:
  /// Refers to a callable that takes an Index; it must outlive the reference.
  template <std::invocable<Index> Task>
    requires(!std::same_as<std::remove_cvref_t<Task>, TaskRef>)
  TaskRef(Task&& task)  // NOLINT(google-explicit-constructor, bugprone-forwarding-reference-overload): as the task
      : object_(detail::address_of(task)), call_(&detail::call_object<void, std::remove_reference_t<Task>, Index>) {}

  /// Runs the task with number `i`.
  void operator()(Index i) const { call_(object_, i); }

 private:
  void* object_;
  void (*call_)(void*, Index);
};

/// Law: `executor(count, task)` calls `task(i)` exactly once for every i in [0, count), in any order and on any
/// threads, and returns when all of them have returned. A job system is adapted by a lambda:
///   `auto jobs = [&](corotet::Index count, corotet::TaskRef task) { engine.parallel_for(count, task); };`
template <class E>
concept Executor = requires(E& executor, Index count, TaskRef task) { executor(count, task); };

/// The default: everything on the calling thread, in order.
struct SerialExecutor {
  /// Runs tasks 0 ... count - 1 in this thread.
  void operator()(Index count, TaskRef task) const {
    for (Index i = 0; i < count; ++i) task(i);
  }
};

/// A reference to a parallel loop of the caller, of any type; made from nothing, to the serial one.
///
/// Each call that works hard takes one, so that the library uses the threads that a program has. ThreadPool is one for
/// programs that have none. Results are the same bits with every executor.
/// @snippet steps.cpp executor
/// The executor must outlive the reference.
class ExecutorRef {
 public:
  ExecutorRef() : object_(nullptr), run_([](void*, Index count, TaskRef task) { SerialExecutor()(count, task); }) {}
  /// Refers to an executor, which must outlive the reference.
  template <class E>
    requires(!std::same_as<std::remove_cvref_t<E>, ExecutorRef> && Executor<std::remove_reference_t<E>>)
  ExecutorRef(E&& executor)  // NOLINT(google-explicit-constructor, bugprone-forwarding-reference-overload)
      : object_(detail::address_of(executor)),
        run_(&detail::call_object<void, std::remove_reference_t<E>, Index, TaskRef>) {}

  /// Runs tasks 0 ... count - 1; returns when all have ended.
  void operator()(Index count, TaskRef task) const { run_(object_, count, task); }

 private:
  void* object_;
  void (*run_)(void*, Index, TaskRef);
};

namespace detail {

/// A loop over [0, count) in ranges of `grain`.
struct RangeTask {
  void* body;
  void (*call)(void* body, Index begin, Index end);
  Index count, grain;

  void operator()(Index range) const {
    const Index begin = range * grain;
    call(body, begin, (std::min)(begin + grain, count));
  }
};

/// for_ranges of a body whose type is forgotten.
COROTET_NOINLINE inline void run_ranges(ExecutorRef executor, Index count, Index grain, void* body,
                                        void (*call)(void*, Index, Index)) {
  const RangeTask task{body, call, count, grain};
  executor((count + grain - 1) / grain, task);
}

}  // namespace detail

/// Splits [0, count) into ranges of `grain` and calls `body(begin, end)` for each. The ranges depend on `count` and
/// `grain` alone, never on the number of threads, so that results are the same bits on any executor.
template <std::invocable<Index, Index> Body>
void for_ranges(ExecutorRef executor, Index count, Index grain, Body&& body) {
  detail::run_ranges(executor, count, grain, detail::address_of(body),
                     &detail::call_object<void, std::remove_reference_t<Body>, Index, Index>);
}

}  // namespace corotet::inline v0_1
