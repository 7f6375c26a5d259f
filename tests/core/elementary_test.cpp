// Our own elementary functions against the C library's, and the test of contraction.
#include <corotet/detail/core/contraction.hpp>
#include <corotet/detail/core/elementary.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace corotet::elementary_test {
namespace {

using detail::arc_tangent, detail::exponential, detail::sine_and_cosine;

TEST(Elementary, SineAndCosineAreTheCLibrarysToRounding) {
  std::mt19937 random(1);
  for (const double size : {1e-12, 1e-3, 1.0, 10.0, 1e3, 1e4}) {
    std::uniform_real_distribution<double> angle(-size, size);
    for (int i = 0; i < 20000; ++i) {
      const double x = angle(random);
      const auto [sine, cosine] = sine_and_cosine(x);
      ASSERT_NEAR(sine, std::sin(x), 2.3e-16) << x;
      ASSERT_NEAR(cosine, std::cos(x), 2.3e-16) << x;
    }
  }
  for (int quarter = -8; quarter <= 8; ++quarter) {
    const auto [sine, cosine] = sine_and_cosine(quarter * std::numbers::pi / 2);
    EXPECT_NEAR(sine, std::sin(quarter * std::numbers::pi / 2), 2.3e-16);
    EXPECT_NEAR(cosine, std::cos(quarter * std::numbers::pi / 2), 2.3e-16);
  }
  EXPECT_EQ(sine_and_cosine(0).first, 0);
  EXPECT_EQ(sine_and_cosine(0).second, 1);
}

TEST(Elementary, ArcTangentIsTheCLibrarysToRounding) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 100000; ++i) {
    const double x = number(random) * std::pow(10, 8 * number(random));
    const double y = std::fabs(number(random)) * std::pow(10, 8 * number(random));
    ASSERT_NEAR(arc_tangent(y, x), std::atan2(y, x), 1e-15) << y << ' ' << x;
  }
  EXPECT_EQ(arc_tangent(0, 0), 0);
  EXPECT_EQ(arc_tangent(0, 3), 0);
  EXPECT_EQ(arc_tangent(0, -3), std::numbers::pi);
  EXPECT_NEAR(arc_tangent(2, 0), std::numbers::pi / 2, 1e-16);
}

TEST(Elementary, ExponentialIsTheCLibrarysToRounding) {
  std::mt19937 random(3);
  for (const double size : {1e-9, 1e-2, 1.0, 30.0, 500.0}) {
    std::uniform_real_distribution<double> number(-size, 0);
    for (int i = 0; i < 20000; ++i) {
      const double x = number(random), exact = std::exp(x);
      ASSERT_NEAR(exponential(x), exact, 1e-15 * (1 - x) * exact) << x;
    }
  }
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(exponential(-2000), 0);
}

TEST(Contraction, IsSeenWhereTheProcessorCan) {
#if defined(__FMA__) && !defined(__clang__) && !defined(COROTET_DETERMINISTIC)
  EXPECT_TRUE(detail::contracts());
#elif !defined(__FMA__) && defined(__x86_64__)
  EXPECT_FALSE(detail::contracts());
#else
  GTEST_SKIP() << "this compiler's own choice";
#endif
}

}  // namespace
}  // namespace corotet::elementary_test
