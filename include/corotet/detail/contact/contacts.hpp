// Contact of a body with obstacles: a term of its steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/contact/contact_compliance.hpp>
#include <corotet/detail/contact/contact_iteration.hpp>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/contact/contact_set.hpp>
#include <corotet/detail/contact/free_obstacles.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/contact/term_rest.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/terms/piecewise_term.hpp>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// Contact of a body with obstacles, with Coulomb friction.
///
/// Use it as a term of the body's steps; one for each body, obstacles may be shared. Contact is implicit: points rest
/// without sinking in, stick without creeping, and are stopped at any speed. The free obstacles among them are solved
/// for with the body, at any ratio of masses.
/// @snippet contact.cpp contact
/// The method: implicit springs that carry multipliers, whose stiffness follows from the body's matrix and mass, and
/// semismooth Newton passes over their phases: docs/theory.md, equations 18 to 21. A step at rest or in
/// steady sliding takes one linear solve.
///
/// Points of the body are tested against obstacles: edges of an obstacle that are thinner than the distance of two
/// points slip between them. A step in which a free obstacle is near, and one after contact forces have jumped, is of
/// backward Euler. Steps allocate nothing, but the first one after an obstacle was added.
template <std::floating_point Scalar>
class Contacts final : public PiecewiseTerm<Scalar>, private MatrixFreeTerm<Scalar> {
 public:
  /// `obstacles` must outlive it.
  COROTET_COLD Contacts(ContactPoints points, Obstacles& obstacles, const ContactOptions& options = {});

  [[nodiscard]] const ContactOptions& options() const { return options_; }     ///< what it was made with
  [[nodiscard]] const ContactPoints& points() const { return set_.points(); }  ///< of the body, that may touch
  [[nodiscard]] const ContactReport& report() const { return report_; }        ///< of the last step
  /// Those with a force, by pieces of the body, then by obstacles, then by points.
  [[nodiscard]] std::span<const Touch> touches() const { return detail::span_of(touches_); }

  /// Forgets the forces of earlier steps: after the body was set elsewhere.
  void reset() {
    set_.forget();
    touches_.clear();
    report_ = {};
    for (History& history : histories_) history = {};
  }

  void begin_step(const TermState<Scalar>& start) override;
  [[nodiscard]] bool needs_first_order() const override { return histories_[piece_].has_jumped || set_.is_near_free(); }
  void add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) override;
  [[nodiscard]] bool linearize(PassSystem<Scalar>& system) override;
  [[nodiscard]] bool revise(const PassSystem<Scalar>& system, double error) override;
  void update(PassSystem<Scalar>& system) override;
  void solved(const PassSystem<Scalar>& system) override;
  void begin_search(const PassSystem<Scalar>& system, double& slope, double& curvature) override;
  [[nodiscard]] double slope_at(double fraction) const override;
  void end_search(double fraction) override {
    for (Contact& c : set_.contacts()) c.value = c.value_before + fraction * (c.value - c.value_before);
    free_.end_search(fraction);
  }
  [[nodiscard]] bool acts() const override;
  void fix_impulses() override {
    for (Contact& contact : set_.contacts()) contact.given = contact.impulse;
  }
  void add_impulses(const TermState<Scalar>& state, Field<Scalar>& impulse) const override;
  void subtract_product(const TermState<Scalar>& state, const Field<Scalar>& change,
                        Field<Scalar>& impulse) const override;
  void move(const Field<Scalar>& change) override;
  [[nodiscard]] const MatrixFreeTerm<Scalar>* coupling() const override { return free_.empty() ? nullptr : this; }
  [[nodiscard]] int max_passes() const override { return options_.passes; }  ///< see PiecewiseTerm
  [[nodiscard]] bool was_busy() const override { return histories_[piece_].was_busy; }
  void end_passes(int passes, bool settled) override {
    passes_ = passes;
    is_settled_ = settled;
  }
  void end_step(const TermState<Scalar>& end) override;
  [[nodiscard]] bool describe_rest(TermRest& out) const override {
    out = {&set_.obstacles(), touches_, report_.normal_force, report_.force_change, options_.margin, false};
    return true;
  }

 private:
  using Contact = detail::PointContact;
  struct History {  // of a piece of the body: how its last step was
    bool was_busy = false, has_jumped = false;
  };

  [[nodiscard]] static Vec3<double> centre_of_mass(const TermState<Scalar>& state);
  /// What a point has of a field of changes in the frame of the linearisation, in space.
  [[nodiscard]] Vec3<double> value_of(Index point, const Field<Scalar>& field) const {
    return in_space(points().interpolate(point, [&](Index v) { return field[linearized_.index(v)]; }));
  }
  /// Where a point ends without a change of velocities, in the world, m.
  [[nodiscard]] Vec3<double> guessed_end(Index point, const PassSystem<Scalar>& system) const {
    Vec3<double> end = set_.place_of(point, system.state);
    if (system.guess != nullptr) end += double(system.state.gamma) * value_of(point, *system.guess);
    return end;
  }

  [[nodiscard]] Vec3<double> in_frame(const Vec3<double>& v) const {
    return linearized_.frame.turns ? linearized_.frame.rotation.template cast<double>().transpose() * v : v;
  }
  [[nodiscard]] Vec3<double> in_space(const Vec3<double>& v) const {
    return linearized_.frame.turns ? linearized_.frame.rotation.template cast<double>() * v : v;
  }
  [[nodiscard]] Mat3<double> in_frame(const Mat3<double>& k) const {
    if (!linearized_.frame.turns) return k;
    const Mat3<double> q = linearized_.frame.rotation.template cast<double>();
    return q.transpose() * k * q;
  }

  /// Calls visit(vertex, weight) for the vertices that carry the contact's point.
  template <class Visit>
  void for_carriers(const Contact& contact, const Visit& visit) const {
    for (Index e = points().first(contact.point); e < points().last(contact.point); ++e)
      visit(points().vertex(e), points().weight(e));
  }

  void choose_springs(const PassSystem<Scalar>& system);
  void choose_spring(Contact& contact, const PassSystem<Scalar>& system);
  void add_to_matrix(const Contact& contact, const Mat3<Scalar>& k, BlockMatrix<Scalar>& matrix) const;
  [[nodiscard]] bool find_crossings(const PassSystem<Scalar>& system);
  /// From some pass on, so that the passes converge.
  [[nodiscard]] bool keeps_limits() const { return revisions_ > detail::last_free_revision; }
  void add(const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const override;

  ContactOptions options_;
  detail::ContactSet set_;
  std::vector<Touch> touches_;
  std::vector<Vec3<double>> from_, along_;  // of the line search, one a contact, m/s
  std::vector<double> share_;               // sum of the weights that contacts have on a vertex
  detail::FreeObstacles free_;
  TermState<Scalar> linearized_;  // of this step
  ContactReport report_;
  std::vector<History> histories_ = std::vector<History>(1);
  std::size_t piece_ = 0;                             // that is stepped
  Vec3<double> start_centre_ = Vec3<double>::Zero();  // of the body's mass, if there is a free obstacle
  int revisions_ = 0;                                 // of this linearisation
  detail::Augmentations augmentations_;
  double spring_cap_ = 0;  // of the mass
  double h_ = 0, gamma_ = 0;
  int passes_ = 0;  // of the last linearisation
  bool has_springs_ = false, is_settled_ = true;
};

template <std::floating_point Scalar>
Contacts<Scalar>::Contacts(ContactPoints points, Obstacles& obstacles, const ContactOptions& options)
    : options_(options),
      set_(std::move(points), obstacles,
           {options.friction, options.margin, options.max_depenetration, options.max_contacts_per_point}),
      from_(set_.capacity()),
      along_(set_.capacity()),
      share_(at(set_.points().vertex_count()), 0) {
  COROTET_ASSERT(options.passes >= 1 && options.friction >= 0 && options.max_depenetration > 0,
                 "contact needs a pass, friction that is not negative, and a speed to leave obstacles at");
  touches_.reserve(set_.capacity());
}

template <std::floating_point Scalar>
void Contacts<Scalar>::begin_step(const TermState<Scalar>& start) {
  Obstacles& obstacles = set_.obstacles();
  obstacles.begin_step(double(start.h));
  h_ = double(start.h);
  piece_ = at(start.piece.piece);
  if (piece_ == 0) {  // pieces come in their order
    touches_.clear();
    touches_.reserve(set_.capacity());
    report_ = {};
  }
  if (piece_ >= histories_.size()) histories_.resize(piece_ + 1);
  has_springs_ = false;
  passes_ = 0;
  is_settled_ = true;
  set_.begin_step(start);
  report_.candidates += size_of(set_.contacts());
  free_.begin(obstacles, set_.contacts());
  for (Index o = 0; o < obstacles.size(); ++o)
    if (obstacles[o].is_free() && obstacles[o].enabled) {
      start_centre_ = centre_of_mass(start);
      break;
    }
}

template <std::floating_point Scalar>
Vec3<double> Contacts<Scalar>::centre_of_mass(const TermState<Scalar>& state) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (std::size_t i = 0; i < state.rest.size(); ++i)
    sum += double(state.mass->row_sum(static_cast<Index>(i))) *
           (state.rest[i].template cast<double>() + state.displacement[i].template cast<double>());
  return sum / state.mass->total();
}

template <std::floating_point Scalar>
void Contacts<Scalar>::add_force(const TermState<Scalar>& state, TermForces<Scalar>& out) {
  for (Contact& contact : set_.contacts()) {
    contact.told.setZero();
    if (!has_springs_) continue;
    // In Newton's iteration: the law at the new iterate, with the springs of the step.
    const double gamma = double(state.gamma);
    contact.linearize(set_.place_of(contact.point, state), gamma, contact.kappa, contact.kappa_t);
    contact.evaluate(-free_.motion(contact));
    contact.told = contact.impulse / gamma;
    for_carriers(contact, [&](Index v, double weight) { out.add(v, (weight * contact.told).template cast<Scalar>()); });
  }
}

template <std::floating_point Scalar>
bool Contacts<Scalar>::linearize(PassSystem<Scalar>& system) {
  const TermState<Scalar>& state = linearized_ = system.state;
  gamma_ = double(state.gamma);
  free_.set_ratio(h_ / gamma_);
  if (!has_springs_) choose_springs(system);
  for (Contact& contact : set_.contacts()) {
    contact.linearize(guessed_end(contact.point, system), gamma_, contact.kappa, contact.kappa_t);
    if (has_springs_)
      contact.evaluate(-free_.motion(contact));
    else
      contact.start_from_memory(gamma_);
    contact.stiffness_in.setZero();
    contact.impulse_in = gamma_ * contact.told;
  }
  has_springs_ = true;
  revisions_ = 0;
  augmentations_.begin();
  update(system);
  return !set_.contacts().empty();
}

template <std::floating_point Scalar>
void Contacts<Scalar>::choose_springs(const PassSystem<Scalar>& system) {
  // The spring of a contact is that of the matrix's diagonal at its point, unless it is too stiff for the mass. With a
  // free obstacle, the smaller of the two masses counts.
  spring_cap_ = detail::spring_mass_ratio / double((std::max)(set_.contacts().size(), std::size_t{1}));
  for (const Contact& contact : set_.contacts())
    for_carriers(contact, [&](Index v, double weight) { share_[at(v)] += std::fabs(weight); });
  for (Contact& contact : set_.contacts()) choose_spring(contact, system);
  for (const Contact& contact : set_.contacts()) for_carriers(contact, [&](Index v, double) { share_[at(v)] = 0; });
}

template <std::floating_point Scalar>
void Contacts<Scalar>::choose_spring(Contact& contact, const PassSystem<Scalar>& system) {
  const Vec3<double> normal = in_frame(contact.normal);
  detail::ContactCompliance compliance;
  for_carriers(contact, [&](Index v, double weight) {
    compliance.add(system.matrix, *linearized_.mass, static_cast<Index>(linearized_.index(v)),
                   weight * weight * (std::max)(1.0, share_[at(v)]), normal);
  });
  const double other = set_.obstacle_of(contact).mass();
  if (compliance.is_held && !(other > 0)) return contact.release();  // neither gives way: no force could part them
  const double mass = other > 0 ? 1 / (1 / linearized_.mass->total() + 1 / other) : linearized_.mass->total();
  contact.kappa = (std::min)(1 / compliance.along, spring_cap_ * mass);
  contact.kappa_t = (std::min)(1 / compliance.across, spring_cap_ * mass);
}

template <std::floating_point Scalar>
void Contacts<Scalar>::update(PassSystem<Scalar>& system) {
  for (Contact& contact : set_.contacts()) contact.choose_piece(keeps_limits());
  free_.eliminate(set_.contacts());
  for (Contact& contact : set_.contacts()) {
    const Vec3<Scalar> impulse = in_frame(contact.piece_impulse - contact.impulse_in).template cast<Scalar>();
    for_carriers(contact, [&](Index v, double weight) {
      system.right_side[linearized_.index(v)] += static_cast<Scalar>(weight) * impulse;
    });
    contact.impulse_in = contact.piece_impulse;
    const Mat3<double> change = contact.piece_stiffness - contact.stiffness_in;
    contact.stiffness_in = contact.piece_stiffness;
    if (!change.isZero()) add_to_matrix(contact, in_frame(change).template cast<Scalar>(), system.matrix);
  }
}

template <std::floating_point Scalar>
void Contacts<Scalar>::add_to_matrix(const Contact& contact, const Mat3<Scalar>& k, BlockMatrix<Scalar>& matrix) const {
  for_carriers(contact, [&](Index v, double weight) {
    const auto row = static_cast<Index>(linearized_.index(v));
    for_carriers(contact, [&](Index w, double other) {
      const auto column = static_cast<Index>(linearized_.index(w));
      matrix.block(matrix.pattern().slot(row, column)) += static_cast<Scalar>(weight * other) * k;
    });
  });
}

template <std::floating_point Scalar>
void Contacts<Scalar>::solved(const PassSystem<Scalar>& system) {
  for (Contact& contact : set_.contacts()) {
    contact.value_before = contact.value;
    contact.value = value_of(contact.point, system.change);
  }
  free_.solve(set_.contacts());
}

template <std::floating_point Scalar>
bool Contacts<Scalar>::revise(const PassSystem<Scalar>& system, double error) {
  ++revisions_;
  bool changed = find_crossings(system);
  for (Contact& contact : set_.contacts()) contact.evaluate(contact.value - free_.motion(contact));
  changed = detail::judge(set_.contacts(), error, keeps_limits()) || changed;
  return changed || augmentations_.augment(set_.contacts(), gamma_, detail::deep_share * set_.extent());
}

/// What moves farther than was looked at may have leapt over an obstacle.
template <std::floating_point Scalar>
bool Contacts<Scalar>::find_crossings(const PassSystem<Scalar>& system) {
  bool found = false;
  const TermState<Scalar>& here = linearized_;
  const auto end_of = [&](Index v) -> Vec3<double> {
    Vec3<Scalar> change = system.change[here.index(v)];
    if (system.guess != nullptr) change += (*system.guess)[here.index(v)];
    return here.position(v).template cast<double>() + gamma_ * here.to_space(change).template cast<double>();
  };
  const auto end_of_point = [&](Index p) -> Vec3<double> {
    return guessed_end(p, system) + gamma_ * value_of(p, system.change);
  };
  set_.for_each_suspect(here, end_of, end_of_point, [&](Index p) {
    set_.find_crossings(p, end_of_point(p), [&](Contact& contact) {
      free_.add(set_.obstacles(), contact);
      spring_cap_ = (std::min)(spring_cap_, detail::spring_mass_ratio / double(set_.size_here()));
      choose_spring(contact, system);
      contact.linearize(guessed_end(p, system), gamma_, contact.kappa, contact.kappa_t);
      contact.start_from_memory(gamma_);
      contact.value = value_of(p, system.change);
      found = true;
    });
  });
  return found;
}

template <std::floating_point Scalar>
void Contacts<Scalar>::begin_search(const PassSystem<Scalar>& /*system*/, double& slope, double& curvature) {
  for (std::size_t i = 0; i < set_.contacts().size(); ++i) {
    const Contact& contact = set_.contacts()[i];
    Vec3<double> from = contact.value_before, along = contact.value - from;
    curvature -= along.dot(contact.stiffness_in * along);
    slope -= along.dot(contact.stiffness_in * from - contact.impulse_in);
    from -= free_.motion_from(contact);
    along -= free_.motion(contact) - free_.motion_from(contact);
    from_[i] = from;
    along_[i] = along;
  }
  free_.add_inertia(slope, curvature);
}

template <std::floating_point Scalar>
double Contacts<Scalar>::slope_at(double fraction) const {
  double sum = 0;
  for (std::size_t i = 0; i < set_.contacts().size(); ++i)
    sum -= set_.contacts()[i].work(from_[i] + fraction * along_[i], along_[i]);
  return sum;
}

template <std::floating_point Scalar>
bool Contacts<Scalar>::acts() const {
  return std::any_of(set_.contacts().begin(), set_.contacts().end(),
                     [](const Contact& contact) { return !contact.impulse.isZero(); });
}

template <std::floating_point Scalar>
void Contacts<Scalar>::add_impulses(const TermState<Scalar>& state, Field<Scalar>& impulse) const {
  for (const Contact& contact : set_.contacts()) {
    const Vec3<Scalar> more = in_frame(contact.given - gamma_ * contact.told).template cast<Scalar>();
    for_carriers(contact,
                 [&](Index v, double weight) { impulse[state.index(v)] += static_cast<Scalar>(weight) * more; });
  }
}

template <std::floating_point Scalar>
void Contacts<Scalar>::subtract_product(const TermState<Scalar>& state, const Field<Scalar>& change,
                                        Field<Scalar>& impulse) const {
  for (const Contact& contact : set_.contacts()) {
    if (contact.phase == ContactPhase::open) continue;
    const Vec3<Scalar> part =
        in_frame(contact.piece_stiffness * value_of(contact.point, change)).template cast<Scalar>();
    for_carriers(contact,
                 [&](Index v, double weight) { impulse[state.index(v)] -= static_cast<Scalar>(weight) * part; });
  }
}

template <std::floating_point Scalar>
void Contacts<Scalar>::move(const Field<Scalar>& change) {
  for (Contact& contact : set_.contacts())
    if (contact.phase != ContactPhase::open) contact.given -= contact.piece_stiffness * value_of(contact.point, change);
}

template <std::floating_point Scalar>
void Contacts<Scalar>::add(const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const {
  free_.couple(
      set_.contacts(),
      [&](const Contact& contact) {
        Vec3<double> sum = Vec3<double>::Zero();
        for_carriers(contact, [&](Index v, double weight) {
          sum += weight * x[linearized_.index(v)].vector().template cast<double>();
        });
        return Vec3<double>(in_space(sum));
      },
      [&](const Contact& contact, const Vec3<double>& f) {
        const Vec3<Scalar> part = in_frame(f).template cast<Scalar>();
        for_carriers(contact, [&](Index v, double weight) {
          PaddedVector<Scalar>& to = y[linearized_.index(v)];
          to.set(Vec3<Scalar>(to.vector() + static_cast<Scalar>(weight) * part));
        });
      });
}

template <std::floating_point Scalar>
void Contacts<Scalar>::end_step(const TermState<Scalar>& end) {
  set_.sort();
  const double eta = h_ / gamma_;
  double moved = 0, all = 0;
  for (Contact& contact : set_.contacts()) {
    const double force = contact.normal.dot(contact.given) / gamma_;
    moved += std::fabs(force - contact.last_force);
    all += (std::max)(force, contact.last_force);
    const Vec3<double> place = set_.place_of(contact.point, end);
    const double gap = contact.measured_gap +
                       contact.normal.dot(place - contact.reference - contact.led - gamma_ * free_.motion(contact));
    report_.deepest = (std::max)(report_.deepest, -gap);
    contact.is_inside = gap < 0;
    if (contact.given.isZero()) continue;
    ++report_.touching;
    const bool slides = contact.phase == ContactPhase::sliding;
    if (slides) ++report_.sliding;
    report_.normal_force += force;
    const Vec3<double> impulse = eta * contact.given;
    if (contact.free_body < 0) set_.obstacles()[contact.obstacle].add_load({-impulse, -contact.arm.cross(impulse)});
    if (touches_.size() < set_.capacity())
      touches_.push_back({contact.point, contact.obstacle, contact.start, contact.normal, impulse, slides});
  }
  // The body's moment is that of the impulse where its point ends, about its centre of mass there.
  Vec3<double> flown = Vec3<double>::Zero();
  const bool moves_freely = linearized_.frame.turns;
  if (!free_.empty() && moves_freely) flown = centre_of_mass(end) - start_centre_;
  free_.finish(set_.contacts(), set_.obstacles(), [&](const Contact& contact) -> Vec3<double> {
    return moves_freely ? Vec3<double>(contact.arm + set_.place_of(contact.point, end) - contact.start - flown)
                        : contact.arm;
  });
  const double share = detail::exactly_equal(h_, gamma_) ? 0.5 : 0.05;  // of the force, for the multiplier
  set_.remember(end, gamma_, [&](const Contact& contact) { return free_.stable_share(contact, share); });
  report_.dropped += set_.dropped();
  report_.force_change += moved;
  report_.passes = (std::max)(report_.passes, passes_);
  report_.settled = report_.settled && is_settled_;
  histories_[piece_] = {.was_busy = passes_ > 1, .has_jumped = moved > 0.5 * all};
}

COROTET_INSTANCES_OF_SCALAR(Contacts)

}  // namespace corotet::inline v0_1
