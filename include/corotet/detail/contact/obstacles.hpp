// What bodies touch: solids that are led along paths, or move freely as rigid bodies.
#pragma once

#include <concepts>
#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/rotation/quaternion.hpp>
#include <cstdint>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// A frame in the world: x_world = position + R x.
struct Pose {
  Vec3<double> position = Vec3<double>::Zero();          ///< m
  Matrix<double, 4, 1> rotation = {1.0, 0.0, 0.0, 0.0};  ///< unit quaternion (w, x, y, z)
};

/// How an obstacle is, moves and rubs.
struct ObstacleOptions {
  Pose pose = {};                                        ///< where it is
  Vec3<double> velocity = Vec3<double>::Zero();          ///< of the origin of its frame, m/s
  Vec3<double> angular_velocity = Vec3<double>::Zero();  ///< in the world, rad/s
  /// Coefficient of Coulomb friction >= 0 against every body; negative: that of the body's ContactOptions.
  double friction = -1;
  /// kg; > 0: it moves freely, as a rigid body with its centre of mass at the origin of its frame. 0: it is led.
  double mass = 0;
  /// Principal moments along the axes of its frame, kg m^2. Zero: of a uniform solid, for shapes that tell their own.
  Vec3<double> inertia = Vec3<double>::Zero();
};

/// What bodies have done to an obstacle in a step, in the world.
struct ObstacleLoad {
  Vec3<double> impulse = Vec3<double>::Zero();          ///< N s
  Vec3<double> angular_impulse = Vec3<double>::Zero();  ///< about the origin of its frame, N m s
};

/// An obstacle as it is now.
class Obstacle {
 public:
  /// For Obstacles::add.
  template <Collider Shape>
  COROTET_COLD Obstacle(Shape shape, const ObstacleOptions& options)
      : velocity(options.velocity),
        angular_velocity(options.angular_velocity),
        friction(options.friction),
        mass_(options.mass),
        inertia_(options.inertia) {
    COROTET_ASSERT(mass_ >= 0, "the mass of an obstacle must not be negative");
    if constexpr (requires { shape.inertia(); })
      if (mass_ > 0 && inertia_.isZero()) inertia_ = mass_ * shape.inertia();
    COROTET_ASSERT(!(mass_ > 0) || inertia_.minCoeff() > 0, "a free obstacle of this shape needs moments of inertia");
    set_pose(options.pose);
    shape_ = detail::AnyCollider(std::move(shape));
  }

  Vec3<double> velocity;                       ///< m/s
  Vec3<double> angular_velocity;               ///< rad/s
  Vec3<double> force = Vec3<double>::Zero();   ///< on a free obstacle, besides weight and contact, N
  Vec3<double> torque = Vec3<double>::Zero();  ///< likewise, about its centre of mass, N m
  double friction;                             ///< see ObstacleOptions
  bool enabled = true;                         ///< false: nothing touches it

  /// Where it is, in the world.
  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// Puts it elsewhere at once; its velocities stay.
  void set_pose(const Pose& pose) {
    pose_ = {pose.position, pose.rotation.normalized()};
    rotation_ = rotation_of(pose_.rotation);
  }

  /// Whether it moves freely: it has a mass and does not sleep.
  [[nodiscard]] bool is_free() const { return mass_ > 0 && !is_asleep_; }
  /// Whether it sleeps with bodies that it touches: then it is as one that is led and does not move. See Sleep.
  [[nodiscard]] bool is_asleep() const { return is_asleep_; }
  /// kg, 0 if it is led.
  [[nodiscard]] double mass() const { return mass_; }
  /// Moments of inertia in the world, kg m^2.
  [[nodiscard]] Mat3<double> inertia() const { return in_world(inertia_); }

  /// Of a point in the world, m.
  [[nodiscard]] SurfaceDistance distance(const Vec3<double>& point) const {
    const SurfaceDistance inside = shape_(rotation_.transpose() * (point - pose_.position));
    return {inside.distance, rotation_ * inside.normal};
  }
  /// Of its material at a point in the world, m/s.
  [[nodiscard]] Vec3<double> velocity_at(const Vec3<double>& point) const {
    return velocity + angular_velocity.cross(point - pose_.position);
  }
  /// A direction of its frame in the world, and back.
  [[nodiscard]] Vec3<double> to_world(const Vec3<double>& direction) const { return rotation_ * direction; }
  /// A direction in the world in its frame.
  [[nodiscard]] Vec3<double> to_frame(const Vec3<double>& direction) const { return rotation_.transpose() * direction; }

  /// What bodies have done to it in the last step.
  [[nodiscard]] const ObstacleLoad& load() const { return load_; }

  /// The change of velocity of a free obstacle at a point by a unit impulse there, 1/kg; `arm`: from its centre of
  /// mass, in the world, m.
  [[nodiscard]] Mat3<double> mobility(const Vec3<double>& arm) const {
    Mat3<double> cross = Mat3<double>::Zero();  // cross * v = arm x v
    for (int i = 0; i < 3; ++i) {
      cross((i + 1) % 3, (i + 2) % 3) = -arm[i];
      cross((i + 2) % 3, (i + 1) % 3) = arm[i];
    }
    return Mat3<double>::Identity() / mass_ - cross * inertia().inverse() * cross;
  }
  /// Adds a load of this step, which changes the velocities of a free obstacle.
  void take(const ObstacleLoad& load) {
    add_load(load);
    if (!is_free()) return;
    velocity += load.impulse / mass_;
    angular_velocity += inertia().inverse() * load.angular_impulse;
  }

  /// For Contacts: another load of this step.
  void add_load(const ObstacleLoad& more) {
    load_.impulse += more.impulse;
    load_.angular_impulse += more.angular_impulse;
  }
  /// For Contacts, at the start of the step of each body: forgets the last step's load, and gives a free obstacle the
  /// velocity that weight, force and torque give it in h seconds; once until end_step.
  void begin_step(const Vec3<double>& gravity, double h) {
    if (begun_) return;
    begun_ = true;
    load_ = {};
    if (!is_free()) return;
    velocity += h * (gravity + force / mass_);
    angular_velocity += h * (inertia().inverse() * torque);
  }
  /// For Contacts, at the end of the step of each body.
  void end_step() { begun_ = false; }
  /// For Sleep: an obstacle with a mass stops and sleeps, or moves freely again.
  void set_asleep(bool sleeps) {
    is_asleep_ = sleeps && mass_ > 0;
    if (is_asleep_) velocity = angular_velocity = Vec3<double>::Zero();
  }

  /// To where its velocities take it in h seconds. A free one keeps its angular momentum.
  void move(double h) {
    Pose to = pose_;
    to.position += h * velocity;
    if (!angular_velocity.isZero()) {
      const Vec3<double> momentum = inertia() * angular_velocity;
      to.rotation = quaternion_of(rotation_by(h * angular_velocity) * rotation_);
      set_pose(to);
      if (is_free()) angular_velocity = in_world(inverse_of(inertia_)) * momentum;
    }
    set_pose(to);
  }

 private:
  [[nodiscard]] Mat3<double> in_world(const Vec3<double>& principal) const {
    Mat3<double> scaled = rotation_;
    for (int i = 0; i < 3; ++i) scaled.set_col(i, principal[i] * rotation_.col(i));
    return scaled * rotation_.transpose();
  }
  [[nodiscard]] static Vec3<double> inverse_of(const Vec3<double>& v) { return {1 / v.x(), 1 / v.y(), 1 / v.z()}; }

  detail::AnyCollider shape_ = detail::AnyCollider(Sphere{0});
  Pose pose_;
  Mat3<double> rotation_ = Mat3<double>::Identity();
  double mass_;
  Vec3<double> inertia_;
  ObstacleLoad load_;
  bool begun_ = false, is_asleep_ = false;
};

/// All obstacles of a scene: bodies touch them through Contacts, and any number of bodies may share them.
///
/// An obstacle is led (moves as its velocities say) or free (a rigid body, whose velocities the steps of bodies
/// change). Once a frame, after all bodies were stepped, `advance` moves them. An engine that moves its rigid bodies
/// itself gives poses and velocities before the step, takes velocities or `load` after it, and calls `end_step`
/// instead.
/// @snippet contact.cpp contact
class Obstacles {
 public:
  Vec3<double> gravity = Vec3<double>::Zero();  ///< of free obstacles, m/s^2

  /// Returns the number of the obstacle, by which it is known from now on.
  template <Collider Shape>
  COROTET_COLD Index add(Shape shape, const ObstacleOptions& options = {}) {
    all_.emplace_back(std::move(shape), options);
    return size_of(all_) - 1;
  }

  /// Number of obstacles.
  [[nodiscard]] Index size() const { return size_of(all_); }
  /// The obstacle of a number that `add` returned.
  [[nodiscard]] Obstacle& operator[](Index i) { return all_[at(i)]; }
  /// The same, read-only.
  [[nodiscard]] const Obstacle& operator[](Index i) const { return all_[at(i)]; }

  /// Gives a led obstacle the velocities with which it is at `target` after h seconds, by the shorter turn.
  void lead(Index i, const Pose& target, double h) {
    Obstacle& obstacle = (*this)[i];
    obstacle.velocity = (target.position - obstacle.pose().position) / h;
    const Mat3<double> turn =
        rotation_of(target.rotation.normalized()) * rotation_of(obstacle.pose().rotation).transpose();
    obstacle.angular_velocity = rotation_vector(turn) / h;
  }

  /// Ends a step of h seconds: moves all obstacles by it. Their loads remain until the next step begins.
  void advance(double h) {
    begin_step(h);
    end_step();
    for (Obstacle& obstacle : all_) obstacle.move(h);
  }

  /// Ends a step whose obstacles someone else moves.
  void end_step() {
    for (Obstacle& obstacle : all_) obstacle.end_step();
    ++frame_;
  }
  /// How many steps have ended.
  [[nodiscard]] std::uint64_t frame() const { return frame_; }

  /// For Contacts: see Obstacle::begin_step.
  void begin_step(double h) {
    for (Obstacle& obstacle : all_) obstacle.begin_step(gravity, h);
  }

 private:
  std::vector<Obstacle> all_;
  std::uint64_t frame_ = 0;
};

}  // namespace corotet::inline v0_1
