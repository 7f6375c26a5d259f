// Bodies that have come to rest are not stepped until something wakes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/term_rest.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/mesh/box.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// When a body comes to rest.
struct SleepOptions {
  double speed = 0.01;         ///< m/s, > 0: no vertex, and no free obstacle that the body touches, is faster
  double time = 0.5;           ///< s, > 0: for so long
  double force_change = 0.02;  ///< > 0: how much contact forces may change in a step, of their sum
};

namespace detail {

/// What marks of a body tell of what acts on it: as cheap to compare as it is long.
struct SleepMarks {
  Revision state, motion, materials, pins;
  std::uint64_t pin_changes = 0, force_accesses = 0;
  Vec3<double> gravity = Vec3<double>::Zero();

  template <class Body>
  [[nodiscard]] static SleepMarks of_body(const Body& body) {
    return {body.revision(),
            body.motion_revision(),
            body.material_revision(),
            body.pins().revision(),
            body.pins().changes(),
            body.force_accesses(),
            body.gravity().template cast<double>()};
  }
  bool operator==(const SleepMarks&) const = default;
};

/// Of forces and pins: marks may be others though they are the same.
template <class Body>
[[nodiscard]] COROTET_COLD std::uint64_t hash_of_loads(const Body& body) {
  Fingerprint hash;
  const auto add = [&hash](const auto& v) {
    for (int i = 0; i < 3; ++i) hash.add(double(v[i]));
  };
  for (const auto& force : body.external_forces()) add(force);
  for (const auto& target : body.pins().targets()) add(target);
  for (const Index v : body.pins().vertices()) hash.add(v);
  for (const auto& axes : body.pins().axes()) hash.add(std::int32_t{axes.x} + 2 * axes.y + 4 * axes.z);
  return hash.value();
}
/// Of displacements and velocities.
template <class Body>
[[nodiscard]] COROTET_COLD std::uint64_t hash_of_state(const Body& body) {
  Fingerprint hash;
  for (const auto* field : {&body.displacements(), &body.velocities()})
    for (const auto& v : *field)
      for (int i = 0; i < 3; ++i) hash.add(double(v[i]));
  return hash.value();
}

/// A sphere around all vertices, m, in the world.
struct BodySphere {
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;

  template <class Body>
  [[nodiscard]] COROTET_COLD static BodySphere around(const Body& body) {
    Box box;
    for (Index v = 0; v < body.vertex_count(); ++v) box.add(body.position(v).template cast<double>());
    return {body.origin() + 0.5 * (box.low + box.high), 0.5 * (box.high - box.low).norm()};
  }
};

/// A body as Sleep knows it.
struct SleepMember {
  /// An obstacle that it touches, and what it did to it in the last step.
  struct Support {
    Index obstacle;
    ObstacleLoad load;
    double reach;  // from the obstacle's origin to the farthest touch, m
  };

  SleepMarks marks;
  std::uint64_t loads_hash = 0, state_hash = 0;
  StepReport report;
  std::vector<Support> supports;
  std::vector<const void*> terms;
  BodySphere sphere;
  double quiet = 0;                 // for how long it has been at rest, s
  double slowest = 0, fastest = 0;  // of its fastest vertex in that time, m/s
  double h = 0;                     // of the last step, s
  double margin = 0;                // of its contacts, m
  Index island = 0;                 // that it fell asleep with
  bool asleep = false, settled = false, reached = false;

  void restart() { quiet = slowest = fastest = 0; }
  [[nodiscard]] bool touches(Index obstacle) const {
    return std::any_of(supports.begin(), supports.end(), [&](const Support& s) { return s.obstacle == obstacle; });
  }
};

}  // namespace detail

/// Lets bodies that have come to rest sleep: they are not stepped, and cost next to nothing.
///
/// Use one for all bodies that touch the same obstacles, and step them by it:
/// @snippet contact.cpp sleep
/// A body falls asleep when for half a second none of its vertices is faster than 1 cm/s, that speed stays the same
/// within a tenth of the bound (it is no pendulum at its turning point), and contact forces are steady. Its velocities
/// become zero; it keeps bearing on the obstacles that it touches. Bodies that touch the same free obstacle are an
/// island: they fall asleep together, and the obstacle with them, and wake together.
///
/// A body wakes, with its island, when an obstacle moves that it touches or that comes near, by `wake`, and when its
/// state, gravity, forces, pins, materials or terms are changed; writing the same values again wakes nothing. Contacts
/// and Attachment tell what changes; with a term that does not (StepTerm::describe_rest) a body never sleeps.
///
/// Calls for bodies of one Sleep come one after the other. It is deterministic: copies of it, of bodies, integrators,
/// contacts and obstacles go on as these do. A body that is restored from a snapshot sleeps on where that is the state
/// in which it sleeps.
class Sleep {
 public:
  /// `obstacles` must outlive it.
  COROTET_COLD explicit Sleep(Obstacles& obstacles, SleepOptions options = {})
      : obstacles_(&obstacles), options_(options) {
    COROTET_ASSERT(options.speed > 0 && options.time > 0 && options.force_change > 0,
                   "bounds below which a body sleeps must be positive");
  }

  /// Another body; returns its number.
  COROTET_COLD Index add() {
    members_.emplace_back();
    island_.reserve(members_.size());
    return size() - 1;
  }
  /// Two bodies act on each other otherwise than by obstacles: they sleep and wake together.
  COROTET_COLD void tie(Index a, Index b) { ties_.emplace_back(a, b); }

  /// Number of bodies.
  [[nodiscard]] Index size() const { return size_of(members_); }
  /// What it was made with.
  [[nodiscard]] const SleepOptions& options() const { return options_; }
  /// Whether a body sleeps.
  [[nodiscard]] bool is_asleep(Index i) const { return members_[at(i)].asleep; }
  /// Wakes a body and those that sleep with it: from their next steps on.
  void wake(Index i) {
    SleepMember& member = members_[at(i)];
    member.restart();
    if (!member.asleep) return;
    for (SleepMember& other : members_)
      if (other.asleep && other.island == member.island) {
        other.asleep = false;
        other.restart();
      }
    releases_ = true;
  }

  /// A step of body i by its integrator, unless it sleeps: then the report is that of the last step, without
  /// iterations. Once a frame for each body, and then Obstacles::advance or Obstacles::end_step.
  template <class Integrator, class Body>
  StepReport step(Index i, Integrator& integrator, Body& body, typename Body::scalar_type h,
                  const StepContext<typename Body::scalar_type>& context = {}) {
    if (!begin_step(i, body, h, context.terms)) return members_[at(i)].report;
    const StepReport report = integrator.step(body, h, context);
    end_step(i, body, h, context.terms, report);
    return report;
  }

  /// For steps that you call yourself: whether the body must be stepped.
  template <class Body>
  [[nodiscard]] bool begin_step(Index i, Body& body, double h, const Terms<typename Body::scalar_type>& terms);
  /// Likewise, after the step.
  template <class Body>
  void end_step(Index i, const Body& body, double h, const Terms<typename Body::scalar_type>& terms,
                const StepReport& report);

 private:
  using SleepMember = detail::SleepMember;

  static constexpr double steady_share = 0.1;  // of the bound of speed: how much the speed may change
  static constexpr double led_share = 0.01;    // likewise: a led obstacle that is slower does not move
  static constexpr double reach_frames = 3;    // steps ahead in which what comes near wakes
  static constexpr double near_share = 4e-3;   // of the body's radius: contact begins that far from an obstacle

  /// An obstacle as it was when it moved last.
  struct Seen {
    Pose pose;
    Vec3<double> force = Vec3<double>::Zero(), torque = force;
    double friction = 0;
    bool enabled = false, known = false;

    [[nodiscard]] static Seen now(const Obstacle& o) {
      return {o.pose(), o.force, o.torque, o.friction, o.enabled, true};
    }
  };

  template <class Body>
  [[nodiscard]] bool is_unchanged(SleepMember& member, const Body& body) const;
  template <std::floating_point Scalar>
  [[nodiscard]] bool terms_rest(SleepMember& member, const Terms<Scalar>& terms) const;
  void begin_frame(double h);
  [[nodiscard]] bool has_moved(Index o);
  [[nodiscard]] bool meets(const detail::BodySphere& sphere, double margin, Index o, double speed, double h) const;
  [[nodiscard]] bool is_slow(const SleepMember::Support& support) const;
  void add_touch(SleepMember& member, const Touch& touch) const;
  void wake_sleepers_on(Index obstacle);
  void fall_asleep_with(Index i);

  Obstacles* obstacles_;
  SleepOptions options_;
  std::vector<SleepMember> members_;
  std::vector<std::pair<Index, Index>> ties_;
  std::vector<Seen> seen_;                       // obstacles
  std::vector<Index> moved_;                     // obstacles in this frame
  std::vector<Index> frozen_;                    // obstacles that sleep
  std::vector<Index> island_;                    // scratch: bodies
  Vec3<double> gravity_ = Vec3<double>::Zero();  // of free obstacles
  std::uint64_t frame_ = (std::numeric_limits<std::uint64_t>::max)();
  Index islands_ = 0;
  bool releases_ = false;  // some obstacles need not sleep any more
};

template <class Body>
bool Sleep::begin_step(Index i, Body& body, double h, const Terms<typename Body::scalar_type>& terms) {
  SleepMember& member = members_[at(i)];
  if (frame_ != obstacles_->frame()) begin_frame(h);
  const bool unchanged = is_unchanged(member, body), rests = terms_rest(member, terms);
  if (!member.asleep) {
    if (!unchanged || !rests) member.restart();
    return true;
  }
  bool wakes = !unchanged || !rests;
  if (!wakes && !member.settled) {
    body.stop();
    member.marks = detail::SleepMarks::of_body(body);
    member.state_hash = detail::hash_of_state(body);
    member.sphere = detail::BodySphere::around(body);
    member.settled = true;
  }
  for (std::size_t k = 0; !wakes && k < moved_.size(); ++k)
    wakes = !(*obstacles_)[moved_[k]].is_asleep() && meets(member.sphere, member.margin, moved_[k], 0, h);
  if (wakes) {
    wake(i);
    return true;
  }
  for (const SleepMember::Support& support : member.supports)
    (*obstacles_)[support.obstacle].add_load(
        {h / member.h * support.load.impulse, h / member.h * support.load.angular_impulse});
  return false;
}

template <class Body>
void Sleep::end_step(Index i, const Body& body, double h, const Terms<typename Body::scalar_type>& terms,
                     const StepReport& report) {
  SleepMember& member = members_[at(i)];
  member.report = report;
  member.report.iterations = member.report.newton_iterations = 0;
  member.marks = detail::SleepMarks::of_body(body);
  member.h = h;
  member.margin = 0;
  member.supports.clear();
  member.terms.clear();
  double force = 0, change = 0;
  bool rests = report.accepted();
  for (std::size_t k = 0; k < terms.size(); ++k) {
    TermRest rest;
    member.terms.push_back(&terms[k]);
    rests = terms[k].describe_rest(rest) && (rest.obstacles == nullptr || rest.obstacles == obstacles_) && rests;
    force += rest.force;
    change += rest.force_change;
    member.margin = (std::max)(member.margin, rest.margin);
    if (rest.obstacles == obstacles_)
      for (const Touch& touch : rest.touches) add_touch(member, touch);
  }
  rests = rests && change <= options_.force_change * force;
  for (const SleepMember::Support& support : member.supports)  // of a free one, other bodies' steps decide yet
    rests = rests && ((*obstacles_)[support.obstacle].is_free() || is_slow(support));

  double fastest2 = 0;
  for (const auto& v : body.velocities()) fastest2 = (std::max)(fastest2, double(v.squaredNorm()));
  const double fastest = detail::square_root(fastest2);
  if (!frozen_.empty()) {  // what sleeps wakes before it is struck
    const detail::BodySphere sphere = detail::BodySphere::around(body);
    for (const Index o : frozen_)
      if (member.touches(o) || meets(sphere, member.margin, o, fastest, h)) wake_sleepers_on(o);
  }

  if (!rests || fastest > options_.speed) return member.restart();
  if (member.quiet > 0) {
    member.slowest = (std::min)(member.slowest, fastest);
    member.fastest = (std::max)(member.fastest, fastest);
    if (member.fastest - member.slowest > steady_share * options_.speed) member.restart();
  }
  if (!(member.quiet > 0)) member.slowest = member.fastest = fastest;
  member.quiet += h;
  if (member.quiet >= options_.time) fall_asleep_with(i);
}

/// Whether body and what acts on it are as its marks say.
template <class Body>
bool Sleep::is_unchanged(SleepMember& member, const Body& body) const {
  const detail::SleepMarks now = detail::SleepMarks::of_body(body), before = std::exchange(member.marks, now);
  if (now == before) return true;
  bool same = now.materials == before.materials && now.gravity == before.gravity;
  if (now.pins != before.pins || now.pin_changes != before.pin_changes || now.force_accesses != before.force_accesses) {
    const std::uint64_t hash = detail::hash_of_loads(body);
    same = hash == std::exchange(member.loads_hash, hash) && same;
  }
  if (now.state != before.state || now.motion != before.motion)
    same = same && member.asleep && member.settled && detail::hash_of_state(body) == member.state_hash;
  return same;
}

/// Whether terms are those of the last step, and tell that nothing has changed.
template <std::floating_point Scalar>
bool Sleep::terms_rest(SleepMember& member, const Terms<Scalar>& terms) const {
  bool same = terms.size() == member.terms.size();
  for (std::size_t k = 0; same && k < terms.size(); ++k) {
    TermRest rest;
    same = &terms[k] == member.terms[k] && terms[k].describe_rest(rest) && !rest.has_changed;
  }
  return same;
}

/// Before any body of the frame is stepped.
COROTET_COLD inline void Sleep::begin_frame(double h) {
  frame_ = obstacles_->frame();
  moved_.clear();
  for (Index o = 0; o < obstacles_->size(); ++o)
    if (has_moved(o)) {
      moved_.push_back(o);
      wake_sleepers_on(o);
    }
  gravity_ = obstacles_->gravity;
  for (SleepMember& member : members_)
    if (!std::all_of(member.supports.begin(), member.supports.end(),
                     [&](const SleepMember::Support& s) { return !(*obstacles_)[s.obstacle].is_free() || is_slow(s); }))
      member.restart();
  if (releases_) {
    releases_ = false;
    std::erase_if(frozen_, [&](Index o) {
      const bool sleeps =
          std::any_of(members_.begin(), members_.end(), [&](const SleepMember& m) { return m.asleep && m.touches(o); });
      if (!sleeps) (*obstacles_)[o].set_asleep(false);
      return !sleeps;
    });
  }
  obstacles_->begin_step(h);
}

/// Whether an obstacle moves, or is not where or as it was.
inline bool Sleep::has_moved(Index o) {
  const Obstacle& obstacle = (*obstacles_)[o];
  const double least = led_share * options_.speed, way = least * options_.time;
  if (at(o) >= seen_.size()) seen_.resize(at(o) + 1);
  Seen& seen = seen_[at(o)];
  bool differs = !seen.known || obstacle.enabled != seen.enabled ||
                 !detail::exactly_equal(obstacle.friction, seen.friction) ||
                 (obstacle.pose().position - seen.pose.position).squaredNorm() > way * way ||
                 (obstacle.pose().rotation - seen.pose.rotation).squaredNorm() > way * way;
  if (obstacle.is_asleep())
    differs =
        differs || obstacle.force != seen.force || obstacle.torque != seen.torque || obstacles_->gravity != gravity_;
  if (differs) seen = Seen::now(obstacle);
  return differs || obstacle.is_free() || obstacle.velocity.squaredNorm() > least * least ||
         obstacle.angular_velocity.squaredNorm() > least * least;
}

/// Whether an obstacle may reach a body that is `speed` fast in the next steps.
inline bool Sleep::meets(const detail::BodySphere& sphere, double margin, Index o, double speed, double h) const {
  const Obstacle& obstacle = (*obstacles_)[o];
  if (!obstacle.enabled) return false;
  const double against =
      obstacle.velocity_at(sphere.centre).norm() + obstacle.angular_velocity.norm() * sphere.radius + speed;
  return obstacle.distance(sphere.centre).distance - sphere.radius - margin <=
         reach_frames * h * against + near_share * sphere.radius;
}

/// Whether an obstacle that a body touches does not keep it awake.
inline bool Sleep::is_slow(const SleepMember::Support& support) const {
  const Obstacle& obstacle = (*obstacles_)[support.obstacle];
  const double speed = obstacle.velocity.norm() + obstacle.angular_velocity.norm() * support.reach;
  return speed <= (obstacle.mass() > 0 ? 1 : led_share) * options_.speed;
}

inline void Sleep::add_touch(SleepMember& member, const Touch& touch) const {
  auto support = member.supports.begin();
  while (support != member.supports.end() && support->obstacle != touch.obstacle) ++support;
  if (support == member.supports.end())
    support = member.supports.insert(support, SleepMember::Support{touch.obstacle, ObstacleLoad{}, 0});
  const Vec3<double> arm = touch.place - (*obstacles_)[touch.obstacle].pose().position;
  support->load.impulse -= touch.impulse;
  support->load.angular_impulse -= arm.cross(touch.impulse);
  support->reach = (std::max)(support->reach, arm.norm());
}

COROTET_COLD inline void Sleep::wake_sleepers_on(Index obstacle) {
  for (Index i = 0; i < size(); ++i)
    if (members_[at(i)].asleep && members_[at(i)].touches(obstacle)) wake(i);
}

/// Puts the island of a body to sleep, if all of it has been at rest for long enough.
COROTET_COLD inline void Sleep::fall_asleep_with(Index i) {
  for (SleepMember& member : members_) member.reached = false;
  island_.assign(1, i);
  members_[at(i)].reached = true;
  const auto add = [&](Index j) {
    if (members_[at(j)].reached) return;
    members_[at(j)].reached = true;
    island_.push_back(j);
  };
  for (std::size_t k = 0; k < island_.size(); ++k) {  // NOLINT(modernize-loop-convert): it grows
    const Index here = island_[k];
    if (members_[at(here)].quiet < options_.time) return;
    for (const SleepMember::Support& support : members_[at(here)].supports)
      if ((*obstacles_)[support.obstacle].mass() > 0)
        for (Index j = 0; j < size(); ++j)
          if (members_[at(j)].touches(support.obstacle)) add(j);
    for (const auto& [a, b] : ties_) {
      if (a == here) add(b);
      if (b == here) add(a);
    }
  }
  ++islands_;
  for (const Index j : island_) {
    SleepMember& member = members_[at(j)];
    member.asleep = true;
    member.settled = false;
    member.island = islands_;
    for (const SleepMember::Support& support : member.supports) {
      Obstacle& obstacle = (*obstacles_)[support.obstacle];
      if (!obstacle.is_free()) continue;
      obstacle.set_asleep(true);
      seen_[at(support.obstacle)] = Seen::now(obstacle);
      frozen_.push_back(support.obstacle);
    }
  }
}

}  // namespace corotet::inline v0_1
