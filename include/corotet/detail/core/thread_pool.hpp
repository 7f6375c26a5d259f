// Opt-in: a few threads that share numbered tasks, for programs without a job system. Link Threads::Threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace corotet::inline v0_1 {

/// An executor of threads of its own.
///
/// Use it in a program without a job system. In an engine give the engine's parallel loop to each call instead: see
/// ExecutorRef.
/// @snippet queries.cpp pool
/// `pool(count, task)` calls task(0) ... task(count - 1), each once, on the pool's threads and the calling
/// one. Tasks must not throw and must not call the pool. One thread at a time may call it. A call allocates nothing.
///
/// A step has hundreds of parallel loops of some tens of microseconds: less than it takes to wake a thread. So threads
/// that run out of work look for more for a while before they sleep, and tasks are taken without a lock. Each thread
/// begins with its own share of the numbers, the same in every loop of as many tasks, and then helps the others: what
/// it wrote in one loop is still in its core's cache in the next.
class ThreadPool {
 public:
  /// `threads` >= 1, the calling thread included: 1 makes no threads and runs tasks in order. Where the system does not
  /// give as many, std::thread throws std::system_error, and ends a program that is compiled without exceptions.
  explicit ThreadPool(int threads) : ThreadPool(at((std::max)(threads, 1))) {
    // If a thread cannot be made, the destructor runs, because a delegated constructor has finished: it stops the
    // others.
    for (std::size_t i = 1; i < shares_.size(); ++i) workers_.emplace_back([this, i] { work(i); });
  }

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  ~ThreadPool() {
    stopping_ = true;
    ++phase_;
    phase_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }

  /// The calling thread included.
  [[nodiscard]] int thread_count() const { return static_cast<int>(shares_.size()); }

  /// Runs tasks 0 ... count - 1 on the pool's threads and on the caller's; returns when all have ended.
  void operator()(Index count, TaskRef task) {
    if (workers_.empty() || count <= 1) {
      for (Index i = 0; i < count; ++i) task(i);
      return;
    }
    job_ = &task;
    const auto threads = static_cast<Index>(shares_.size());
    for (Index t = 0; t < threads; ++t) {
      shares_[at(t)].next = first_of(t, count, threads);
      shares_[at(t)].end = first_of(t + 1, count, threads);
    }
    ++phase_;  // odd: open
    phase_.notify_all();
    run_tasks(0);
    ++phase_;  // even: closed; who is inside still runs a task, or is about to see that none is left
    while (inside_ != 0) std::this_thread::yield();
  }

 private:
  explicit ThreadPool(std::size_t threads) : shares_(threads) {}

  /// The numbers that a thread begins with, in a cache line of its own.
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0;
  };

  [[nodiscard]] static Index first_of(Index thread, Index count, Index threads) {
    return static_cast<Index>(std::int64_t{count} * thread / threads);
  }

  /// Own share first, then those of the next threads.
  void run_tasks(std::size_t thread) {
    for (std::size_t t = 0; t < shares_.size(); ++t) {
      Share& share = shares_[(thread + t) % shares_.size()];
      for (Index i = share.next++; i < share.end; i = share.next++) (*job_)(i);
    }
  }

  void work(std::size_t thread) {
    std::uint32_t seen = 0;
    for (;;) {
      wait_for_change(seen);
      if (stopping_) return;
      // Inside first, then the question whether there is a job: it is not replaced while anybody is inside.
      ++inside_;
      seen = phase_;
      if (seen % 2 == 1) run_tasks(thread);
      --inside_;
    }
  }

  void wait_for_change(std::uint32_t seen) {
    constexpr int patience = 2000;  // looks, some tens of microseconds
    for (int look = 0; look < patience; ++look) {
      if (phase_ != seen) return;
      if (look % 16 == 15) std::this_thread::yield();
    }
    phase_.wait(seen);
  }

  // All accesses are sequentially consistent: the order "inside, then phase" against "phase, then inside" needs that.
  std::atomic<std::uint32_t> phase_{0};
  std::atomic<int> inside_{0};
  std::atomic<bool> stopping_{false};
  const TaskRef* job_ = nullptr;  // read only by threads that are inside while it is open
  std::vector<Share> shares_;     // of the calling thread first
  std::vector<std::thread> workers_;
};

static_assert(Executor<ThreadPool>);

}  // namespace corotet::inline v0_1
