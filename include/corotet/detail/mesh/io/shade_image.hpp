// Which part of a surface is seen, and how bright it is, on a grid of samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/io/contours.hpp>
#include <limits>
#include <vector>

namespace corotet::inline v0_1::detail {

/// A point in the picture: x to the right and y down, in units of the picture; depth grows towards the eye.
struct PicturePoint {
  double x, y, depth;
};

/// Depth and brightness of what is nearest to the eye at each sample, `samples_per_unit` to a unit of the picture.
class ShadeImage {
 public:
  static constexpr Index samples_per_unit = 3;
  static constexpr float nothing = -1;  ///< the brightness where no triangle is

  ShadeImage(Index width, Index height)
      : width_(width),
        height_(height),
        depth_(width * samples_per_unit, height * samples_per_unit, -std::numeric_limits<float>::infinity()),
        shade_(width * samples_per_unit, height * samples_per_unit, nothing) {}

  /// Draws a triangle with a brightness at each corner, unless its back is seen.
  void draw(const std::array<PicturePoint, 3>& corners, const std::array<double, 3>& shades) {
    std::array<double, 3> x{}, y{};
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = corners[i].x * samples_per_unit - 0.5;  // a sample lies in the middle of its square
      y[i] = corners[i].y * samples_per_unit - 0.5;
    }
    // y points down, so that a front has a negative area.
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (!(area < 0)) return;
    const auto first = [](double a) { return static_cast<Index>(std::ceil((std::max)(a, 0.0))); };
    const Index left = first((std::min)({x[0], x[1], x[2]})), top = first((std::min)({y[0], y[1], y[2]}));
    const double right = (std::min<double>)((std::max)({x[0], x[1], x[2]}), depth_.columns - 1);
    const double bottom = (std::min<double>)((std::max)({y[0], y[1], y[2]}), depth_.rows - 1);
    for (Index row = top; row <= bottom; ++row)
      for (Index column = left; column <= right; ++column) {
        double depth = 0, shade = 0;
        bool inside = true;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
          const double weight = ((x[j] - column) * (y[k] - row) - (x[k] - column) * (y[j] - row)) / area;
          inside = inside && weight >= -edge_tolerance;
          depth += weight * corners[i].depth;
          shade += weight * shades[i];
        }
        if (!inside || depth <= static_cast<double>(depth_(column, row))) continue;
        depth_(column, row) = static_cast<float>(depth);
        shade_(column, row) = static_cast<float>(shade);
      }
  }

  /// Whether a point is in front of the surface, or less than `tolerance` behind it.
  [[nodiscard]] bool is_visible(const PicturePoint& p, double tolerance) const {
    const double x = p.x * samples_per_unit, y = p.y * samples_per_unit;
    if (!(x >= 0) || !(y >= 0) || x >= depth_.columns || y >= depth_.rows) return true;
    return p.depth + tolerance >= static_cast<double>(depth_(static_cast<Index>(x), static_cast<Index>(y)));
  }

  /// The share of each unit square that the surface covers. Point (c, r) of the result is the middle of square
  /// (c - 1, r - 1): there is a margin of one.
  [[nodiscard]] Grid coverage() const {
    Grid grid(width_ + 2, height_ + 2, 0);
    for_squares([&](Index column, Index row, float, int covered) {
      grid(column + 1, row + 1) = static_cast<float>(covered) / (samples_per_unit * samples_per_unit);
    });
    return grid;
  }

  /// The mean brightness of what covers each unit square, on the points of `coverage`. It goes on for some squares
  /// beyond the surface, so that outlines of brightness cross the surface's own; `nothing` elsewhere.
  [[nodiscard]] Grid brightness() const {
    Grid grid(width_ + 2, height_ + 2, nothing);
    for_squares([&](Index column, Index row, float sum, int covered) {
      if (covered > 0) grid(column + 1, row + 1) = sum / static_cast<float>(covered);
    });
    for (int pass = 0; pass < 2; ++pass) {
      const Grid before = grid;
      for (Index row = 1; row <= height_; ++row)
        for (Index column = 1; column <= width_; ++column) {
          if (!exactly_equal(before(column, row), nothing)) continue;
          float sum = 0;
          int count = 0;
          for (Index r = row - 1; r <= row + 1; ++r)
            for (Index c = column - 1; c <= column + 1; ++c)
              if (!exactly_equal(before(c, r), nothing)) {
                sum += before(c, r);
                ++count;
              }
          if (count > 0) grid(column, row) = sum / static_cast<float>(count);
        }
    }
    return grid;
  }

 private:
  static constexpr double edge_tolerance = 1e-9;  // of barycentric coordinates: no gaps between neighbours

  /// Calls use(column, row, sum of brightness, covered samples) for each unit square.
  template <class Use>
  void for_squares(Use&& use) const {
    for (Index row = 0; row < height_; ++row)
      for (Index column = 0; column < width_; ++column) {
        float sum = 0;
        int covered = 0;
        for (Index r = row * samples_per_unit; r < (row + 1) * samples_per_unit; ++r)
          for (Index c = column * samples_per_unit; c < (column + 1) * samples_per_unit; ++c)
            if (!exactly_equal(shade_(c, r), nothing)) {
              sum += shade_(c, r);
              ++covered;
            }
        use(column, row, sum, covered);
      }
  }

  Index width_, height_;
  Grid depth_, shade_;
};

}  // namespace corotet::inline v0_1::detail
