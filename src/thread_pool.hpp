// A few threads that share numbered tasks: the program's Executor (corotet/core/executor.hpp).
#pragma once

#include <concepts>
#include <condition_variable>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace corotet::program {

/// `pool(count, task)` calls task(0) ... task(count - 1), each once, on the pool's threads and the calling one.
/// Tasks must not throw and must not call the pool; only one thread at a time may call it. A call allocates nothing.
class ThreadPool {
 public:
  /// `threads` >= 1, the calling thread included: 1 makes no threads and runs tasks in order. Throws std::system_error
  /// if the system does not give as many, std::bad_alloc if there is no memory for them.
  explicit ThreadPool(int threads) : ThreadPool() {
    // If a thread cannot be made, the destructor runs, because a delegated constructor has finished: it stops the
    // others.
    for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
  }

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  ~ThreadPool() { stop(); }

  template <std::invocable<Index> Task>
  void operator()(Index count, Task&& task) {
    if (workers_.empty() || count <= 1) {
      for (Index i = 0; i < count; ++i) task(i);
      return;
    }
    using Callable = std::remove_reference_t<Task>;
    std::unique_lock lock(mutex_);
    // A task that is const is called as const again: the cast only carries it through the untyped pointer.
    job_ = {const_cast<void*>(static_cast<const void*>(std::addressof(task))),
            [](void* context, Index i) { (*static_cast<Callable*>(context))(i); }, count, 0, count};
    wake_.notify_all();
    while (job_.next < job_.count) run_one(lock);
    done_.wait(lock, [this] { return job_.unfinished == 0; });
  }

 private:
  ThreadPool() = default;

  struct Job {
    void* context = nullptr;
    void (*call)(void*, Index) = nullptr;
    Index count = 0;
    Index next = 0;        // the first task that nobody has taken
    Index unfinished = 0;  // tasks not taken, or still running
  };

  /// Ends the threads that there are.
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }

  /// Takes the next task and runs it without the lock.
  void run_one(std::unique_lock<std::mutex>& lock) {
    const Job job = job_;
    ++job_.next;
    lock.unlock();
    job.call(job.context, job.next);
    lock.lock();
    if (--job_.unfinished == 0) done_.notify_one();
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return stopping_ || job_.next < job_.count; });
      if (stopping_) return;
      run_one(lock);
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  Job job_;
  bool stopping_ = false;
  std::vector<std::thread> workers_;
};

static_assert(Executor<ThreadPool>);

}  // namespace corotet::program
