// Contacts between soft bodies that are solved as one system: what a pass needs of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <corotet/detail/contact/contact_compliance.hpp>
#include <corotet/detail/contact/contact_iteration.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/contact/soft_side.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/joint_pcg.hpp>
#include <cstddef>
#include <span>
#include <vector>

namespace corotet::inline v0_1::detail {

/// The contacts of an island of bodies. Their matrix J^T k J, with J the motion of points against triangles, lies
/// outside the patterns of the bodies' matrices: `couple` multiplies with it.
template <std::floating_point Scalar>
class JointContacts {
 public:
  using Side = SoftSide<Scalar>;

  /// Memory for so many contacts.
  void reserve(std::size_t capacity) {
    contacts_.reserve(capacity);
    from_.resize(capacity);
    along_.resize(capacity);
  }

  /// Begins with no contact, among these bodies, which must outlive the step.
  void begin(std::span<Side> sides, double gamma) {
    sides_ = sides;
    gamma_ = gamma;
    contacts_.clear();
  }
  void clear() { contacts_.clear(); }
  [[nodiscard]] std::vector<SoftContact>& list() { return contacts_; }
  [[nodiscard]] const std::vector<SoftContact>& list() const { return contacts_; }
  [[nodiscard]] double gamma() const { return gamma_; }

  // See PiecewiseTerm, of which these are the parts.
  void linearize();
  [[nodiscard]] bool revise(double error);
  void update();
  void take_values();
  void begin_search(double& slope);
  [[nodiscard]] double slope_at(double fraction) const;
  void end_search(double fraction);

  /// Adds the product of all contacts' pieces with the fields `x` of the bodies to their fields `y`.
  void couple(typename JointPcg<Scalar>::Member x, typename JointPcg<Scalar>::Member y);

  /// The impulses of the solution are those that the bodies get.
  void settle() {
    for (Side& side : sides_)
      if (side.system != nullptr) side.find_flight();
    for (SoftContact& contact : contacts_) {
      contact.given = contact.impulse;
      if (!contact.given.isZero()) balance_moment(contact);
    }
  }

 private:
  void choose_springs();
  void balance_moment(SoftContact& contact) const;

  /// The relative motion at a contact: `field(side)` returns a field of the side, in its frame.
  template <class FieldOf>
  [[nodiscard]] Vec3<double> value(const SoftContact& contact, const FieldOf& field) const {
    const Side &a = sides_[at(contact.side)], &b = sides_[at(contact.other)];
    Vec3<double> sum = a.value(contact, field(a));
    if (contact.other != contact.side) sum += b.value(contact, field(b));
    return sum;
  }
  /// Calls visit(side) for the one or two bodies of a contact.
  template <class Visit>
  void for_sides(const SoftContact& contact, const Visit& visit) {
    visit(sides_[at(contact.side)]);
    if (contact.other != contact.side) visit(sides_[at(contact.other)]);
  }

  std::span<Side> sides_;
  std::vector<SoftContact> contacts_;
  std::vector<Vec3<double>> from_, along_;  // of the line search, one a contact, m/s
  Augmentations augmentations_;
  double gamma_ = 0;
  int revisions_ = 0;
};

template <std::floating_point Scalar>
void JointContacts<Scalar>::linearize() {
  choose_springs();
  for (SoftContact& contact : contacts_) {
    Vec3<double> end = Vec3<double>::Zero();
    for_sides(contact, [&](const Side& side) {
      Vec3<double> origin = Vec3<double>::Zero();  // cancels where a body touches itself
      side.for_carriers(contact, [&](Index v, double weight) {
        end += weight * side.state.position(v).template cast<double>();
        origin += weight * side.state.origin;
      });
      end += origin;
      if (side.system->guess != nullptr) end += gamma_ * side.value(contact, *side.system->guess);
    });
    contact.linearize(end, gamma_, contact.kappa, contact.kappa_t);
    contact.start_from_memory(gamma_);
    contact.impulse_in.setZero();
  }
  revisions_ = 0;
  augmentations_.begin();
  update();
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::choose_springs() {
  for (const SoftContact& contact : contacts_)
    for_sides(contact, [&](Side& side) {
      side.for_carriers(contact, [&](Index v, double weight) { side.share[at(v)] += std::fabs(weight); });
    });
  const double cap = spring_mass_ratio / double(contacts_.size());
  for (SoftContact& contact : contacts_) {
    ContactCompliance compliance;
    double mass = 0;  // the two in series
    for_sides(contact, [&](const Side& side) {
      const Vec3<double> normal = side.in_frame(contact.normal);
      side.for_carriers(contact, [&](Index v, double weight) {
        compliance.add(side.system->matrix, *side.state.mass, static_cast<Index>(side.state.index(v)),
                       weight * weight * (std::max)(1.0, side.share[at(v)]), normal);
      });
      mass += 1 / side.state.mass->total();
    });
    if (compliance.is_held) {
      contact.release();  // pins hold both
      continue;
    }
    contact.kappa = (std::min)(1 / compliance.along, cap / mass);
    contact.kappa_t = (std::min)(1 / compliance.across, cap / mass);
  }
  for (Side& side : sides_)
    if (side.system != nullptr) std::fill(side.share.begin(), side.share.end(), 0.0);
}

template <std::floating_point Scalar>
bool JointContacts<Scalar>::revise(double error) {
  ++revisions_;
  double extent = 0;
  for (const Side& side : sides_)
    if (side.system != nullptr) extent = (std::max)(extent, side.surface.points().extent());
  for (SoftContact& contact : contacts_) contact.evaluate(contact.value);
  return judge(contacts_, error, revisions_ > last_free_revision) ||
         augmentations_.augment(contacts_, gamma_, deep_share * extent);
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::update() {
  for (SoftContact& contact : contacts_) {
    contact.choose_piece(revisions_ > last_free_revision);
    const Vec3<double> more = contact.piece_impulse - contact.impulse_in;
    contact.impulse_in = contact.piece_impulse;
    for_sides(contact, [&](Side& side) {
      const Vec3<double> impulse = side.in_frame(more);
      side.for_carriers(contact, [&](Index v, double weight) {
        side.system->right_side[side.state.index(v)] += (weight * impulse).template cast<Scalar>();
      });
    });
  }
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::take_values() {
  for (SoftContact& contact : contacts_) {
    contact.value_before = contact.value;
    contact.value = value(contact, [](const Side& side) -> const Field<Scalar>& { return side.system->change; });
  }
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::begin_search(double& slope) {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    from_[i] = contacts_[i].value_before;
    along_[i] = contacts_[i].value - from_[i];
    slope += along_[i].dot(contacts_[i].impulse_in);
  }
}

template <std::floating_point Scalar>
double JointContacts<Scalar>::slope_at(double fraction) const {
  double sum = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    sum -= contacts_[i].work(from_[i] + fraction * along_[i], along_[i]);
  return sum;
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::end_search(double fraction) {
  for (SoftContact& contact : contacts_)
    contact.value = contact.value_before + fraction * (contact.value - contact.value_before);
}

/// Both bodies get the impulse, each where its point ends and about its centre of mass there: what one point has come
/// away from the other, and the centres from each other, leaves a moment over. A couple on the triangle takes it, and
/// so all angular momentum is kept.
template <std::floating_point Scalar>
void JointContacts<Scalar>::balance_moment(SoftContact& contact) const {
  const Side &a = sides_[at(contact.side)], &b = sides_[at(contact.other)];
  std::array<Vec3<double>, 3> arm;
  Vec3<double> place = Vec3<double>::Zero(), middle = place;
  for (std::size_t k = 0; k < 3; ++k) {
    arm[k] = b.end_of(b.surface.triangles()[at(contact.triangle)][k]);
    place += contact.weights[k] * arm[k];
    middle += arm[k] / 3;
  }
  Mat3<double> inertia = Mat3<double>::Zero();
  for (Vec3<double>& r : arm) {
    r -= middle;
    inertia += r.squaredNorm() * Mat3<double>::Identity() - r * r.transpose();
  }
  const Vec3<double> apart = a.end_of(contact.point) - a.flown - (place - b.flown);
  const Vec3<double> turn = inertia.inverse() * contact.given.cross(apart);
  for (std::size_t k = 0; k < 3; ++k)
    contact.couple[k] = turn.allFinite() ? Vec3<double>(turn.cross(arm[k])) : Vec3<double>::Zero();
}

template <std::floating_point Scalar>
void JointContacts<Scalar>::couple(typename JointPcg<Scalar>::Member x, typename JointPcg<Scalar>::Member y) {
  for (const SoftContact& contact : contacts_) {
    if (contact.phase == ContactPhase::open) continue;
    const Vec3<double> force =
        contact.piece_stiffness *
        value(contact, [x](const Side& side) -> const PaddedField<Scalar>& { return side.fields.*x; });
    for_sides(contact, [&](Side& side) {
      const Vec3<double> part = side.in_frame(force);
      side.for_carriers(contact, [&](Index v, double weight) {
        PaddedVector<Scalar>& to = (side.fields.*y)[side.state.index(v)];
        to.set(Vec3<Scalar>(to.vector() + (weight * part).template cast<Scalar>()));
      });
    });
  }
}

}  // namespace corotet::inline v0_1::detail
