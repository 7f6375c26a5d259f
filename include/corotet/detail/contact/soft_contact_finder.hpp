// Which points of soft bodies may touch which triangles in a step.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/contact/contact_finder.hpp>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/moving_surface.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/contact/soft_side.hpp>
#include <corotet/detail/core/types.hpp>
#include <limits>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Finds the contacts of a step, each point with the nearest place of each other body that it may touch.
template <std::floating_point Scalar>
class SoftContactFinder {
 public:
  using Side = SoftSide<Scalar>;

  static constexpr double near_share = 2e-3;  ///< of the points' extent: as near as this, points are contacts

  /// `memory`: of the last step, by pair and point. `bodies`: how many there are.
  SoftContactFinder(const ContactOptions& options, Index bodies, const std::vector<ContactMemory>& memory,
                    std::vector<SoftContact>& contacts)
      : options_(options), bodies_(bodies), memory_(&memory), contacts_(&contacts) {}

  /// Adds the contacts of points of `a` with triangles of `b`, which may be the same body.
  void find_between(Side& a, Side& b);

  /// Contacts that found no place.
  [[nodiscard]] Index dropped() const { return dropped_; }

 private:
  static constexpr double most_facing = 0.3;   // cosine of a point's normal and that of what it may touch
  static constexpr double reach_factor = 1.5;  // how far a path is looked at, to its length
  static constexpr double lead_out_time = 1;   // s, in which a point inside is led through the smaller body at most
  static constexpr double start_share = 1e-5;  // of the points' extent: what moves in by more touches

  [[nodiscard]] bool find(const Side& a, Index point, Side& b);
  [[nodiscard]] static bool faces(const Side& a, Index point, const Side& b, Index triangle);
  [[nodiscard]] static bool may_touch_itself(const Side& a, Index point, Index triangle, const SimplexPoint<3>& closest,
                                             double height, bool has_touched);
  [[nodiscard]] const ContactMemory* memory_at(Index pair, Index point) const;
  [[nodiscard]] static double near_distance(const Side& a, const Side& b) {
    return near_share * (std::max)(a.surface.points().extent(), b.surface.points().extent());
  }
  [[nodiscard]] Index pair_of(Index a, Index b) const { return a * bodies_ + b; }

  const ContactOptions& options_;
  Index bodies_;
  const std::vector<ContactMemory>* memory_;
  std::vector<SoftContact>* contacts_;
  Index dropped_ = 0;
};

template <std::floating_point Scalar>
void SoftContactFinder<Scalar>::find_between(Side& a, Side& b) {
  const double around = options_.margin + near_distance(a, b);
  const double farthest =
      a.surface.mean_way().norm() + a.surface.spread() + b.surface.mean_way().norm() + b.surface.spread();
  const Vec3<double> inflation = Vec3<double>::Constant(around + (reach_factor - 1) * farthest);
  const Box there{b.surface.swept().low - inflation, b.surface.swept().high + inflation};
  if (!there.overlaps(a.surface.swept())) return;
  a.surface.prepare();
  b.surface.prepare();
  for (Index p = 0; p < a.surface.points().size(); ++p) {
    Box way;
    way.add(a.surface.start(p));
    way.add(a.surface.end(p));
    if (there.overlaps(way)) static_cast<void>(find(a, p, b));
  }
}

template <std::floating_point Scalar>
bool SoftContactFinder<Scalar>::find(const Side& a, Index point, Side& b) {
  const Vec3<double> start = a.surface.start(point);
  const double near_by = near_distance(a, b);
  const ContactMemory* before = memory_at(pair_of(a.body, b.body), point);
  const Vec3<double> towards = a.surface.normal(point);
  bool fits = true;  // whether the place that was found last may be touched by the way it faces
  // How far the point may come against the other surface; what lies farther is not looked at. A point inside, which
  // only one within the bounds can be, may be at any depth.
  const double reach =
      options_.margin + near_by +
      reach_factor * ((a.surface.end(point) - start - b.surface.mean_way()).norm() + b.surface.spread());
  const bool may_be_inside = before != nullptr || (a.body != b.body && b.surface.bounds().contains(start));
  const double most = may_be_inside ? std::numeric_limits<double>::infinity() : reach;
  const auto nearest = [&](const Vec3<double>& x, bool at_start) {
    fits = true;
    if (a.body == b.body)
      return b.surface.nearest(x, most, near_by, towards, [&](Index t, const SimplexPoint<3>& closest, double height) {
        return faces(a, point, b, t) && may_touch_itself(a, point, t, closest, height, before != nullptr);
      });
    const auto any = [](Index, const SimplexPoint<3>&, double) { return true; };
    NearestPlace place = b.surface.nearest(x, most, near_by, towards, any);
    if (place.triangle == NearestPlace::none) return place;
    fits = place.surface.normal.dot(towards) <= most_facing;
    const bool has_come_in = place.surface.distance < 0 || before != nullptr;
    if (fits || !at_start || (place.surface.distance > near_by && !has_come_in)) return place;
    // Come in by the other side of a thin body, or through it, which it leaves by the side on which it came; or beside
    // an edge on which it rests.
    const NearestPlace facing = b.surface.nearest(
        x, most, near_by, towards, [&](Index t, const SimplexPoint<3>&, double) { return faces(a, point, b, t); });
    fits = facing.triangle != NearestPlace::none &&
           (std::fabs(facing.surface.distance) <= near_by || (has_come_in && facing.surface.distance < 0));
    return fits ? facing : place;
  };
  NearestPlace place = nearest(start, true);
  if (place.triangle == NearestPlace::none) return false;
  const auto less_margin = [this](SurfaceDistance surface) {
    surface.distance -= options_.margin;
    return surface;
  };
  const Vec3<double> path =
      a.surface.end(point) - start -
      (b.surface.end(place.triangle, place.weights) - b.surface.start(place.triangle, place.weights));
  const ContactQuery query{start, start + path, a.h, options_.margin, near_by, options_.max_depenetration};
  double slack = std::numeric_limits<double>::infinity();
  const auto hit = follow_path(
      query, path, less_margin(place.surface), reach_factor,
      [&](const Vec3<double>& x) {
        const NearestPlace next = nearest(x, false);
        if (next.triangle == NearestPlace::none) {  // farther than it can come
          fits = false;
          return SurfaceDistance{reach, place.surface.normal};
        }
        place = next;
        return less_margin(place.surface);
      },
      slack);
  if (!hit || !fits) return false;
  if (contacts_->size() == contacts_->capacity()) {
    ++dropped_;
    return false;
  }
  SoftContact& contact = contacts_->emplace_back();
  contact.side = a.body;
  contact.other = b.body;
  contact.obstacle = pair_of(a.body, b.body);
  contact.point = point;
  contact.triangle = place.triangle;
  contact.weights = place.weights;
  contact.normal = hit->surface.normal;
  const Vec3<double> touched = b.surface.start(place.triangle, place.weights);
  contact.start = start - touched;  // relative to the place on the triangle, as all that follows
  contact.reference = hit->place - touched;
  contact.led.setZero();
  contact.arm.setZero();
  contact.friction = options_.friction;
  // Faster, edges that cross would throw small bodies about.
  const double extent = (std::min)(a.surface.points().extent(), b.surface.points().extent());
  contact.set_gap(hit->surface.distance, (std::min)(options_.max_depenetration, extent / lead_out_time) * a.h);
  if (before != nullptr) contact.take(*before);
  const Vec3<double> end = a.surface.end(point) - b.surface.end(place.triangle, place.weights);
  const double moves_in = -(contact.gap + contact.normal.dot(end - contact.reference));
  if (before != nullptr && before->force > 0)
    contact.phase = before->phase;
  else if (moves_in > start_share * a.surface.points().extent())
    contact.phase = ContactPhase::sticking;
  return true;
}

/// Whether a point may touch a triangle by the way they face: not one that it could come to only through its own body.
/// So an edge that rests on a face does not touch the sides, and a point that has come far into a thin body still
/// leaves it by the side on which it came.
template <std::floating_point Scalar>
bool SoftContactFinder<Scalar>::faces(const Side& a, Index point, const Side& b, Index triangle) {
  return a.surface.normal(point).dot(b.surface.normal_of(triangle)) <= most_facing;
}

/// Of a point and a triangle of the same body. Not where an element joins them. Behind the triangle is where the body's
/// own material is, unless the point has touched it before, and is far nearer than at rest.
template <std::floating_point Scalar>
bool SoftContactFinder<Scalar>::may_touch_itself(const Side& a, Index point, Index triangle,
                                                 const SimplexPoint<3>& closest, double height, bool has_touched) {
  constexpr double through_share = 0.25;  // of the distance at rest
  const ContactPoints& points = a.surface.points();
  const auto& corners = a.surface.triangles()[at(triangle)];
  Vec3<double> rest = Vec3<double>::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] == point) return false;
    rest += closest.barycentric[k] *
            points.interpolate(corners[k], [&](Index v) { return a.state.rest[a.state.index(v)]; });
  }
  rest -= points.interpolate(point, [&](Index v) { return a.state.rest[a.state.index(v)]; });
  if (height < 0 && !(has_touched && closest.squared_distance < through_share * through_share * rest.squaredNorm()))
    return false;
  const BlockPattern& pattern = a.system->matrix.pattern();
  for (Index e = points.first(point); e < points.last(point); ++e)
    for (const Index corner : corners)
      for (Index f = points.first(corner); f < points.last(corner); ++f)
        if (pattern.has(static_cast<Index>(a.state.index(points.vertex(e))),
                        static_cast<Index>(a.state.index(points.vertex(f)))))
          return false;
  return true;
}

template <std::floating_point Scalar>
const ContactMemory* SoftContactFinder<Scalar>::memory_at(Index pair, Index point) const {
  ContactMemory key;
  key.obstacle = pair;
  key.point = point;
  const auto found = std::lower_bound(memory_->begin(), memory_->end(), key, ContactMemory::precedes);
  return found != memory_->end() && found->obstacle == pair && found->point == point ? &*found : nullptr;
}

}  // namespace corotet::inline v0_1::detail
