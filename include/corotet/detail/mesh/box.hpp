// An axis-aligned box.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <limits>

namespace corotet::inline v0_1 {

/// An axis-aligned box, m. As constructed it is empty: it contains nothing and grows to whatever is added.
struct Box {
  /// The corner of the smallest coordinates, m.
  Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity());
  /// The corner of the largest coordinates, m.
  Vec3<double> high = Vec3<double>::Constant(-std::numeric_limits<double>::infinity());

  /// Grows to contain a point, m.
  void add(const Vec3<double>& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  /// Grows to contain another box.
  void add(const Box& box) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  /// Whether a point, m, lies inside or on the boundary.
  [[nodiscard]] bool contains(const Vec3<double>& p) const {
    for (int i = 0; i < 3; ++i)
      if (!(p[i] >= low[i] && p[i] <= high[i])) return false;
    return true;
  }
  /// Whether another box has a point in common with this one.
  [[nodiscard]] bool overlaps(const Box& other) const {
    for (int i = 0; i < 3; ++i)
      if (!(other.low[i] <= high[i] && other.high[i] >= low[i])) return false;
    return true;
  }
  /// From `p` to the nearest point of the box, m^2; 0 inside.
  [[nodiscard]] double squared_distance(const Vec3<double>& p) const {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
  }
};

}  // namespace corotet::inline v0_1
