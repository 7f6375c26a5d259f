// A point of a body tied to a point in space, to an obstacle or to another body: a term of the body's steps.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/term_rest.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

/// How an attachment pulls.
struct AttachmentOptions {
  double stiffness = 1e4;  ///< N/m, > 0
  double damping = 0;      ///< N s/m, >= 0
};

/// Ties a point of a body to a target by a spring of length zero with a damper.
///
/// Use it to grab a body with the mouse, to hang it on a bone or a rigid body, to tie two bodies together: one as a
/// term of each step. The spring is implicit: it is stable at any stiffness and any length of step. To hold vertices
/// exactly use pins.
/// @snippet contact.cpp attachment
/// The target is a point in the world, which may move, or a point of an obstacle. The reaction on a free obstacle moves
/// it: the spring gives way as that will (docs/theory.md, equation 22). Several ties to one free obstacle share its
/// mass. Another body is pulled by a `counterpart`, with the opposite force.
template <std::floating_point Scalar>
class Attachment final : public StepTerm<Scalar> {
 public:
  /// Of a point of an element.
  template <ReferenceElement Element>
  COROTET_COLD explicit Attachment(const BodyPoint<Element>& point, const AttachmentOptions& options = {})
      : options_(options), count_(point.vertices.size()) {
    static_assert(Element::nodes <= max_carriers, "an element of more nodes than an attachment has room for");
    COROTET_ASSERT(options.stiffness > 0 && options.damping >= 0,
                   "the stiffness of an attachment must be positive, its damping not negative");
    for (std::size_t a = 0; a < count_; ++a) {
      vertices_[a] = point.vertices[a];
      weights_[a] = point.weights[a];
    }
  }

  /// How it pulls.
  [[nodiscard]] const AttachmentOptions& options() const { return options_; }
  /// Changes how it pulls: from the next step on.
  void set_options(const AttachmentOptions& options) { options_ = options; }
  bool enabled = true;  ///< false: it does not pull

  /// The target is this point in the world, m, at the end of the next step, where it moves at this velocity, m/s.
  void set_target(const Vec3<double>& point, const Vec3<double>& velocity = Vec3<double>::Zero()) {
    obstacles_ = nullptr;
    target_ = point;
    target_velocity_ = velocity;
  }
  /// The target moves with an obstacle: `point` in its frame, m. `ties`: how many attachments share a free one.
  void set_target(Obstacles& obstacles, Index obstacle, const Vec3<double>& point, int ties = 1) {
    COROTET_ASSERT(ties >= 1, "an attachment is one of at least one");
    obstacles_ = &obstacles;
    obstacle_ = obstacle;
    local_ = point;
    ties_ = ties;
  }

  /// On the body in the last step, N, in the world; on what it is tied to, the opposite.
  [[nodiscard]] const Vec3<double>& force() const { return force_; }
  /// Where the target was at the end of the last step, m.
  [[nodiscard]] const Vec3<double>& target() const { return target_; }

  [[nodiscard]] bool describe_rest(TermRest& out) const override {
    out.has_changed = aim() != last_;
    if (!enabled || obstacles_ == nullptr) return true;
    out.obstacles = obstacles_;
    out.touches = {&touch_, 1};
    return true;
  }

  void begin_step(const TermState<Scalar>& start) override {
    yield_.setZero();
    if (obstacles_ == nullptr || !is_here(start)) return;
    const double h = double(start.h);
    obstacles_->begin_step(h);
    const Obstacle& obstacle = (*obstacles_)[obstacle_];
    const Vec3<double> arm = obstacle.to_world(local_), turn = h * obstacle.angular_velocity;
    target_ = obstacle.pose().position + h * obstacle.velocity + rotation_by(turn) * arm;
    target_velocity_ = obstacle.velocity + obstacle.angular_velocity.cross(rotation_by(turn) * arm);
    if (obstacle.is_free()) yield_ = double(ties_) * obstacle.mobility(arm);
  }

  [[nodiscard]] bool needs_first_order() const override { return !yield_.isZero(); }

  void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
    if (!is_here(state)) return;
    const Vec3<double> force = force_at(state);
    for_carriers([&](Index v, double w) { out.add(v, (w * force).template cast<Scalar>()); });
  }

  void add_stiffness(const TermState<Scalar>& state, TermStiffness<Scalar>& out) override {
    if (!is_here(state)) return;
    const Mat3<double> give = compliance(double(state.h));
    const Mat3<Scalar> spring = (options_.stiffness * give).template cast<Scalar>();
    const Mat3<Scalar> damper = (options_.damping * give).template cast<Scalar>();
    const bool damps = options_.damping > 0;
    for (std::size_t a = 0; a < count_; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const auto w = static_cast<Scalar>(weights_[a] * weights_[b]);
        if (detail::is_zero(w)) continue;
        out.add_stiffness(vertices_[a], vertices_[b], w * spring);
        if (damps) out.add_damping(vertices_[a], vertices_[b], w * damper);
      }
  }

  void end_step(const TermState<Scalar>& end) override {
    last_ = aim();
    if (!is_here(end)) return;
    force_ = force_at(end);
    if (obstacles_ == nullptr) return;
    const Vec3<double> impulse = double(end.h) * force_;
    Obstacle& obstacle = (*obstacles_)[obstacle_];
    const Vec3<double> arm = obstacle.to_world(local_);
    obstacle.take({-impulse, -arm.cross(impulse)});
    touch_.obstacle = obstacle_;
    touch_.place = obstacle.pose().position + arm;
    touch_.impulse = impulse;
  }

  /// The opposite pull on another body: a term of that body's step, which comes after this one's.
  class Counterpart final : public StepTerm<Scalar> {
   public:
    /// Of a point of an element; the attachment must outlive it.
    template <ReferenceElement Element>
    COROTET_COLD Counterpart(const Attachment& attachment, const BodyPoint<Element>& point)
        : attachment_(&attachment), point_(point) {}

    [[nodiscard]] bool describe_rest(TermRest& out) const override {
      out.has_changed = attachment_->force() != last_force_;
      return true;
    }

    void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override {
      last_force_ = attachment_->force();
      if (!point_.is_here(state)) return;
      point_.for_carriers([&](Index v, double w) { out.add(v, (-w * attachment_->force()).template cast<Scalar>()); });
    }

   private:
    const Attachment* attachment_;
    Attachment point_;
    Vec3<double> last_force_ = Vec3<double>::Zero();
  };

 private:
  static constexpr std::size_t max_carriers = 10;

  /// What the force depends on besides the body and the motion of an obstacle.
  struct Aim {
    bool enabled = false;
    double stiffness = 0, damping = 0;
    const Obstacles* obstacles = nullptr;
    Index obstacle = 0;
    Vec3<double> target = Vec3<double>::Zero(), velocity = target;

    friend bool operator==(const Aim& a, const Aim& b) {
      return a.enabled == b.enabled && detail::exactly_equal(a.stiffness, b.stiffness) &&
             detail::exactly_equal(a.damping, b.damping) && a.obstacles == b.obstacles && a.obstacle == b.obstacle &&
             a.target == b.target && a.velocity == b.velocity;
    }
  };
  [[nodiscard]] Aim aim() const {
    if (obstacles_ == nullptr)
      return {enabled, options_.stiffness, options_.damping, nullptr, 0, target_, target_velocity_};
    return {enabled, options_.stiffness, options_.damping, obstacles_, obstacle_, local_, Vec3<double>::Zero()};
  }

  [[nodiscard]] bool is_here(const TermState<Scalar>& state) const { return enabled && state.contains(vertices_[0]); }

  template <class Visit>
  void for_carriers(const Visit& visit) const {
    for (std::size_t a = 0; a < count_; ++a) visit(vertices_[a], weights_[a]);
  }

  /// (1 + (h^2 k + h d) Y)^-1: how much of its force is left where the target yields by Y, 1/kg.
  [[nodiscard]] Mat3<double> compliance(double h) const {
    return (Mat3<double>::Identity() + (h * h * options_.stiffness + h * options_.damping) * yield_).inverse();
  }

  /// With the target's own yielding to it.
  [[nodiscard]] Vec3<double> force_at(const TermState<Scalar>& state) const {
    Vec3<double> place = state.origin, velocity = Vec3<double>::Zero();
    for_carriers([&](Index v, double w) {
      place += w * state.position(v).template cast<double>();
      velocity += w * state.velocity(v).template cast<double>();
    });
    return compliance(double(state.h)) *
           (options_.stiffness * (target_ - place) + options_.damping * (target_velocity_ - velocity));
  }

  AttachmentOptions options_;
  std::array<Index, max_carriers> vertices_{};
  std::array<double, max_carriers> weights_{};
  std::size_t count_;
  Vec3<double> target_ = Vec3<double>::Zero(), target_velocity_ = target_;  // at the end of the step
  Vec3<double> force_ = target_;
  Obstacles* obstacles_ = nullptr;
  Index obstacle_ = 0;
  int ties_ = 1;
  Vec3<double> local_ = Vec3<double>::Zero();
  Aim last_;                                   // of the last step
  Touch touch_{};                              // of an obstacle
  Mat3<double> yield_ = Mat3<double>::Zero();  // velocity of the target by an impulse on it, 1/kg
};

}  // namespace corotet::inline v0_1
