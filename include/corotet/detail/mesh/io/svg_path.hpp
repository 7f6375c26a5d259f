// Outlines and lines as the paths of an .svg picture.
#pragma once

#include <array>
#include <cmath>
#include <corotet/detail/mesh/io/contours.hpp>
#include <corotet/detail/mesh/io/text_writer.hpp>
#include <string>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Paths in tenths of a pixel, which keeps the numbers short.
class SvgPath {
 public:
  void move_to(const GridPoint& p) {
    const auto [x, y] = rounded(p);
    text_ << 'M' << x << ' ' << y << 'l';
    at_ = {x, y};
    first_ = true;
  }
  void line_to(const GridPoint& p) {
    const auto [x, y] = rounded(p);
    const int dx = x - at_[0], dy = y - at_[1];
    if (!first_ && dx >= 0) text_ << ' ';
    text_ << dx;
    if (dy >= 0) text_ << ' ';
    text_ << dy;
    at_ = {x, y};
    first_ = false;
  }
  void add_loops(const std::vector<std::vector<GridPoint>>& loops) {
    constexpr double tolerance = 0.12, smallest = 0.6;  // pixels, square pixels
    for (const std::vector<GridPoint>& loop : loops) {
      if (area_of(loop) < smallest) continue;
      const std::vector<GridPoint> points = simplified(loop, tolerance);
      move_to(points[0]);
      for (std::size_t i = 1; i < points.size(); ++i) line_to(points[i]);
      text_ << 'z';
    }
  }
  [[nodiscard]] std::string take() { return text_.take(); }

 private:
  static std::array<int, 2> rounded(const GridPoint& p) {
    return {static_cast<int>(std::lround(10 * p.x)), static_cast<int>(std::lround(10 * p.y))};
  }
  TextWriter text_;
  std::array<int, 2> at_{};
  bool first_ = true;
};

/// The colour of a brightness from 0 to 1: dark, the colour of the body, and nearly white.
inline std::string shade_colour(double shade) {
  constexpr std::array<std::array<double, 3>, 3> colours{{{14, 44, 52}, {54, 146, 158}, {196, 238, 240}}};
  constexpr double middle = 0.62;
  const std::size_t i = shade < middle ? 0 : 1;
  const double t = i == 0 ? shade / middle : (shade - middle) / (1 - middle);
  std::string text = "#";
  for (std::size_t k = 0; k < 3; ++k) {
    const int value = static_cast<int>(std::lround(colours[i][k] + t * (colours[i + 1][k] - colours[i][k])));
    for (const int digit : {value / 16, value % 16}) text += "0123456789abcdef"[digit];
  }
  return text;
}

}  // namespace corotet::inline v0_1::detail
