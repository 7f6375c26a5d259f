// A body's surface in a step: what is nearest to a point, and on which side of it the point is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/contact_surface.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/mesh/closest_point.hpp>
#include <limits>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// The place of a surface that is nearest to a point.
struct NearestPlace {
  static constexpr Index none = -1;
  Index triangle = none;
  std::array<double, 3> weights{};  ///< of the triangle's corners
  SurfaceDistance surface{};        ///< of the point; the normal is unit, out of the body
};

/// The triangles of a ContactSurface where its points are at the start of a step. Allocates in the constructor alone.
class MovingSurface {
 public:
  COROTET_COLD explicit MovingSurface(ContactSurface surface)
      : surface_(std::move(surface)),
        start_(at(surface_.points().size()), Vec3<double>::Zero()),
        end_(start_),
        normal_(start_),
        boxes_(surface_.triangles().size()) {}

  [[nodiscard]] const ContactPoints& points() const { return surface_.points(); }
  [[nodiscard]] const std::vector<std::array<Index, 3>>& triangles() const { return surface_.triangles(); }

  /// Where points are at the start, and where their velocities would take them, in the world, m.
  [[nodiscard]] const Vec3<double>& start(Index point) const { return start_[at(point)]; }
  [[nodiscard]] const Vec3<double>& end(Index point) const { return end_[at(point)]; }
  /// Where a point has come to.
  void set_end(Index point, const Vec3<double>& place) { end_[at(point)] = place; }
  /// Out of the body at a point at the start: the mean of its triangles' normals by their areas, unit.
  [[nodiscard]] const Vec3<double>& normal(Index point) const { return normal_[at(point)]; }
  /// All that points pass through.
  [[nodiscard]] const Box& swept() const { return swept_; }
  /// The mean way of all points, and how much that of any differs from it, m.
  [[nodiscard]] const Vec3<double>& mean_way() const { return mean_way_; }
  [[nodiscard]] double spread() const { return spread_; }
  /// What its triangles are in at the start: after `prepare`.
  [[nodiscard]] Box bounds() const { return tree_.bounds(); }

  /// Takes the step's start: `start_of(point)` and `end_of(point)`.
  template <class StartOf, class EndOf>
  void begin_step(const StartOf& start_of, const EndOf& end_of) {
    swept_ = Box{};
    mean_way_.setZero();
    spread_ = 0;
    for (Index p = 0; p < points().size(); ++p) {
      start_[at(p)] = start_of(p);
      end_[at(p)] = end_of(p);
      normal_[at(p)].setZero();
      swept_.add(start_[at(p)]);
      swept_.add(end_[at(p)]);
      mean_way_ += (end_[at(p)] - start_[at(p)]) / double(points().size());
    }
    for (std::size_t p = 0; p < start_.size(); ++p)
      spread_ = (std::max)(spread_, (end_[p] - start_[p] - mean_way_).norm());
    is_fresh_ = false;
  }
  /// What queries need; `begin_step` leaves it out, as most steps touch nothing.
  void prepare() {
    if (is_fresh_) return;
    is_fresh_ = true;
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
      boxes_[t] = Box{};
      const Vec3<double> area = area_of(static_cast<Index>(t));
      for (const Index p : triangles()[t]) {
        boxes_[t].add(start_[at(p)]);
        normal_[at(p)] += area;
      }
    }
    for (Vec3<double>& n : normal_) n = n.isZero() ? n : n.normalized();
    if (tree_.empty())
      tree_ = BoxTree(boxes_);  // the first time only
    else
      tree_.refit(boxes_);
  }

  /// The place nearest to x among the triangles for which `takes(triangle, closest, height)` holds: its nearest point,
  /// and how far x is before its plane. Of several at the same distance, which share an edge or a corner, the one that
  /// x is farthest before or behind of tells the side (Payne & Toga 1992). If x is no farther than `near_distance`, the
  /// normal is that of the one that faces `towards` most: what rests on a face up to its edge is not pushed aside
  /// there. Else it is along the way to the nearest point. No triangle within `most`: NearestPlace::none.
  template <class Takes>
  [[nodiscard]] NearestPlace nearest(const Vec3<double>& x, double most, double near_distance,
                                     const Vec3<double>& towards, const Takes& takes) const {
    NearestPlace best;
    double best2 = 0;
    const auto look_at = [&](Index t) {
      const SimplexPoint<3> closest = closest_on(t, x);
      const Vec3<double> normal = normal_of(t);
      const double height = normal.dot(x - start_[at(triangles()[at(t)][0])]);
      if (normal.isZero() || closest.squared_distance > most * most || !takes(t, closest, height))
        return std::numeric_limits<double>::infinity();
      const bool is_better = best.triangle == NearestPlace::none || closest.squared_distance < best2 * (1 - same) ||
                             (closest.squared_distance <= best2 * (1 + same) &&
                              std::fabs(height) > std::fabs(best.surface.distance) * (1 + same));
      if (is_better) {
        best2 = best.triangle == NearestPlace::none ? closest.squared_distance
                                                    : (std::min)(best2, closest.squared_distance);
        best = {t, closest.barycentric, {height, normal}};
      }
      return closest.squared_distance;
    };
    static_cast<void>(tree_.nearest(x, look_at, most * most));
    if (best.triangle == NearestPlace::none) return best;
    // Those at the same distance, which the tree need not have looked at.
    for_feature(best, [&](Index t) { static_cast<void>(look_at(t)); });
    const double distance = square_root(best2), side = best.surface.distance < 0 ? -1 : 1;
    if (distance > near_distance) {
      best.surface = {side * distance, side / distance * (x - start(best.triangle, best.weights))};
      return best;
    }
    double least = best.surface.normal.dot(towards);
    for_feature(best, [&](Index t) {
      const SimplexPoint<3> closest = closest_on(t, x);
      const Vec3<double> normal = normal_of(t);
      const double height = normal.dot(x - start_[at(triangles()[at(t)][0])]);
      if (normal.isZero() || !(normal.dot(towards) < least) || height * side < 0 ||
          closest.squared_distance > best2 * (1 + same) || !takes(t, closest, height))
        return;
      least = normal.dot(towards);
      best = {t, closest.barycentric, {height, normal}};
    });
    return best;
  }

  /// Out of the body on a triangle at the start, unit; zero if it has no area.
  [[nodiscard]] Vec3<double> normal_of(Index t) const {
    const Vec3<double> area = area_of(t);
    const double size = area.norm();
    return size > 0 ? area / size : Vec3<double>::Zero();
  }

  /// A point of a triangle at the start and after the step by velocities, m.
  [[nodiscard]] Vec3<double> start(Index triangle, const std::array<double, 3>& weights) const {
    return place(triangle, weights, start_);
  }
  [[nodiscard]] Vec3<double> end(Index triangle, const std::array<double, 3>& weights) const {
    return place(triangle, weights, end_);
  }

 private:
  static constexpr double same = 1e-9;  // relative

  [[nodiscard]] SimplexPoint<3> closest_on(Index t, const Vec3<double>& x) const {
    const auto& [a, b, c] = triangles()[at(t)];
    return closest_on_triangle(start_[at(a)], start_[at(b)], start_[at(c)], x);
  }
  [[nodiscard]] Vec3<double> area_of(Index t) const {
    const auto& [a, b, c] = triangles()[at(t)];
    return 0.5 * (start_[at(b)] - start_[at(a)]).cross(start_[at(c)] - start_[at(a)]);
  }
  /// Calls visit(triangle) for the triangles around the edge or the corner on which a place lies, if it does.
  template <class Visit>
  void for_feature(const NearestPlace& found, const Visit& visit) const {
    const std::array<double, 3> weights = found.weights;
    if (!is_zero(weights[0]) && !is_zero(weights[1]) && !is_zero(weights[2])) return;
    const std::array<Index, 3> corners = triangles()[at(found.triangle)];
    for (std::size_t k = 0; k < 3; ++k)
      if (!is_zero(weights[k]))
        for (const Index t : surface_.triangles_at(corners[k])) visit(t);
  }
  [[nodiscard]] Vec3<double> place(Index triangle, const std::array<double, 3>& weights,
                                   const std::vector<Vec3<double>>& x) const {
    const auto& [a, b, c] = triangles()[at(triangle)];
    return weights[0] * x[at(a)] + weights[1] * x[at(b)] + weights[2] * x[at(c)];
  }

  ContactSurface surface_;
  std::vector<Vec3<double>> start_, end_, normal_;  // one a point
  std::vector<Box> boxes_;                          // one a triangle
  BoxTree tree_;
  Box swept_;
  Vec3<double> mean_way_ = Vec3<double>::Zero();
  double spread_ = 0;
  bool is_fresh_ = false;
};

}  // namespace corotet::inline v0_1::detail
