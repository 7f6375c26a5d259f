// for_ranges covers every index once, in ranges that do not depend on the executor.
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/result.hpp>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace corotet {
namespace {

/// Runs tasks in the opposite order: the next best thing to a scheduler that does as it likes.
struct BackwardExecutor {
  void operator()(Index count, TaskRef task) const {
    for (Index i = count - 1; i >= 0; --i) task(i);
  }
};
static_assert(Executor<SerialExecutor> && Executor<BackwardExecutor>);

TEST(ForRanges, CoversEveryIndexOnceInRangesOfTheGrain) {
  SerialExecutor serial;
  BackwardExecutor backward;
  for (const Index count : {0, 1, 5, 6, 7, 100})
    for (const Index grain : {1, 6, 1000}) {
      std::vector<int> visits(at(count), 0);
      const auto visit = [&](Index begin, Index end) {
        EXPECT_EQ(begin % grain, 0);
        EXPECT_LE(end - begin, grain);
        for (Index i = begin; i < end; ++i) ++visits[at(i)];
      };
      for_ranges(serial, count, grain, visit);
      for_ranges(backward, count, grain, visit);
      EXPECT_EQ(visits, std::vector<int>(at(count), 2));
    }
}

TEST(Result, HoldsAValueOrAnError) {
  Result<std::unique_ptr<int>> value(std::make_unique<int>(7));
  ASSERT_TRUE(value.ok());
  EXPECT_EQ(**value, 7);
  EXPECT_EQ(*std::move(value).value(), 7);
  const Result<int> error(Error{ErrorCode::empty_mesh, "beam.msh:12", "no elements"});
  ASSERT_FALSE(error.ok());
  EXPECT_EQ(error.error().code, ErrorCode::empty_mesh);
  EXPECT_EQ(error.error().message(), "beam.msh:12: no elements");
  EXPECT_TRUE(Result<void>().ok());
  EXPECT_EQ(Result<void>(Error{ErrorCode::unsupported, "", "why"}).error().message(), "why");
}

int assertions_seen = 0;
TEST(Assert, CallsTheHandlerInForce) {
  const AssertHandler before = assert_handler;
  assert_handler = [](const char* expression, const char* message, const char*, int) {
    EXPECT_STREQ(expression, "1 == 2");
    EXPECT_STREQ(message, "why");
    ++assertions_seen;
  };
  COROTET_ASSERT(1 == 1, "fine");
  COROTET_ASSERT(1 == 2, "why");
  assert_handler = before;
#if defined(NDEBUG)
  EXPECT_EQ(assertions_seen, 0);
#else
  EXPECT_EQ(assertions_seen, 1);
#endif
}

}  // namespace
}  // namespace corotet
