// Contact of soft bodies with each other, and of a body with itself.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/contact_surface.hpp>
#include <corotet/detail/contact/joint_contacts.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/contact/soft_contact_finder.hpp>
#include <corotet/detail/contact/soft_side.hpp>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/solve/joint_pcg.hpp>
#include <corotet/detail/terms/piecewise_term.hpp>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// One contact between two bodies in the last step, in the world.
struct SoftTouch {
  Index body;                     ///< whose point it is
  Index point;                    ///< of its ContactSurface
  Index other;                    ///< what it touches: another body, or the same
  Index triangle;                 ///< of the other one's ContactSurface
  std::array<double, 3> weights;  ///< where on the triangle: shares of its corners
  Vec3<double> place;             ///< of the point at the start of the step, m
  Vec3<double> normal;            ///< out of `other`
  Vec3<double> impulse;           ///< on `body`, N s; on `other` the opposite
  bool slides;                    ///< it does not stick
};

/// Contact of soft bodies with each other, and of bodies with themselves, with Coulomb friction.
///
/// Bodies that are near each other are solved as one system, so that stacks stand and nothing depends on their order.
/// The law and the passes are those of Contacts, with which it may be combined for obstacles.
/// @snippet soft_contact.cpp soft
/// `step` calls back for each body's step, one within the other where bodies are near: each body needs an integrator,
/// and terms, of its own. Points of each surface are tested against the triangles of the others; edges may cross where
/// meshes are coarse. Bodies that touch are stepped by backward Euler, and in Newton's method contact is solved for
/// once. A body of several pieces that do not touch has no contact here: make bodies of them. Solvers without a
/// preconditioner refuse the step (SolveStatus::invalid_options). Points inside another body are led out no faster than
/// the smaller one's extent in a second.
template <std::floating_point Scalar>
class SoftContacts {
 public:
  /// Without bodies. Friction, margin and passes are the same for all.
  COROTET_COLD explicit SoftContacts(const ContactOptions& options = {}) : options_(options) {}
  SoftContacts(const SoftContacts&) = default;
  SoftContacts& operator=(const SoftContacts&) = default;
  SoftContacts(SoftContacts&&) noexcept = default;
  SoftContacts& operator=(SoftContacts&&) noexcept = default;
  ~SoftContacts() = default;

  /// Adds a body by its surface, and returns its number: 0, 1, ... `touches_itself`: whether its points are tested
  /// against its own triangles too.
  COROTET_COLD Index add(ContactSurface surface, bool touches_itself = true);

  /// Number of bodies.
  [[nodiscard]] Index size() const { return static_cast<Index>(sides_.size()); }
  /// What it was made with.
  [[nodiscard]] const ContactOptions& options() const { return options_; }
  /// What a body was added with.
  [[nodiscard]] const ContactPoints& points(Index body) const { return sides_[at(body)].surface.points(); }

  /// Steps all bodies: `step_body(body, term)` steps one by its integrator, with `term` (StepTerm&) among the step's
  /// terms, and may keep the report.
  template <std::invocable<Index, StepTerm<Scalar>&> StepBody>
  void step(StepBody&& step_body) {
    using Function = std::remove_reference_t<StepBody>;
    step_all([](void* object, Index body, StepTerm<Scalar>& term) { (*static_cast<Function*>(object))(body, term); },
             const_cast<void*>(static_cast<const void*>(&step_body)));
  }

  /// Of the last step, over all bodies.
  [[nodiscard]] const ContactReport& report() const { return report_; }
  /// Those with a force.
  [[nodiscard]] std::span<const SoftTouch> touches() const { return touches_; }

  /// Forgets the forces of earlier steps: after bodies were set elsewhere.
  void reset();

 private:
  using Contact = detail::SoftContact;
  using Memory = detail::ContactMemory;
  using Side = detail::SoftSide<Scalar>;

  /// @cond
  /// A body as a term of its own step.
  struct Term final : PiecewiseTerm<Scalar> {
    SoftContacts* all = nullptr;  // while it steps
    Index body;
    Box reach = everywhere();  // where it may be in the next step
    bool touched = false;      // itself, in the last step

    // Of this step.
    Index order = 0;  // in which it came to its solve
    bool is_crowded = false, is_whole = true, is_reached = false, is_solved = false, is_told = false, has_ended = false;
    SolveReport solve_report;

    explicit Term(Index number) : body(number) {}

    void begin_step(const TermState<Scalar>& start) override;
    [[nodiscard]] bool needs_first_order() const override { return is_crowded || touched; }
    void add_force(const TermState<Scalar>& now, TermForces<Scalar>& out) override;
    void end_step(const TermState<Scalar>& end) override;

    [[nodiscard]] SolveReport solve_in_passes(PassSystem<Scalar>& system, const Terms<Scalar>& terms) override;
    [[nodiscard]] bool joins_bodies() const override { return true; }
    /// Whether it does the work for all of its island.
    [[nodiscard]] bool leads() const { return order == 0 && !is_solved; }
    [[nodiscard]] bool linearize(PassSystem<Scalar>& /*system*/) override {
      if (leads()) all->contacts_.linearize();
      return !is_solved;  // the first one puts impulses on all right sides
    }
    [[nodiscard]] bool revise(const PassSystem<Scalar>& /*system*/, double error) override {
      return leads() && all->contacts_.revise(error);
    }
    void update(PassSystem<Scalar>& /*system*/) override {
      if (leads()) all->contacts_.update();
    }
    void solved(const PassSystem<Scalar>& /*system*/) override {
      if (leads()) all->contacts_.take_values();
    }
    void begin_search(const PassSystem<Scalar>& /*system*/, double& slope, double& /*curvature*/) override {
      if (leads()) all->contacts_.begin_search(slope);
    }
    [[nodiscard]] double slope_at(double fraction) const override {
      return leads() ? all->contacts_.slope_at(fraction) : 0;
    }
    void end_search(double fraction) override {
      if (leads()) all->contacts_.end_search(fraction);
    }
    [[nodiscard]] bool acts() const override;
    void fix_impulses() override {}
    void add_impulses(const TermState<Scalar>& now, Field<Scalar>& impulse) const override;
    void subtract_product(const TermState<Scalar>& now, const Field<Scalar>& change,
                          Field<Scalar>& impulse) const override;
    void move(const Field<Scalar>& change) override;
    [[nodiscard]] int max_passes() const override { return all->options_.passes; }
    [[nodiscard]] bool was_busy() const override { return all->was_busy_; }
    void end_passes(int passes, bool settled) override {
      if (leads()) all->end_passes(passes, settled);
    }

    [[nodiscard]] Side& side() const { return all->sides_[at(body)]; }
    /// Whether a contact is of this body alone, and has a force.
    [[nodiscard]] bool moves(const Contact& contact) const {
      return contact.side == body && contact.other == body && contact.phase != ContactPhase::open;
    }
  };

  /// @endcond

  /// The passes of all bodies of an island.
  class Joint final : public detail::Passes<Scalar> {
   public:
    explicit Joint(SoftContacts& all) : detail::Passes<Scalar>(all.members_), all_(all) {}

   private:
    SolveReport solve_systems(double looseness) override {
      all_.parts_.clear();
      for (std::size_t i = 0; i < this->members().size(); ++i) {
        PassSystem<Scalar>& system = *this->members()[i].system;
        const auto prepared = system.prepare();
        if (!prepared) return {SolveStatus::invalid_options, 0, 1.0};
        all_.parts_.push_back({&system.matrix, &system.right_side, &system.change, *prepared, &all_.side_of(i).fields,
                               all_.side_of(i).state.executor});
      }
      using Place = typename detail::JointPcg<Scalar>::Member;
      return detail::JointPcg<Scalar>(all_.parts_).solve(looseness, [&](Place x, Place y) {
        all_.contacts_.couple(x, y);
        for (std::size_t i = 0; i < this->members().size(); ++i)
          this->add_coupling(this->members()[i], all_.side_of(i).fields.*x, all_.side_of(i).fields.*y);
      });
    }
    SoftContacts& all_;
  };

  using Callback = void (*)(void*, Index, StepTerm<Scalar>&);

  [[nodiscard]] static Box everywhere() {
    return {Vec3<double>::Constant(-std::numeric_limits<double>::infinity()),
            Vec3<double>::Constant(std::numeric_limits<double>::infinity())};
  }
  void step_all(Callback step_body, void* object);
  void find_islands();
  void enter(std::size_t place);
  void solve_members();
  void end_passes(int passes, bool settled);
  void finish();
  [[nodiscard]] Side& side_of(std::size_t member) { return sides_[at(member_body_[member])]; }
  [[nodiscard]] Term& term_of(std::size_t member) { return terms_[at(member_body_[member])]; }

  ContactOptions options_;
  std::vector<Term> terms_;  // one a body
  std::vector<Side> sides_;
  detail::JointContacts<Scalar> contacts_;    // of the island that is stepped
  std::vector<Memory> memory_, next_memory_;  // by pair and point
  std::vector<SoftTouch> touches_;
  std::vector<Index> order_, island_of_;  // bodies by islands; of each body
  std::size_t island_end_ = 0;            // in order_
  std::vector<detail::PassMember<Scalar>> members_;
  std::vector<Index> member_body_;
  std::vector<detail::JointPcgPart<Scalar>> parts_;
  ContactReport report_;
  Callback step_body_ = nullptr;
  void* object_ = nullptr;
  bool was_busy_ = false, is_busy_ = false;
};

template <std::floating_point Scalar>
Index SoftContacts<Scalar>::add(ContactSurface surface, bool touches_itself) {
  const Index body = size();
  terms_.emplace_back(body);
  sides_.emplace_back(body, std::move(surface), touches_itself);
  std::size_t capacity = 0;
  for (const Side& side : sides_) capacity += at(side.surface.points().size());
  capacity *= at((std::max)(options_.max_contacts_per_point, Index{1}));
  contacts_.reserve(capacity);
  memory_.reserve(capacity);
  next_memory_.reserve(capacity);
  touches_.reserve(capacity);
  for (std::vector<Index>* list : {&order_, &island_of_, &member_body_}) list->reserve(sides_.size());
  members_.reserve(sides_.size());
  parts_.reserve(sides_.size());
  memory_.clear();  // pairs of bodies have other numbers now
  return body;
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::reset() {
  memory_.clear();
  touches_.clear();
  report_ = {};
  was_busy_ = false;
  for (Term& term : terms_) {
    term.reach = everywhere();
    term.touched = false;
  }
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::step_all(Callback step_body, void* object) {
  COROTET_ASSERT(step_body_ == nullptr, "a step of these bodies is under way");
  step_body_ = step_body;
  object_ = object;
  report_ = {};
  touches_.clear();
  next_memory_.clear();
  is_busy_ = false;
  for (Term& term : terms_) term.all = this;
  find_islands();
  for (std::size_t begin = 0; begin < order_.size(); begin = island_end_) {
    island_end_ = begin;
    while (island_end_ < order_.size() && island_of_[at(order_[island_end_])] == island_of_[at(order_[begin])])
      ++island_end_;
    members_.clear();
    member_body_.clear();
    contacts_.clear();
    for (std::size_t i = begin; i < island_end_; ++i) terms_[at(order_[i])].is_crowded = island_end_ - begin > 1;
    enter(begin);
    finish();
  }
  std::sort(next_memory_.begin(), next_memory_.end(), Memory::precedes);
  memory_.swap(next_memory_);
  was_busy_ = is_busy_;
  for (Term& term : terms_) term.all = nullptr;
  step_body_ = nullptr;
}

/// Bodies that may come to touch in this step are in one island.
template <std::floating_point Scalar>
void SoftContacts<Scalar>::find_islands() {
  const Index count = size();
  island_of_.resize(at(count));
  order_.resize(at(count));
  for (Index i = 0; i < count; ++i) island_of_[at(i)] = order_[at(i)] = i;
  for (Index i = 0; i < count; ++i)
    for (Index j = 0; j < i; ++j) {
      const Index a = island_of_[at(i)], b = island_of_[at(j)];
      if (a == b || !terms_[at(i)].reach.overlaps(terms_[at(j)].reach)) continue;
      for (Index k = 0; k <= i; ++k)
        if (island_of_[at(k)] == (std::max)(a, b)) island_of_[at(k)] = (std::min)(a, b);
    }
  std::sort(order_.begin(), order_.end(), [this](Index a, Index b) {
    return island_of_[at(a)] != island_of_[at(b)] ? island_of_[at(a)] < island_of_[at(b)] : a < b;
  });
}

/// Steps one body of the island; from within, at its solve, the next one.
template <std::floating_point Scalar>
void SoftContacts<Scalar>::enter(std::size_t place) {
  if (place == island_end_) return;
  Term& term = terms_[at(order_[place])];
  term.is_reached = term.is_solved = term.is_told = term.has_ended = false;
  term.order = static_cast<Index>(members_.size());
  step_body_(object_, term.body, term);
  if (!term.is_reached) enter(place + 1);  // it was refused before its solve
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::solve_members() {
  contacts_.begin(sides_, double(side_of(0).state.gamma));
  detail::SoftContactFinder<Scalar> finder(options_, size(), memory_, contacts_.list());
  for (std::size_t i = 0; i < members_.size(); ++i)
    for (std::size_t j = 0; j < members_.size(); ++j)
      if (i != j || side_of(i).touches_itself) finder.find_between(side_of(i), side_of(j));
  report_.dropped += finder.dropped();
  if (contacts_.list().empty()) {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      term_of(i).is_solved = true;
      term_of(i).solve_report = detail::PassesOfOne<Scalar>(members_[i]).run();
    }
    return;
  }
  for (const auto& member : members_)
    for (Vec3<Scalar>& d : member.system->change) d.setZero();
  const SolveReport report = Joint(*this).run();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    term_of(i).is_solved = true;
    term_of(i).solve_report = report;
  }
}

/// @cond
template <std::floating_point Scalar>
SolveReport SoftContacts<Scalar>::Term::solve_in_passes(PassSystem<Scalar>& system, const Terms<Scalar>& terms) {
  if (is_solved || !is_whole) return PiecewiseTerm<Scalar>::solve_in_passes(system, terms);
  is_reached = true;
  side().system = &system;
  side().state = system.state;
  all->members_.push_back({&system, terms});
  all->member_body_.push_back(body);
  std::size_t place = 0;
  while (all->order_[place] != body) ++place;
  all->enter(place + 1);
  if (!is_solved) all->solve_members();
  side().system = nullptr;
  return solve_report;
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::begin_step(const TermState<Scalar>& start) {
  COROTET_ASSERT(all != nullptr, "this term is of a step that SoftContacts::step calls for");
  is_whole = start.piece.local.empty();
  if (is_whole) side().begin_step(start);
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::add_force(const TermState<Scalar>& now, TermForces<Scalar>& out) {
  is_told = is_solved;  // then the impulses are known, and what solves the step again takes them as forces
  if (!is_told) return;
  side().for_impulses(all->contacts_.list(), [&](Index v, const Vec3<double>& impulse) {
    out.add(v, (impulse / double(now.gamma)).template cast<Scalar>());
  });
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::end_step(const TermState<Scalar>& end) {
  if (!is_whole) return;
  has_ended = true;
  const double fastest = side().end_step(end);
  const detail::MovingSurface& surface = side().surface;
  reach = Box{};
  for (Index p = 0; p < surface.points().size(); ++p) reach.add(surface.end(p));
  constexpr double steps = 3;  // the next may be longer, and faster
  const double near_distance = detail::SoftContactFinder<Scalar>::near_share * surface.points().extent();
  const Vec3<double> around =
      Vec3<double>::Constant(steps * double(end.h) * fastest + all->options_.margin + near_distance);
  reach = {reach.low - around, reach.high + around};
}

template <std::floating_point Scalar>
bool SoftContacts<Scalar>::Term::acts() const {
  const std::vector<Contact>& contacts = all->contacts_.list();
  return std::any_of(contacts.begin(), contacts.end(), [this](const Contact& contact) {
    return (contact.side == body || contact.other == body) && !contact.given.isZero();
  });
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::add_impulses(const TermState<Scalar>& now, Field<Scalar>& impulse) const {
  if (is_told) return;
  side().for_impulses(all->contacts_.list(), [&](Index v, const Vec3<double>& part) {
    impulse[now.index(v)] += side().in_frame(part).template cast<Scalar>();
  });
}

/// What is solved for once all is joint stays: if one body then gave way, the impulse on the other would be another
/// one. Only what a body does to itself follows its corrections.
template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::subtract_product(const TermState<Scalar>& now, const Field<Scalar>& change,
                                                  Field<Scalar>& impulse) const {
  if (is_told) return;
  for (const Contact& contact : all->contacts_.list()) {
    if (!moves(contact)) continue;
    const Vec3<double> part = side().in_frame(contact.piece_stiffness * side().value(contact, change));
    side().for_carriers(
        contact, [&](Index v, double weight) { impulse[now.index(v)] -= (weight * part).template cast<Scalar>(); });
  }
}

template <std::floating_point Scalar>
void SoftContacts<Scalar>::Term::move(const Field<Scalar>& change) {
  if (is_told) return;
  for (Contact& contact : all->contacts_.list())
    if (moves(contact)) contact.given -= contact.piece_stiffness * side().value(contact, change);
}

/// @endcond

template <std::floating_point Scalar>
void SoftContacts<Scalar>::end_passes(int passes, bool settled) {
  contacts_.settle();
  report_.passes = (std::max)(report_.passes, passes);
  report_.settled = report_.settled && settled;
  is_busy_ = is_busy_ || passes > 1;
}

/// Once all bodies of the island are where they go: what contacts tell, and what they leave to the next step.
template <std::floating_point Scalar>
void SoftContacts<Scalar>::finish() {
  constexpr double share = 0.5;  // of the force, that the multiplier takes over
  for (std::size_t i = 0; i < members_.size(); ++i) term_of(i).touched = false;
  report_.candidates += size_of(contacts_.list());
  const double gamma = contacts_.gamma();
  for (const Contact& contact : contacts_.list()) {
    if (!terms_[at(contact.side)].has_ended || !terms_[at(contact.other)].has_ended) continue;
    const Side &a = sides_[at(contact.side)], &b = sides_[at(contact.other)];
    const Vec3<double> end = a.surface.end(contact.point) - b.surface.end(contact.triangle, contact.weights);
    const double gap = contact.measured_gap + contact.normal.dot(end - contact.reference);
    report_.deepest = (std::max)(report_.deepest, -gap);
    const double force = contact.normal.dot(contact.given) / gamma;
    if (gap < 0 || force > 0) {
      Memory& memory = next_memory_.emplace_back();
      memory.obstacle = contact.obstacle;
      memory.point = contact.point;
      memory.phase = contact.phase;
      memory.force = force;
      memory.multiplier = (std::max)(0.0, (1 - share) * contact.multiplier_before + share * force);
      memory.friction = contact.tangential_part(contact.given) / gamma;
      if (contact.side == contact.other) terms_[at(contact.side)].touched = true;
    }
    if (contact.given.isZero()) continue;
    ++report_.touching;
    const bool slides = contact.phase == ContactPhase::sliding;
    if (slides) ++report_.sliding;
    report_.normal_force += force;
    touches_.push_back({contact.side, contact.point, contact.other, contact.triangle, contact.weights,
                        a.surface.start(contact.point), contact.normal, a.h / gamma * contact.given, slides});
  }
}

}  // namespace corotet::inline v0_1
