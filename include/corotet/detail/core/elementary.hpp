// Sine, cosine, the exponential and the cube root by arithmetic alone: the same bits with every C library, which
// std::sin and the like are not.
#pragma once

#include <cmath>
#include <corotet/detail/core/square_root.hpp>
#include <utility>

namespace corotet::inline v0_1::detail {

/// (sin x, cos x), to 2e-16 of 1 for |x| <= 1e4 and to the rounding of x beyond. Taylor's series about the nearest
/// multiple of pi/2, which is subtracted in three parts (Cody & Waite 1980, "Software manual for the elementary
/// functions", chapter 8).
[[nodiscard]] inline std::pair<double, double> sine_and_cosine(double x) {
  constexpr double two_over_pi = 0.63661977236758134308;
  // pi/2 = high + middle + low; the first two have zeros behind them, so that their products with `quarters` are exact.
  constexpr double high = 1.57079632673412561417, middle = 6.07710050630396597660e-11, low = 2.02226624879595063154e-21;
  const double quarters = std::nearbyint(x * two_over_pi);
  const double r = ((x - quarters * high) - quarters * middle) - quarters * low, r2 = r * r;
  double sine = 1,
         cosine = 1;  // of r, by Horner's scheme: 1 - r^2/(2 3) (1 - r^2/(4 5) (...)), and without the first r
  for (int n = 16; n >= 2; n -= 2) {
    sine = 1 - r2 / (n * (n + 1)) * sine;
    cosine = 1 - r2 / (n * (n - 1)) * cosine;
  }
  sine *= r;
  switch (static_cast<int>(std::fmod(quarters, 4) + 4) % 4) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// The angle of (x, y) to the x axis, rad, 0 ... pi, for y >= 0: 0 at the origin. Taylor's series of the arc tangent
/// after the angle was halved three times, by tan(a / 2) = t / (1 + sqrt(1 + t^2)).
[[nodiscard]] inline double arc_tangent(double y, double x) {
  if (!(y > 0) && !(std::fabs(x) > 0)) return 0;
  // From the nearer axis, so that t <= 1.
  const bool steep = y > std::fabs(x);
  double t = steep ? std::fabs(x) / y : y / std::fabs(x);
  constexpr int halvings = 3;
  for (int k = 0; k < halvings; ++k) t = t / (1 + square_root(1 + t * t));
  double series = 0;
  for (int n = 21; n >= 1; n -= 2) series = 1.0 / n - t * t * series;
  const double angle = (1 << halvings) * t * series;
  constexpr double pi = 3.14159265358979323846;
  if (!steep) return x > 0 ? angle : pi - angle;
  return x > 0 ? pi / 2 - angle : pi / 2 + angle;
}

/// e^x to 1e-15 (1 + |x|) of it, for x <= 0: Taylor's series of x / 2^k with |x| / 2^k < 1/4, squared k times.
[[nodiscard]] inline double exponential(double x) {
  int halvings = 0;
  while (x < -0.25 && halvings < 12) {
    x /= 2;
    ++halvings;
  }
  double e = 1;
  for (int n = 14; n >= 1; --n) e = 1 + x / n * e;
  for (; halvings > 0; --halvings) e *= e;
  return e;
}

/// The cube root of x >= 0, to 1e-15 of it: Halley's method on x without a power of eight.
[[nodiscard]] inline double cube_root(double x) {
  if (!(x > 0) || !std::isfinite(x)) return x;
  int exponent = 0;
  std::frexp(x, &exponent);
  const double m = std::ldexp(x, -(exponent / 3 * 3));  // 1/8 <= m < 4
  double root = 1;
  for (int k = 0; k < 5; ++k) {
    const double cube = root * root * root;
    root *= (cube + 2 * m) / (2 * cube + m);
  }
  return std::ldexp(root, exponent / 3);
}

/// x - log(1 + x), to 1e-15 of it, for x > -1: by the series of the inverse hyperbolic tangent of x / (2 + x), or of
/// what is left of 1 + x without its power of two.
[[nodiscard]] inline double excess_over_logarithm(double x) {
  constexpr double log_2 = 0.69314718055994530942;
  const auto odd_series = [](double s) {  // atanh(s) / s - 1
    double sum = 0;
    for (int n = 41; n >= 3; n -= 2) sum = s * s * (1.0 / n + sum);
    return sum;
  };
  if (std::fabs(x) < 0.5) {
    const double s = x / (2 + x);
    return s * (x - 2 * odd_series(s));  // log(1 + x) = 2 atanh(s), and x - 2 s = x s
  }
  if (!std::isfinite(x)) return x;
  int exponent = 0;
  const double m = std::frexp(1 + x, &exponent), s = (m - 1) / (m + 1);
  return x - 2 * s * (1 + odd_series(s)) - exponent * log_2;
}

}  // namespace corotet::inline v0_1::detail
