// The law of one contact: an implicit spring that carries a multiplier, with Coulomb friction.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/detail/core/types.hpp>
#include <cstdint>

namespace corotet::inline v0_1 {

/// What a contact does.
enum class ContactPhase : std::uint8_t {
  open,      ///< no force
  sticking,  ///< the friction is less than its limit
  sliding    ///< the friction is at its limit
};

namespace detail {

/// What a contact carries from one step to the next.
struct ContactMemory {
  Index obstacle = 0, point = 0;
  ContactPhase phase = ContactPhase::open;
  double force = 0;                              ///< normal, N
  double multiplier = 0;                         ///< N
  Vec3<double> friction = Vec3<double>::Zero();  ///< N, in the world
  /// The plane of the contact in the frame of the obstacle: a point that came in by one side leaves by it.
  Vec3<double> normal = Vec3<double>::Zero(), place = Vec3<double>::Zero();

  [[nodiscard]] static bool precedes(const ContactMemory& a, const ContactMemory& b) {
    return a.obstacle != b.obstacle ? a.obstacle < b.obstacle : a.point < b.point;
  }
};

/// A point near an obstacle in a step. Impulses are those of gamma times the force, N s; springs are masses, kg:
///
///     p_n = max(0, gamma lambda - kappa s),  s = (gap + n . (y' - reference - led)) / gamma
///     q   = gamma tau - kappa_t / gamma (1 - n n^T) (y' - start - led),  p_t = q min(1, mu p_n / |q|)
///
/// with y' where the point is after the step and `led` how far the obstacle moves there. lambda and tau, the normal
/// force and the friction of the last step, make the spring's error vanish at rest (augmented Lagrangian: Alart &
/// Curnier 1991; Simo & Laursen 1992). All is linear in the change w of the point's velocity in each phase.
struct PointContact {
  Index obstacle = 0, point = 0;
  Index free_body = -1;  ///< the obstacle's place among the free ones that are touched, if it is one
  ContactPhase phase = ContactPhase::open;
  Vec3<double> normal;     ///< out of the obstacle
  Vec3<double> start;      ///< the point at the start of the step, m
  Vec3<double> reference;  ///< where the gap was measured: at the start, or where its path meets the obstacle, m
  Vec3<double> led;        ///< m
  Vec3<double> arm;        ///< from the obstacle's centre to the start, m
  double gap = 0;          ///< at the reference, m, not deeper than is undone in this step
  double measured_gap = 0;
  bool is_inside = false;        ///< after the step
  double multiplier_before = 0;  ///< lambda at the start of the step, N
  double friction = 0;           ///< coefficient

  double multiplier = 0, last_force = 0;       ///< lambda, and the normal force of the last step, N
  Vec3<double> anchor = Vec3<double>::Zero();  ///< tau, N

  // Where forces are linearised.
  double kappa = 0, kappa_t = 0;                    ///< kg
  double normal0 = 0;                               ///< gamma lambda - kappa s, N s
  Vec3<double> tangential0 = Vec3<double>::Zero();  ///< q, N s

  // At the solution that was judged last.
  double normal_trial = 0;                                          ///< not cut off, N s
  Vec3<double> tangential_trial = Vec3<double>::Zero();             ///< q, N s
  Vec3<double> value = Vec3<double>::Zero(), value_before = value;  ///< of the change of velocities at the point, m/s
  Vec3<double> change = Vec3<double>::Zero();                       ///< w, m/s
  Vec3<double> impulse = Vec3<double>::Zero();                      ///< p, N s

  // The piece in the system: p = piece_impulse - piece_stiffness w.
  double limit = 0;                               ///< mu p_n of sliding, N s
  Vec3<double> direction = Vec3<double>::Zero();  ///< q / |q| of sliding
  Mat3<double> piece_stiffness = Mat3<double>::Zero();
  Vec3<double> piece_impulse = Vec3<double>::Zero();
  Mat3<double> stiffness_in = Mat3<double>::Zero();  ///< what the matrix has of it
  Vec3<double> impulse_in = Vec3<double>::Zero();    ///< and the right side
  Vec3<double> given = Vec3<double>::Zero();         ///< p that the body's momentum has been given, N s
  Vec3<double> told = Vec3<double>::Zero();          ///< force that `add_force` told, N

  [[nodiscard]] static bool precedes(const PointContact& a, const PointContact& b) {
    return a.obstacle != b.obstacle ? a.obstacle < b.obstacle : a.point < b.point;
  }

  /// The gap at the reference, m: of what is deeper than `undone`, the step undoes so much.
  void set_gap(double measured, double undone) {
    measured_gap = measured;
    gap = (std::max)(measured, -undone);
  }
  /// Goes on with what the last step left. Friction is turned with the surface, not shortened.
  void take(const ContactMemory& before) {
    multiplier = multiplier_before = before.multiplier;
    last_force = before.force;
    anchor = tangential_part(before.friction);
    const double size = anchor.norm();
    if (size > 0) anchor *= before.friction.norm() / size;
  }

  /// The spring at the velocity where forces are linearised: there the point ends at `end`, m.
  void linearize(const Vec3<double>& end, double gamma, double spring, double tangential_spring) {
    kappa = spring;
    kappa_t = tangential_spring;
    normal0 = gamma * multiplier - kappa * ((gap + normal.dot(end - reference - led)) / gamma);
    const Vec3<double> moved = end - start - led;
    tangential0 = gamma * anchor - kappa_t / gamma * tangential_part(moved);
  }
  /// Leaves the contact without springs and without the forces of the last step: it stays open.
  void release() {
    phase = ContactPhase::open;
    kappa = kappa_t = multiplier = multiplier_before = last_force = 0;
    anchor.setZero();
  }
  /// At the first linearisation of a step, before anything is solved: the trial impulses are those of the last step.
  void start_from_memory(double gamma) {
    normal_trial = gamma * last_force;
    tangential_trial = tangential0;
    change.setZero();
  }

  /// Sets the piece of the present phase, linearised at the solution that was judged last. `keeps_limit`: friction has
  /// the limit that it had, so that the convex function stays the same.
  void choose_piece(bool keeps_limit) {
    piece_stiffness.setZero();
    piece_impulse.setZero();
    if (!keeps_limit) limit = friction * (std::max)(0.0, normal_trial);
    direction.setZero();
    if (phase == ContactPhase::open) return;
    const Mat3<double> along_normal = normal * normal.transpose();
    piece_stiffness = kappa * along_normal;
    piece_impulse = normal0 * normal;
    if (!(friction > 0)) return;
    const Mat3<double> across = Mat3<double>::Identity() - along_normal;
    const double size = tangential_trial.norm();
    if (phase == ContactPhase::sticking) {
      piece_stiffness += kappa_t * across;
      piece_impulse += tangential0;
    } else if (size > 0) {
      direction = tangential_trial / size;
      const Mat3<double> turning =
          kappa_t * (std::min)(1.0, limit / size) * (across - direction * direction.transpose());
      piece_stiffness += turning;
      piece_impulse += limit * direction + turning * change;
    }
  }

  /// The impulse at the change w of the point's velocity against the obstacle.
  void evaluate(const Vec3<double>& w) {
    change = w;
    normal_trial = normal0 - kappa * normal.dot(w);
    tangential_trial = tangential0 - kappa_t * tangential_part(w);
    impulse = law(normal_trial, tangential_trial, friction * (std::max)(0.0, normal_trial));
  }

  /// Takes the phase that holds at the solution evaluated last, where impulses below `noise` (N s, of normal and
  /// tangential ones) say nothing. True if that is another one, or slides in another direction.
  [[nodiscard]] bool judge(double noise, double tangential_noise, bool keeps_limit) {
    constexpr double same_force = 0.05, at_limit = 1e-3;
    ContactPhase next = ContactPhase::open;
    bool changed = false;
    if (phase == ContactPhase::open ? normal_trial > noise : normal_trial > -noise) {
      const double most = keeps_limit ? limit : friction * (std::max)(0.0, normal_trial),
                   size = tangential_trial.norm();
      const double hold = phase == ContactPhase::sliding ? 0 : tangential_noise;
      next = friction > 0 && size > most * (1 + at_limit) + hold ? ContactPhase::sliding : ContactPhase::sticking;
      if (next == ContactPhase::sliding && phase == next)
        changed = std::fabs(most - limit) > same_force * most + noise * friction ||
                  tangential_trial.dot(direction) < (1 - same_force) * size;
    }
    changed = changed || next != phase;
    phase = next;
    return changed;
  }

  /// Minus the derivative of the convex function along `along` at the change w: its impulse times `along`.
  [[nodiscard]] double work(const Vec3<double>& w, const Vec3<double>& along) const {
    return law(normal0 - kappa * normal.dot(w), tangential0 - kappa_t * tangential_part(w), limit).dot(along);
  }

  /// How much deeper the point ends than it was at the start, by what the multiplier lacks, m.
  [[nodiscard]] double depth(double gamma) const {
    return normal_trial > 0 ? (normal_trial - gamma * multiplier) / kappa * gamma - (std::max)(0.0, -gap) : 0;
  }
  /// Lets the multiplier take over all of the present force.
  void augment(double gamma) {
    const double more = (std::max)(0.0, normal_trial) - gamma * multiplier;
    multiplier += more / gamma;
    normal0 += more;
  }

  /// The part of a vector in the plane of the contact.
  [[nodiscard]] Vec3<double> tangential_part(const Vec3<double>& v) const { return v - normal.dot(v) * normal; }

 private:
  [[nodiscard]] Vec3<double> law(double p_n, const Vec3<double>& q, double most) const {
    Vec3<double> p = (std::max)(0.0, p_n) * normal;
    if (!(most > 0)) return p;
    const double size = q.norm();
    p += size > most ? most / size * q : q;
    return p;
  }
};

}  // namespace detail
}  // namespace corotet::inline v0_1
