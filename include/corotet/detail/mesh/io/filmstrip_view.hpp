// How the frames of an animation are projected into the panels of a picture, and lit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/animation.hpp>
#include <corotet/detail/mesh/io/animation_view.hpp>
#include <corotet/detail/mesh/io/shade_image.hpp>
#include <limits>
#include <vector>

namespace corotet::inline v0_1::detail {

/// The parallel projection of all frames into panels of one size.
class FilmstripView {
 public:
  FilmstripView(const Animation& animation, const std::vector<Index>& frames, double panel_width)
      : box_(box_of(animation)) {
    const AnimationAxes axes = axes_of(animation, box_);
    const double ca = std::cos(view_azimuth), sa = std::sin(view_azimuth), ce = std::cos(view_elevation),
                 se = std::sin(view_elevation);
    const Vec3<double> level = axes.along * ca + axes.across * sa;
    right_ = axes.across * ca - axes.along * sa;
    back_ = level * ce + axes.up * se;
    top_ = axes.up * ce - level * se;
    up_ = {right_.dot(axes.up), top_.dot(axes.up), back_.dot(axes.up)};

    constexpr double inf = std::numeric_limits<double>::infinity();
    double low_x = inf, low_y = inf, high_x = -inf, high_y = -inf;
    for (const Index k : frames)
      for (const auto* all : {&animation.surface_frames, &animation.line_frames}) {
        if (all->empty()) continue;
        for (const Vec3<double>& x : (*all)[at(k)]) {
          const PicturePoint p = (*this)(x);  // not yet moved and scaled
          low_x = (std::min)(low_x, p.x);
          high_x = (std::max)(high_x, p.x);
          low_y = (std::min)(low_y, p.y);
          high_y = (std::max)(high_y, p.y);
        }
      }
    const double wide = high_x - low_x, tall = high_y - low_y;
    constexpr double tallest = 1.2;  // height of a panel by its width, at most
    scale_ = (std::min)(wide > 0 ? panel_width / wide : inf, tall > 0 ? tallest * panel_width / tall : inf);
    if (!std::isfinite(scale_)) scale_ = 1;
    height_ = (std::max)(1.0, scale_ * tall);
    left_ = low_x - (panel_width / scale_ - wide) / 2;  // in the middle, if it is the height that limits
    upper_ = low_y;
  }

  /// A position in units of the longest side of the box, from its corner: never too large or too small to multiply.
  [[nodiscard]] Vec3<double> relative(const Vec3<double>& x) const {
    Vec3<double> p(0, 0, 0);
    for (int i = 0; i < 3; ++i) p[i] = box_.longest > 0 ? (x[i] - box_.low[i]) / box_.longest : 0;
    return p;
  }

  /// Pixels in a panel, and depth in units of the longest side of the box.
  [[nodiscard]] PicturePoint operator()(const Vec3<double>& x) const {
    const Vec3<double> p = relative(x);
    return {scale_ * (right_.dot(p) - left_), scale_ * (-top_.dot(p) - upper_), back_.dot(p)};
  }

  /// Brightness of a surface with this unit normal, from 0 to 1.
  [[nodiscard]] double shade(const Vec3<double>& normal) const {
    const std::array<double, 3> n{right_.dot(normal), top_.dot(normal), back_.dot(normal)};
    const double diffuse = (std::max)(0.0, n[0] * view_light[0] + n[1] * view_light[1] + n[2] * view_light[2]);
    const double sky = 0.5 + 0.5 * (n[0] * up_[0] + n[1] * up_[1] + n[2] * up_[2]);
    return std::clamp(0.16 * sky + 0.84 * diffuse, 0.0, 1.0);
  }

  [[nodiscard]] double height() const { return height_; }

 private:
  AnimationBox box_;
  Vec3<double> right_, top_, back_;
  std::array<double, 3> up_{};
  double scale_ = 1, left_ = 0, upper_ = 0, height_ = 1;
};

}  // namespace corotet::inline v0_1::detail
