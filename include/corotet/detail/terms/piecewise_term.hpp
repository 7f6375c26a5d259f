// Terms whose force is piecewise linear in a step: which piece holds is found by solving the step in several passes.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/prepared_preconditioner.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>
#include <optional>
#include <span>

namespace corotet::inline v0_1 {

/// The linear system A d = r of a step for the change d of velocities, between its solves.
template <std::floating_point Scalar>
class PassSystem {
 public:
  PassSystem(const PassSystem&) = delete;
  PassSystem& operator=(const PassSystem&) = delete;

  const TermState<Scalar>& state;  ///< where forces are linearised
  BlockMatrix<Scalar>& matrix;     ///< A, kg, in the frame of the state
  Field<Scalar>& right_side;       ///< r, kg m/s
  Field<Scalar>& change;           ///< d, m/s: of the last solve
  /// Velocities that are added to the change, m/s, where forces are linearised at velocity zero; else null.
  const Field<Scalar>* guess;
  Field<Scalar>& from;     ///< for the driver of the passes
  Field<Scalar>& product;  ///< for the driver of the passes

  /// Solves the system, to `looseness` >= 1 times the solver's tolerance. `coupling` adds to A.
  [[nodiscard]] virtual SolveReport solve(double looseness, const MatrixFreeTerm<Scalar>* coupling) = 0;
  /// Makes the equations of what is pinned stand alone: after each change of A.
  virtual void eliminate_pinned_rows() = 0;
  /// Sets what is pinned to zero in a field.
  virtual void clear_pinned(PaddedField<Scalar>& field) const = 0;
  /// The solver's preconditioner for A as it is now, to be used until the next solve; empty if it has none.
  [[nodiscard]] virtual std::optional<detail::PreparedPreconditioner<Scalar>> prepare() = 0;

 protected:
  /// Refers to the parts of a step.
  PassSystem(const TermState<Scalar>& at, BlockMatrix<Scalar>& a, Field<Scalar>& r, Field<Scalar>& d,
             const Field<Scalar>* more, Field<Scalar>& scratch, Field<Scalar>& other_scratch)
      : state(at), matrix(a), right_side(r), change(d), guess(more), from(scratch), product(other_scratch) {}
  ~PassSystem() = default;
};

/// A force that is linear in the change of velocities in each of several pieces, and minus the gradient of a convex
/// function of it: contact with friction.
///
/// A step solves its linear system with the pieces that the terms guess, asks whether they hold at the solution, and if
/// not changes them and solves again, with a line search on the convex function (semismooth Newton iteration: Qi &
/// Sun 1993). A pass costs a solve; at rest and in steady motion one is enough.
template <std::floating_point Scalar>
class PiecewiseTerm : public StepTerm<Scalar> {
 public:
  [[nodiscard]] PiecewiseTerm* piecewise() final { return this; }

  /// Adds the pieces that are guessed to the system. False: there are none, and nothing was added.
  [[nodiscard]] virtual bool linearize(PassSystem<Scalar>& system) = 0;
  /// Chooses the pieces that hold at `system.change`, whose error is at most `error` in the energy norm, sqrt(J)
  /// sqrt(s). False if those in the system do. They are put there by `update`.
  [[nodiscard]] virtual bool revise(const PassSystem<Scalar>& system, double error) = 0;
  /// Puts the pieces that were chosen last into the system.
  virtual void update(PassSystem<Scalar>& system) = 0;
  /// After a solve.
  virtual void solved(const PassSystem<Scalar>& /*system*/) {}
  /// For the line search from `system.from` to `system.change`: takes the term's part out of slope and curvature of the
  /// system's quadratic function.
  virtual void begin_search(const PassSystem<Scalar>& system, double& slope, double& curvature) = 0;
  /// Slope of the term's function at a fraction of the way.
  [[nodiscard]] virtual double slope_at(double fraction) const = 0;
  /// The way is gone by this fraction, which `system.change` follows.
  virtual void end_search(double /*fraction*/) {}

  /// Whether the solution has any impulse of this term.
  [[nodiscard]] virtual bool acts() const = 0;
  /// The impulses of the solution are now those that the body's momentum gets.
  virtual void fix_impulses() = 0;
  /// Adds them, N s in the frame, less those of the force that `add_force` told.
  virtual void add_impulses(const TermState<Scalar>& state, Field<Scalar>& impulse) const = 0;
  /// Subtracts the product of the pieces in the system with a change of velocities from `impulse`, N s, both in the
  /// frame.
  virtual void subtract_product(const TermState<Scalar>& state, const Field<Scalar>& change,
                                Field<Scalar>& impulse) const = 0;
  /// The solution has changed by so much more: the impulses that were fixed follow.
  virtual void move(const Field<Scalar>& change) = 0;

  /// Part of A that lies outside its pattern, or null.
  [[nodiscard]] virtual const MatrixFreeTerm<Scalar>* coupling() const { return nullptr; }
  /// How many passes a step makes at most.
  [[nodiscard]] virtual int max_passes() const = 0;
  /// Whether the last step took several passes: then the first ones of the next are solved loosely.
  [[nodiscard]] virtual bool was_busy() const = 0;
  /// So many passes were made; `settled`: the pieces of the last one hold.
  virtual void end_passes(int passes, bool settled) = 0;

  /// Solves the system in passes for all piecewise terms among `terms`.
  [[nodiscard]] virtual SolveReport solve_in_passes(PassSystem<Scalar>& system, const Terms<Scalar>& terms);
  /// Whether this one solves for the terms of several bodies: then it is asked, whatever its place among the terms.
  [[nodiscard]] virtual bool joins_bodies() const { return false; }
};

namespace detail {

/// A body's system, and the terms that act on it.
template <std::floating_point Scalar>
struct PassMember {
  PassSystem<Scalar>* system;
  Terms<Scalar> terms;
};

/// The iteration over passes, of the systems of one body or of several that are solved as one. Virtual calls keep it
/// out of programs that have no piecewise term.
template <std::floating_point Scalar>
class Passes {
 public:
  using Member = PassMember<Scalar>;

  explicit Passes(std::span<const Member> members) : members_(members) {}
  Passes(const Passes&) = delete;
  Passes& operator=(const Passes&) = delete;
  virtual ~Passes() = default;

  SolveReport run() {
    bool any = false, busy = false;
    int most = 1;
    for (const Member& member : members_) {
      bool has_pieces = false;
      for_each(member, [&](PiecewiseTerm<Scalar>& term) {
        has_pieces = term.linearize(*member.system) || has_pieces;
        busy = busy || term.was_busy();
        most = (std::max)(most, term.max_passes());
      });
      if (has_pieces) member.system->eliminate_pinned_rows();
      any = any || has_pieces;
    }
    bool is_loose = any && busy, settled = true;
    solve(is_loose ? loose : 1);
    int passes = 1;
    while (is_alive()) {
      settled = !revise();
      if (!settled && passes < most) {
        pass(is_loose ? loose : 1);
        ++passes;
        continue;
      }
      if (!is_loose) break;
      is_loose = false;
      update();
      solve(1);
    }
    for_each([&](PiecewiseTerm<Scalar>& term, Member) { term.end_passes(passes, settled); });
    return total_;
  }

 protected:
  /// Solves all systems, each coupled by what its terms couple, to `looseness` times the solver's tolerance.
  virtual SolveReport solve_systems(double looseness) = 0;

  [[nodiscard]] std::span<const Member> members() const { return members_; }

  /// Whether a term of a member couples vertices outside the pattern of its matrix.
  [[nodiscard]] bool couples(const Member& member) const {
    bool any = false;
    for_each(member, [&](PiecewiseTerm<Scalar>& term) { any = any || term.coupling() != nullptr; });
    return any;
  }
  /// Adds to y the product of what the terms of a member couple with x.
  void add_coupling(const Member& member, const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const {
    for_each(member, [&](PiecewiseTerm<Scalar>& term) {
      if (const auto* part = term.coupling()) part->add(x, y);
    });
    member.system->clear_pinned(y);
  }

 private:
  static constexpr double loose = 10;  // times the solver's tolerance: for passes that are judged again

  template <class Visit>
  static void for_each(const Member& member, const Visit& visit) {
    for (std::size_t t = 0; t < member.terms.size(); ++t)
      if (PiecewiseTerm<Scalar>* term = member.terms[t].piecewise()) visit(*term);
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Member& member : members_) for_each(member, [&](PiecewiseTerm<Scalar>& term) { visit(term, member); });
  }

  void update() {
    for (const Member& member : members_) {
      for_each(member, [&](PiecewiseTerm<Scalar>& term) { term.update(*member.system); });
      member.system->eliminate_pinned_rows();
    }
  }

  [[nodiscard]] bool is_alive() const {
    return total_.status != SolveStatus::breakdown && total_.status != SolveStatus::invalid_options;
  }

  void solve(double looseness) {
    const SolveReport report = solve_systems(looseness);
    total_.iterations += report.iterations;
    total_.residual = report.residual;
    total_.status = report.status;
    for_each([&](PiecewiseTerm<Scalar>& term, const Member& member) { term.solved(*member.system); });
  }

  [[nodiscard]] bool revise() {
    double energy = 0;
    for (const Member& member : members_) energy += dot(member.system->right_side, member.system->change);
    const double error = total_.residual * detail::square_root((std::max)(0.0, energy));
    bool changed = false;
    for_each([&](PiecewiseTerm<Scalar>& term, const Member& member) {
      changed = term.revise(*member.system, error) || changed;
    });
    return changed;
  }

  void pass(double looseness) {
    update();
    for (const Member& member : members_)
      for (std::size_t i = 0; i < member.system->from.size(); ++i) member.system->from[i] = member.system->change[i];
    solve(looseness);
    if (!is_alive()) return;
    const double fraction = search();
    for_each([&](PiecewiseTerm<Scalar>& term, Member) { term.end_search(fraction); });
    if (!(fraction < 1)) return;
    for (const Member& member : members_) {
      Field<Scalar>&change = member.system->change, &from = member.system->from;
      for (std::size_t i = 0; i < from.size(); ++i)
        change[i] = from[i] + static_cast<Scalar>(fraction) * (change[i] - from[i]);
    }
  }

  /// The fraction of the way that leads to the lowest point of the convex function on it.
  [[nodiscard]] double search() {
    double slope = 0, curvature = 0;
    for (const Member& member : members_) add_quadratic(*member.system, slope, curvature);
    for_each([&](PiecewiseTerm<Scalar>& term, const Member& member) {
      term.begin_search(*member.system, slope, curvature);
    });
    const auto derivative = [&](double fraction) {
      double sum = slope + fraction * curvature;
      for_each([&](PiecewiseTerm<Scalar>& term, Member) { sum += term.slope_at(fraction); });
      return sum;
    };
    constexpr double enough = 0.1, accuracy = 0.05, least = 1e-3;
    constexpr int max_trials = 30;
    double low = 0, high = 1, at_low = derivative(0), at_high = derivative(1);
    const double first = std::fabs(at_low);
    if (!(at_low < 0) || at_high <= enough * first) return 1;
    double fraction = 1;
    for (int trial = 0; trial < max_trials; ++trial) {  // secants and bisections in turn
      fraction = trial % 2 == 0 ? low - at_low * (high - low) / (at_high - at_low) : (low + high) / 2;
      const double here = derivative(fraction);
      if (std::fabs(here) < accuracy * first) break;
      if (here < 0) {
        low = fraction;
        at_low = here;
      } else {
        high = fraction;
        at_high = here;
      }
    }
    return std::clamp(fraction, least, 1.0);
  }

  /// Slope and curvature of a system's quadratic function on the way from `from` to `change`.
  static void add_quadratic(PassSystem<Scalar>& system, double& slope, double& curvature) {
    for (Index i = 0; i < size_of(system.from); ++i) system.product[at(i)] = system.change[at(i)] - system.from[at(i)];
    for (Index i = 0; i < size_of(system.from); ++i) {
      Vec3<Scalar> row;
      system.matrix.row_product(i, system.product).template store_part<3>(row.data());
      const Vec3<double> a = row.template cast<double>(), along = system.product[at(i)].template cast<double>();
      curvature += along.dot(a);
      slope += system.from[at(i)].template cast<double>().dot(a) -
               along.dot(system.right_side[at(i)].template cast<double>());
    }
  }

  [[nodiscard]] static double dot(const Field<Scalar>& a, const Field<Scalar>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].template cast<double>().dot(b[i].template cast<double>());
    return sum;
  }

  std::span<const Member> members_;
  SolveReport total_{};
};

/// The passes of one body, by its own solver.
template <std::floating_point Scalar>
class PassesOfOne final : public Passes<Scalar>, private MatrixFreeTerm<Scalar> {
 public:
  explicit PassesOfOne(const PassMember<Scalar>& member) : Passes<Scalar>({&member, 1}) {}

 private:
  SolveReport solve_systems(double looseness) override {
    const PassMember<Scalar>& member = this->members().front();
    return member.system->solve(looseness, this->couples(member) ? this : nullptr);
  }
  void add(const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const override {
    this->add_coupling(this->members().front(), x, y);
  }
};

}  // namespace detail

template <std::floating_point Scalar>
SolveReport PiecewiseTerm<Scalar>::solve_in_passes(PassSystem<Scalar>& system, const Terms<Scalar>& terms) {
  const detail::PassMember<Scalar> member{&system, terms};
  return detail::PassesOfOne<Scalar>(member).run();
}

}  // namespace corotet::inline v0_1
