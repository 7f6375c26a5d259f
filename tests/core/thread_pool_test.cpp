#include <corotet/detail/core/thread_pool.hpp>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

namespace thread_pool_test {
namespace {

using corotet::at;
using corotet::Index;
using corotet::ThreadPool;

TEST(ThreadPool, CallsEachTaskExactlyOnceAndReturnsAfterThem) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    for (const Index count : {0, 1, 2, 3, 7, 64, 1000}) {
      std::vector<std::atomic<int>> calls(at(count));
      pool(count, [&](Index i) { calls[at(i)].fetch_add(1, std::memory_order_relaxed); });
      for (Index i = 0; i < count; ++i) ASSERT_EQ(calls[at(i)].load(), 1) << "task " << i << ", " << threads;
    }
  }
}

// Jobs so short that workers wake up for one when it is over already, or when the next one runs.
TEST(ThreadPool, ManyShortJobsNeverMixUp) {
  ThreadPool pool(4);
  for (int job = 0; job < 20000; ++job) {
    const Index count = 1 + job % 5;
    std::atomic<int> sum{0};
    pool(count, [&sum, job](Index i) { sum.fetch_add(job + i); });
    ASSERT_EQ(sum.load(), count * job + count * (count - 1) / 2) << "job " << job;
  }
}

// Two tasks that wait for each other end only if two threads run them.
TEST(ThreadPool, RunsTasksSideBySide) {
  ThreadPool pool(2);
  std::atomic<int> arrived{0};
  pool(2, [&](Index) {
    arrived.fetch_add(1);
    while (arrived.load() < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived.load(), 2);
}

TEST(ThreadPool, TakesConstAndNonConstCallables) {
  ThreadPool pool(2);
  std::vector<int> seen(10, 0);
  const auto constant = [&seen](Index i) { seen[at(i)] += 1; };
  pool(10, constant);
  auto changing = [&seen, calls = std::vector<int>(10)](Index i) mutable { seen[at(i)] += ++calls[at(i)]; };
  pool(10, changing);
  EXPECT_EQ(seen, std::vector<int>(10, 2));
}

// As all functions of the library take it, one pool after another and through references to it.
TEST(ThreadPool, RunsTheRangesOfTheLibrary) {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.thread_count(), threads);
    const corotet::ExecutorRef executor = pool, again = executor;
    std::vector<int> visits(1001, 0);
    corotet::for_ranges(again, 1001, 10, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) ++visits[at(i)];
    });
    EXPECT_EQ(visits, std::vector<int>(1001, 1));
  }
}

}  // namespace
}  // namespace thread_pool_test
