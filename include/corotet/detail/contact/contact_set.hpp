// The contacts of a body in a step, and what they remember from one step to the next.
#pragma once

#include <algorithm>
#include <concepts>
#include <corotet/detail/contact/contact_finder.hpp>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/mesh/box_tree.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace corotet::inline v0_1::detail {

/// What a set of contacts needs to know of ContactOptions.
struct ContactSetOptions {
  double friction = 0;
  double margin = 0;
  double max_depenetration = 1;
  Index per_point = 4;
};

/// Finds the contacts of a body's points with obstacles. Allocates in the constructor, and after a copy once.
class ContactSet {
 public:
  COROTET_COLD ContactSet(ContactPoints points, Obstacles& obstacles, const ContactSetOptions& options)
      : options_(options),
        points_(std::move(points)),
        obstacles_(&obstacles),
        capacity_(at(points_.size()) * at((std::max)(options.per_point, Index{1}))),
        start_(at(points_.size())),
        end_(start_),
        slack_(at(points_.size())),
        looked_again_(at(points_.size())),
        predicted_(at(points_.vertex_count()), Vec3<double>::Zero()) {
    reserve();
  }

  [[nodiscard]] const ContactPoints& points() const { return points_; }
  [[nodiscard]] Obstacles& obstacles() const { return *obstacles_; }
  [[nodiscard]] const Obstacle& obstacle_of(const PointContact& contact) const {
    return (*obstacles_)[contact.obstacle];
  }
  [[nodiscard]] std::vector<PointContact>& contacts() { return contacts_; }
  [[nodiscard]] const std::vector<PointContact>& contacts() const { return contacts_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Whether the body may touch a free obstacle in this step.
  [[nodiscard]] bool is_near_free() const { return is_near_free_; }
  /// Contacts that found no place in this step.
  [[nodiscard]] Index dropped() const { return dropped_; }
  /// Points of the piece that is stepped, and the longest edge of the box around them at rest, m.
  [[nodiscard]] Index size_here() const { return size_here_; }
  [[nodiscard]] double extent() const { return extent_; }

  void forget() { memory_.clear(); }

  /// Whether a point belongs to the piece of the body that is stepped.
  template <std::floating_point Scalar>
  [[nodiscard]] bool is_here(Index point, const TermState<Scalar>& state) const {
    return state.contains(points_.vertex(points_.first(point)));
  }
  /// Where a point is at a state, in the world, m.
  template <std::floating_point Scalar>
  [[nodiscard]] Vec3<double> place_of(Index point, const TermState<Scalar>& state) const {
    return points_.interpolate(point, [&](Index v) { return state.position(v); }) + state.origin;
  }

  /// The contacts of a step from this state, by obstacle and point.
  template <std::floating_point Scalar>
  void begin_step(const TermState<Scalar>& start) {
    reserve();
    contacts_.clear();
    dropped_ = 0;
    is_near_free_ = false;
    measure(start);
    h_ = double(start.h);
    for (std::size_t v = 0; v < predicted_.size(); ++v)
      if (const auto vertex = static_cast<Index>(v); start.contains(vertex))
        predicted_[v] =
            start.position(vertex).template cast<double>() + h_ * start.velocity(vertex).template cast<double>();
    Box around;
    double farthest = 0;
    for (Index p = 0; p < points_.size(); ++p) {
      if (!is_here(p, start)) continue;
      start_[at(p)] = place_of(p, start);
      end_[at(p)] =
          points_.interpolate(p, [&](Index v) -> const Vec3<double>& { return predicted_[at(v)]; }) + start.origin;
      looked_again_[at(p)] = false;
      around.add(start_[at(p)]);
      farthest = (std::max)(farthest, (end_[at(p)] - start_[at(p)]).norm());
      slack_[at(p)] = std::numeric_limits<double>::infinity();
    }
    const Vec3<double> centre = 0.5 * (around.low + around.high);
    const double radius = 0.5 * (around.high - around.low).norm();
    for (Index o = 0; o < obstacles_->size(); ++o) {
      const Obstacle& obstacle = (*obstacles_)[o];
      if (!obstacle.enabled) continue;
      const double speed = obstacle.velocity_at(centre).norm() + obstacle.angular_velocity.norm() * radius;
      const double path = farthest + h_ * speed;  // of any point, at most
      const double clear = obstacle.distance(centre).distance - options_.margin - radius;
      const bool is_far = clear > reach_factor * path + near_distance();
      is_near_free_ = is_near_free_ || (!is_far && obstacle.is_free());
      for (Index p = 0; p < points_.size(); ++p) {
        if (!is_here(p, start)) continue;
        if (is_far)
          slack_[at(p)] = (std::min)(slack_[at(p)], clear - path);
        else
          find(p, o);
      }
    }
  }

  /// Calls visit(point) for each point that may have leapt over an obstacle that it has no contact with;
  /// `end_of(vertex)` is where a vertex ends, m, relative to the state's origin, and `end_of_point(point)` where a
  /// point does, in the world.
  template <std::floating_point Scalar, class EndOf, class EndOfPoint, class Visit>
  void for_each_suspect(const TermState<Scalar>& state, const EndOf& end_of, const EndOfPoint& end_of_point,
                        const Visit& visit) const {
    double farthest2 = 0;  // from where vertices would be by their velocities
    for (std::size_t v = 0; v < predicted_.size(); ++v)
      if (const auto vertex = static_cast<Index>(v); state.contains(vertex))
        farthest2 = (std::max)(farthest2, (end_of(vertex) - predicted_[v]).squaredNorm());
    const double farthest = points_.amplification() * square_root(farthest2);
    for (Index p = 0; p < points_.size(); ++p)
      if (is_here(p, state) && (slack_[at(p)] < farthest || looked_again_[at(p)]))
        if ((end_of_point(p) - end_[at(p)]).norm() > slack_[at(p)]) visit(p);
  }
  /// Looks at the way to that end. Calls visit(contact) for each contact that it adds.
  template <class Visit>
  void find_crossings(Index point, const Vec3<double>& end, const Visit& visit) {
    end_[at(point)] = end;
    looked_again_[at(point)] = true;
    slack_[at(point)] = std::numeric_limits<double>::infinity();
    for (Index o = 0; o < obstacles_->size(); ++o) {
      const auto is_known = [&](const PointContact& c) { return c.point == point && c.obstacle == o; };
      if ((*obstacles_)[o].enabled && std::none_of(contacts_.begin(), contacts_.end(), is_known) && find(point, o))
        visit(contacts_.back());
    }
  }

  /// Orders contacts by obstacle and point, once all are found.
  void sort() { std::sort(contacts_.begin(), contacts_.end(), PointContact::precedes); }

  /// Remembers contacts with a force and points inside obstacles; of other pieces of the body what was remembered.
  /// `share_of(contact)`: of the force, that the multiplier takes over, 0 ... 1.
  template <std::floating_point Scalar, class ShareOf>
  void remember(const TermState<Scalar>& end, double gamma, const ShareOf& share_of) {
    next_memory_.clear();
    for (const ContactMemory& memory : memory_)
      if (!is_here(memory.point, end)) next_memory_.push_back(memory);
    const bool has_others = !next_memory_.empty();
    for (const PointContact& contact : contacts_)
      if (contact.is_inside || contact.normal.dot(contact.given) > 0)
        next_memory_.push_back(memory_of(contact, obstacle_of(contact), gamma, share_of(contact)));
    if (has_others) std::sort(next_memory_.begin(), next_memory_.end(), ContactMemory::precedes);
    memory_.swap(next_memory_);
  }

 private:
  // Of the points' extent: points as near as this are contacts, and a point that moves in by more than that touches.
  static constexpr double near_share = 2e-3, start_share = 1e-5;
  static constexpr double reach_factor = 1.5;  // how far a path is looked at, to its length

  template <std::floating_point Scalar>
  void measure(const TermState<Scalar>& start) {
    size_here_ = points_.size();
    extent_ = points_.extent();
    if (start.piece.local.empty()) return;
    Box box;
    size_here_ = 0;
    for (Index p = 0; p < points_.size(); ++p)
      if (is_here(p, start)) {
        ++size_here_;
        box.add(points_.interpolate(p, [&](Index v) { return start.rest[start.index(v)]; }));
      }
    extent_ = size_here_ == 0 ? 0 : (box.high - box.low).maxCoeff();
  }

  void reserve() {
    contacts_.reserve(capacity_);
    memory_.reserve(capacity_);
    next_memory_.reserve(capacity_);
  }

  [[nodiscard]] double near_distance() const { return near_share * extent_; }

  [[nodiscard]] const ContactMemory* memory_at(Index obstacle, Index point) const {
    ContactMemory key;
    key.obstacle = obstacle;
    key.point = point;
    const auto found = std::lower_bound(memory_.begin(), memory_.end(), key, ContactMemory::precedes);
    return found != memory_.end() && found->obstacle == obstacle && found->point == point ? &*found : nullptr;
  }

  /// Adds the contact of a point with an obstacle, if there is one.
  bool find(Index point, Index obstacle) {
    const Obstacle& other = (*obstacles_)[obstacle];
    const ContactQuery query{start_[at(point)], end_[at(point)], h_,
                             options_.margin,   near_distance(), options_.max_depenetration};
    const ContactMemory* before = memory_at(obstacle, point);
    const auto found = find_contact(query, other, reach_factor, before, slack_[at(point)]);
    if (!found) return false;
    if (contacts_.size() == capacity_) {
      ++dropped_;
      return false;
    }
    PointContact& contact = contacts_.emplace_back(*found);
    contact.point = point;
    contact.obstacle = obstacle;
    contact.friction = other.friction >= 0 ? other.friction : options_.friction;
    // A point that rests stays as it was; another one touches if it moves in by more than rounding.
    const double moves_in = -(contact.gap + contact.normal.dot(end_[at(point)] - contact.reference - contact.led));
    if (before != nullptr && before->force > 0)
      contact.phase = before->phase;
    else if (moves_in > start_share * extent_)
      contact.phase = ContactPhase::sticking;
    return true;
  }

  ContactSetOptions options_;
  ContactPoints points_;
  Obstacles* obstacles_;
  std::size_t capacity_;
  std::vector<PointContact> contacts_;
  std::vector<ContactMemory> memory_, next_memory_;  // by obstacle and point
  std::vector<Vec3<double>> start_, end_;            // of points, in the world, m; end: as guessed
  std::vector<double> slack_;                        // how far from there a point may end and still miss all else, m
  std::vector<bool> looked_again_;                   // at another end, in this step
  std::vector<Vec3<double>> predicted_;              // where vertices would be after the step by their velocities, m
  double h_ = 0;
  double extent_ = 0;
  Index dropped_ = 0, size_here_ = 0;
  bool is_near_free_ = false;
};

}  // namespace corotet::inline v0_1::detail
