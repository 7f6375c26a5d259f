// Terms whose force is piecewise linear in a step: which piece holds is found by solving the step in several passes.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <corotet/detail/terms/term_state.hpp>
#include <cstddef>

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
  [[nodiscard]] virtual SolveReport solve_in_passes(PassSystem<Scalar>& system, const Terms<Scalar>& terms) {
    return Passes(terms, system).run();
  }

 private:
  /// The iteration over passes; virtual calls keep it out of programs that have no such term.
  struct Passes : MatrixFreeTerm<Scalar> {
    static constexpr double loose = 10;  // times the solver's tolerance: for passes that are judged again

    const Terms<Scalar>& terms;
    PassSystem<Scalar>& system;
    SolveReport total{};
    bool couples = false;

    Passes(const Terms<Scalar>& all, PassSystem<Scalar>& of) : terms(all), system(of) {}

    template <class Visit>
    void for_each(const Visit& visit) const {
      for (std::size_t t = 0; t < terms.size(); ++t)
        if (PiecewiseTerm* term = terms[t].piecewise()) visit(*term);
    }

    void add(const PaddedField<Scalar>& x, PaddedField<Scalar>& y) const override {
      for_each([&](PiecewiseTerm& term) {
        if (const auto* part = term.coupling()) part->add(x, y);
      });
    }

    SolveReport run() {
      bool any = false, busy = false;
      int most = 1;
      for_each([&](PiecewiseTerm& term) {
        any = term.linearize(system) || any;
        busy = busy || term.was_busy();
        couples = couples || term.coupling() != nullptr;
        most = (std::max)(most, term.max_passes());
      });
      if (any) system.eliminate_pinned_rows();
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
      for_each([&](PiecewiseTerm& term) { term.end_passes(passes, settled); });
      return total;
    }

    void update() {
      for_each([&](PiecewiseTerm& term) { term.update(system); });
      system.eliminate_pinned_rows();
    }

    [[nodiscard]] bool is_alive() const {
      return total.status != SolveStatus::breakdown && total.status != SolveStatus::invalid_options;
    }

    void solve(double looseness) {
      const SolveReport report = system.solve(looseness, couples ? this : nullptr);
      total.iterations += report.iterations;
      total.residual = report.residual;
      total.status = report.status;
      for_each([&](PiecewiseTerm& term) { term.solved(system); });
    }

    [[nodiscard]] bool revise() {
      const double error = total.residual * detail::square_root((std::max)(0.0, dot(system.right_side, system.change)));
      bool changed = false;
      for_each([&](PiecewiseTerm& term) { changed = term.revise(system, error) || changed; });
      return changed;
    }

    void pass(double looseness) {
      update();
      for (std::size_t i = 0; i < system.from.size(); ++i) system.from[i] = system.change[i];
      solve(looseness);
      if (!is_alive()) return;
      const double fraction = search();
      for_each([&](PiecewiseTerm& term) { term.end_search(fraction); });
      if (!(fraction < 1)) return;
      for (std::size_t i = 0; i < system.from.size(); ++i)
        system.change[i] = system.from[i] + static_cast<Scalar>(fraction) * (system.change[i] - system.from[i]);
    }

    /// The fraction of the way that leads to the lowest point of the convex function on it.
    [[nodiscard]] double search() {
      double slope = 0, curvature = 0;
      for (Index i = 0; i < size_of(system.from); ++i)
        system.product[at(i)] = system.change[at(i)] - system.from[at(i)];
      for (Index i = 0; i < size_of(system.from); ++i) {
        Vec3<Scalar> row;
        system.matrix.row_product(i, system.product).template store_part<3>(row.data());
        const Vec3<double> a = row.template cast<double>(), along = system.product[at(i)].template cast<double>();
        curvature += along.dot(a);
        slope += system.from[at(i)].template cast<double>().dot(a) -
                 along.dot(system.right_side[at(i)].template cast<double>());
      }
      for_each([&](PiecewiseTerm& term) { term.begin_search(system, slope, curvature); });
      const auto derivative = [&](double fraction) {
        double sum = slope + fraction * curvature;
        for_each([&](PiecewiseTerm& term) { sum += term.slope_at(fraction); });
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

    [[nodiscard]] static double dot(const Field<Scalar>& a, const Field<Scalar>& b) {
      double sum = 0;
      for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].template cast<double>().dot(b[i].template cast<double>());
      return sum;
    }
  };
};

}  // namespace corotet::inline v0_1
