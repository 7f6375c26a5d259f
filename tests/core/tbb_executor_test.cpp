#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/tbb_executor.hpp>
#include <thread>
#include <vector>

namespace {

using corotet::Index;

TEST(TbbExecutor, CallsEachTaskExactlyOnceAndReturnsAfterThem) {
  const corotet::TbbExecutor executor;
  for (const Index count : {0, 1, 2, 3, 7, 64, 1000, 100000}) {
    std::vector<std::atomic<int>> calls(corotet::at(count));
    executor(count, [&](Index i) { calls[corotet::at(i)].fetch_add(1, std::memory_order_relaxed); });
    for (Index i = 0; i < count; ++i) ASSERT_EQ(calls[corotet::at(i)].load(), 1) << "task " << i << " of " << count;
  }
}

// Two tasks that wait for each other end only if two threads run them.
TEST(TbbExecutor, RunsTasksSideBySide) {
  const oneapi::tbb::global_control at_least_two(oneapi::tbb::global_control::max_allowed_parallelism, 2);
  oneapi::tbb::task_arena arena(2);
  std::atomic<int> arrived{0};
  arena.execute([&] {
    const corotet::TbbExecutor executor;
    executor(2, [&](Index) {
      arrived.fetch_add(1);
      while (arrived.load() < 2) std::this_thread::yield();
    });
  });
  EXPECT_EQ(arrived.load(), 2);
}

// What determinism rests on: ranges are cut by count and grain alone, so each partial sum is made of the same terms in
// the same order on any number of threads.
TEST(TbbExecutor, RangesAndTheirSumsAreTheSameBitsAsSerial) {
  constexpr Index count = 10007, grain = 64, ranges = (count + grain - 1) / grain;
  const auto partial_sums = [&](auto executor) {
    std::vector<double> sums(corotet::at(ranges), 0.0);
    corotet::for_ranges(executor, count, grain, [&](Index begin, Index end) {
      double sum = 0;
      for (Index i = begin; i < end; ++i) sum += std::sin(0.1 * i) / (1 + i);
      sums[corotet::at(begin / grain)] = sum;
    });
    return sums;
  };
  const oneapi::tbb::global_control up_to_four(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  const std::vector<double> serial = partial_sums(corotet::SerialExecutor{});
  for (const int threads : {1, 2, 4}) {
    oneapi::tbb::task_arena arena(threads);
    arena.execute([&] { EXPECT_EQ(partial_sums(corotet::TbbExecutor{}), serial) << threads << " threads"; });
  }
}

}  // namespace
