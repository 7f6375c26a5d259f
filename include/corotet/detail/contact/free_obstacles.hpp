// Free obstacles that a body touches: their velocities are solved for with the body's.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/small_cholesky.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1::detail {

/// Linear and angular velocity, m/s and rad/s, or impulse, N s and N m s.
using Twist = Matrix<double, 6, 1>;

/// The change V of the free obstacles' velocities in a step: M_q V = -eta sum J_q^T p over their contacts, with J_q the
/// velocity of the obstacle at a contact, p the impulse on the body and eta the length of the step over gamma. With
/// p = p_0 - k (J d - eta J_q V), V is eliminated exactly: V = -eta N^-1 sum J_q^T (p_0 - k J d) with
/// N = M_q + eta^2 sum J_q^T k J_q. What remains in the body's equation is a matrix of rank 6 for each obstacle.
class FreeObstacles {
 public:
  [[nodiscard]] bool empty() const { return all_.empty(); }

  /// Numbers the free ones that contacts are with.
  void begin(const Obstacles& obstacles, std::vector<PointContact>& contacts) {
    all_.clear();
    all_.reserve(at(obstacles.size()));
    for (PointContact& contact : contacts) add(obstacles, contact);
  }
  /// eta.
  void set_ratio(double length_over_gamma) { eta_ = length_over_gamma; }

  /// Numbers one more. Those that were there keep their numbers.
  void add(const Obstacles& obstacles, PointContact& contact) {
    const Obstacle& obstacle = obstacles[contact.obstacle];
    if (!obstacle.is_free()) return;
    Index place = 0;
    while (place < size_of(all_) && all_[at(place)].obstacle != contact.obstacle) ++place;
    contact.free_body = place;
    if (place < size_of(all_)) return;
    Body& body = all_.emplace_back();
    body.obstacle = contact.obstacle;
    body.mass = Matrix<double, 6, 6>::Zero();
    body.mass.set_block(0, 0, obstacle.mass() * Mat3<double>::Identity());
    body.mass.set_block(3, 3, obstacle.inertia());
  }

  /// Takes the pieces of the contacts. Adds what V has of them to the impulse that each has in the body's equation.
  void eliminate(std::vector<PointContact>& contacts) {
    for (Body& body : all_) {
      body.inverse = body.mass;
      body.eliminated = Twist::Zero();
      body.from = body.change;
    }
    for (const PointContact& contact : contacts) {
      if (contact.free_body < 0 || contact.phase == ContactPhase::open) continue;
      Body& body = all_[at(contact.free_body)];
      const Matrix<double, 3, 6> j = jacobian(contact);
      body.inverse += eta_ * eta_ * (j.transpose() * (contact.piece_stiffness * j));
      body.eliminated += j.transpose() * contact.piece_impulse;
    }
    for (Body& body : all_) {
      Matrix<double, 6, 6> root;
      if (!inverse_cholesky(body.inverse, root)) root.setZero();  // numbers that left their range: it stays as it is
      body.inverse = root.transpose() * root;
      body.eliminated = -eta_ * (body.inverse * body.eliminated);
    }
    for (PointContact& contact : contacts)
      if (contact.free_body >= 0 && contact.phase != ContactPhase::open)
        contact.piece_impulse +=
            eta_ * (contact.piece_stiffness * (jacobian(contact) * all_[at(contact.free_body)].eliminated));
  }

  /// Sets V to that of a solution.
  void solve(const std::vector<PointContact>& contacts) {
    for (Body& body : all_) body.sum = Twist::Zero();
    for (const PointContact& contact : contacts)
      if (contact.free_body >= 0 && contact.phase != ContactPhase::open)
        all_[at(contact.free_body)].sum += jacobian(contact).transpose() * (contact.piece_stiffness * contact.value);
    for (Body& body : all_) body.change = body.eliminated + eta_ * (body.inverse * body.sum);
  }

  /// Adds -eta^2 J^T k J_q N^-1 J_q^T k J x to a product: `value_of(contact)` is J x, `add_to(contact, f)` adds J^T f.
  template <class ValueOf, class AddTo>
  void couple(const std::vector<PointContact>& contacts, const ValueOf& value_of, const AddTo& add_to) const {
    constexpr std::size_t at_once = 16;  // sums on the stack: so many obstacles, then the next ones
    for (std::size_t first = 0; first < all_.size(); first += at_once) {
      const std::size_t last = (std::min)(first + at_once, all_.size());
      std::array<Twist, at_once> sum{};
      const auto is_in = [&](const PointContact& contact) {
        return contact.phase != ContactPhase::open && contact.free_body >= static_cast<Index>(first) &&
               contact.free_body < static_cast<Index>(last);
      };
      for (const PointContact& contact : contacts)
        if (is_in(contact))
          sum[at(contact.free_body) - first] +=
              jacobian(contact).transpose() * (contact.piece_stiffness * value_of(contact));
      for (std::size_t i = first; i < last; ++i) sum[i - first] = eta_ * eta_ * (all_[i].inverse * sum[i - first]);
      for (const PointContact& contact : contacts)
        if (is_in(contact))
          add_to(contact, -(contact.piece_stiffness * (jacobian(contact) * sum[at(contact.free_body) - first])));
    }
  }

  /// The obstacle's share in the change of velocity at a contact, of the step's gamma: eta J_q V, m/s.
  [[nodiscard]] Vec3<double> motion(const PointContact& contact) const { return motion(contact, &Body::change); }
  /// The same where the line search starts.
  [[nodiscard]] Vec3<double> motion_from(const PointContact& contact) const { return motion(contact, &Body::from); }

  /// Adds the kinetic energy of V along the way of a line search to its slope and curvature.
  void add_inertia(double& slope, double& curvature) const {
    for (const Body& body : all_) {
      const Twist along = body.change - body.from, momentum = body.mass * along;
      slope += momentum.dot(body.from);
      curvature += momentum.dot(along);
    }
  }
  void end_search(double fraction) {
    for (Body& body : all_) body.change = body.from + fraction * (body.change - body.from);
  }

  /// The share of the force that the multiplier of a contact may take over, at most `share`. Of a mass on springs that
  /// are lighter than it, multipliers that follow faster grow.
  [[nodiscard]] double stable_share(const PointContact& contact, double share) const {
    if (contact.free_body < 0) return share;
    const Body& body = all_[at(contact.free_body)];
    return (std::min)(share, 0.5 * body.springs / body.mass(0, 0));
  }

  /// Gives the obstacles the velocities that the impulses on the body leave them: all momentum is kept.
  /// `arm_of(contact)` is where its impulse acts, from the obstacle's centre of mass, m.
  template <class ArmOf>
  void finish(const std::vector<PointContact>& contacts, Obstacles& obstacles, const ArmOf& arm_of) {
    for (Body& body : all_) {
      body.sum = Twist::Zero();
      body.springs = 0;
    }
    for (const PointContact& contact : contacts) {
      if (contact.free_body < 0) continue;
      Body& body = all_[at(contact.free_body)];
      body.sum -= jacobian(arm_of(contact)).transpose() * contact.given;
      if (!contact.given.isZero()) body.springs += contact.kappa;
    }
    for (const Body& body : all_) {
      obstacles[body.obstacle].take({eta_ * body.sum.head<3>(), eta_ * body.sum.tail<3>()});
    }
  }

 private:
  struct Body {
    Index obstacle = 0;
    Matrix<double, 6, 6> mass, inverse = Matrix<double, 6, 6>::Zero();  // M_q and N^-1
    Twist eliminated = Twist::Zero();                                   // V for d = 0
    double springs = 0;                                                 // of all contacts with a force, kg
    Twist change = Twist::Zero(), from = Twist::Zero(), sum = Twist::Zero();
  };

  /// Velocity at a contact from a twist.
  [[nodiscard]] static Matrix<double, 3, 6> jacobian(const PointContact& contact) { return jacobian(contact.arm); }
  [[nodiscard]] static Matrix<double, 3, 6> jacobian(const Vec3<double>& r) {
    Matrix<double, 3, 6> j = Matrix<double, 3, 6>::Zero();
    for (int i = 0; i < 3; ++i) j(i, i) = 1;
    for (int i = 0; i < 3; ++i) {  // w x r
      j((i + 1) % 3, 3 + (i + 2) % 3) = r[i];
      j((i + 2) % 3, 3 + (i + 1) % 3) = -r[i];
    }
    return j;
  }

  [[nodiscard]] Vec3<double> motion(const PointContact& contact, Twist Body::*of) const {
    if (contact.free_body < 0) return Vec3<double>::Zero();
    return eta_ * (jacobian(contact) * (all_[at(contact.free_body)].*of));
  }

  std::vector<Body> all_;
  double eta_ = 1;
};

}  // namespace corotet::inline v0_1::detail
