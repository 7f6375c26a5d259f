// From where an animation is seen at first, and how its times are written.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/animation.hpp>
#include <string>

namespace corotet::inline v0_1::detail {

/// Three unit axes, right-handed; `along` is the horizontal one in which the animation is longer.
struct AnimationAxes {
  Vec3<double> along, across, up;
};

inline AnimationAxes axes_of(const Animation& animation, const AnimationBox& box) {
  const Vec3<double>& u = animation.up;
  const double largest = u.cwiseAbs().maxCoeff();
  const Vec3<double> up = (u / largest).normalized();
  // The x axis made horizontal, or the y axis where x is nearly up.
  const Vec3<double> start = std::fabs(up[0]) < 0.9 ? Vec3<double>(1, 0, 0) : Vec3<double>(0, 1, 0);
  const Vec3<double> first = (start - up * up.dot(start)).normalized();
  const Vec3<double> second = up.cross(first);
  const auto length = [&](const Vec3<double>& axis) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += std::fabs(axis[i]) * (box.longest > 0 ? box.extent[i] / box.longest : 0);
    return sum;
  };
  if (length(second) > length(first)) return {second, first * -1.0, up};
  return {first, second, up};
}

/// The first view: from the side, a little from the far end of the longer axis, a little from above. Radians.
inline constexpr double view_azimuth = -1.107, view_elevation = 0.296;

/// Towards the light, in axes that point right, up and to the eye; unit.
inline constexpr std::array<double, 3> view_light{0, 0.66, 0.75};

/// As many decimals as tell one frame from the next.
inline int time_decimals(const Animation& animation) {
  return static_cast<int>(std::clamp(std::ceil(-std::log10(animation.frame_seconds)), 0.0, 9.0));
}

inline std::string fixed_text(double value, int decimals) {
  std::array<char, 400> digits;  // the largest double has 309 before the point
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals).ptr;
  return {digits.data(), end};
}

}  // namespace corotet::inline v0_1::detail
