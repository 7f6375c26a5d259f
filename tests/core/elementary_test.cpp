// Our own elementary functions against the C library's, and the test of contraction.
#include <corotet/detail/core/contraction.hpp>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>

namespace corotet::elementary_test {
namespace {

using detail::arc_tangent, detail::cube_root, detail::exponential, detail::sine_and_cosine, detail::square_root,
    detail::take_square_roots;

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

TEST(Elementary, CubeRootIsTheCLibrarysToRounding) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-1074, 1023);
  for (int i = 0; i < 100000; ++i) {
    const double x = std::exp2(exponent(random)), exact = std::cbrt(x);
    ASSERT_NEAR(cube_root(x), exact, 1e-15 * exact) << x;
  }
  for (int i = 0; i < 1000; ++i) EXPECT_NEAR(cube_root(double(i) * i * i), i, 1e-15 * i);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cube_root(infinite), infinite);
}

/// No other number is nearer to the root.
template <class T>
void expect_rounded_roots(int least_exponent, int largest_exponent) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(least_exponent, largest_exponent);
  for (int i = 0; i < 100000; ++i) {
    const T x = static_cast<T>(std::exp2(exponent(random))), root = square_root(x);
    // x lies between the squares of the middles to both neighbours, (r + u/2)^2 = r^2 + r u + u^2/4. The difference
    // r^2 - x is a multiple of u^2, and exact by fma.
    const T excess = std::fma(root, root, -x);
    const T up = std::nextafter(root, 2 * root) - root, down = root - std::nextafter(root, T(0));
    ASSERT_GE(excess, -root * up) << x;
    ASSERT_LT(excess, root * down) << x;
  }
  const T infinite = std::numeric_limits<T>::infinity();
  EXPECT_EQ(square_root(T(0)), T(0));
  EXPECT_EQ(square_root(T(9)), T(3));
  EXPECT_EQ(square_root(infinite), infinite);
  EXPECT_TRUE(std::isnan(square_root(T(-1))));
  EXPECT_TRUE(std::isnan(square_root(std::numeric_limits<T>::quiet_NaN())));
}

TEST(Elementary, SquareRootIsTheNearestNumber) {
  expect_rounded_roots<float>(-80, 127);
  expect_rounded_roots<double>(-900, 1023);
}

TEST(Elementary, SquareRootsOfManyAreThoseOfEach) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> number(0, 10);
  const auto compare = [&]<class T, std::size_t n>(std::array<T, n> numbers) {
    for (T& x : numbers) x = static_cast<T>(number(random));
    std::array<T, n> roots = numbers;
    take_square_roots(roots);
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(roots[i], square_root(numbers[i]));
  };
  compare(std::array<float, 16>());
  compare(std::array<double, 8>());
  compare(std::array<float, 3>());
  compare(std::array<double, 1>());
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
