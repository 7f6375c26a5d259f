// The implicit solve that all integrators share.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/core/assert.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/contraction.hpp>
#include <corotet/core/exactly.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/energy_balance.hpp>
#include <corotet/dynamics/line_search.hpp>
#include <corotet/dynamics/newton_options.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_check.hpp>
#include <corotet/dynamics/step_equation.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/dynamics/turning_frame.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/solver.hpp>
#include <utility>

namespace corotet::inline v0_1 {

/// Solves a StepFormula, by one linear solve or by Newton's method, and moves the body. Owns all that a step needs
/// besides the body: made once for a body and its copies, then `advance` allocates nothing.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
class ImplicitStep {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory.
  COROTET_COLD ImplicitStep(const Body& body, Solver solver, const NewtonOptions& newton)
      : options_(newton),
        solver_(std::move(solver)),
        equation_(body, newton.tangent),
        change_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        velocity_(change_),
        displacement_(change_),
        seen_velocity_(change_),
        sum_(body.vertex_count()),
        frame_(body.vertex_count()),
        balance_(body) {
    detail::expect_deterministic();
    solver_.analyze(body.pattern(), body.mesh().positions());
  }

  [[nodiscard]] const Solver& solver() const { return solver_; }
  [[nodiscard]] const NewtonOptions& options() const { return options_; }

  /// See check_step. The body must be the one that this was made for, or a copy.
  [[nodiscard]] StepReport validate(const Body& body, Scalar h) const {
    COROTET_ASSERT(body.pattern() == equation_.matrix().shared_pattern(), "this integrator was made for another body");
    return check_step(body, h, options_);
  }

  /// Moves the body as `formula` says; a refused step leaves it untouched. The formula's fields may be the body's.
  StepReport advance(Body& body, const StepFormula<Scalar>& wanted, ExecutorRef executor, PhaseObserver observer) {
    observer(StepPhase::assembly);
    const bool free = options_.keeps_angular_momentum && body.pins().vertices().empty();
    const bool turning = free && !wanted.ahead;
    if (free)
      enter_frame(body, wanted, executor);
    else
      equation_.leave_forces();
    const StepFormula<Scalar> formula{wanted.c, wanted.position, turning ? seen_velocity_ : wanted.velocity, wanted.h,
                                      wanted.ahead};
    const StepReport report = attempt(body, formula, options_.iterations, free, executor, observer);
    if (!balances(options_.iterations) || !report.accepted() ||
        !balance_.is_upset(body, formula, displacement_, velocity_, equation_, executor))
      return report;
    body.swap_state(displacement_, velocity_);  // as it was
    StepReport again;
    if (formula.ahead) {
      again = advance(body, backward_euler(body, formula.h), executor, observer);
    } else {
      observer(StepPhase::assembly);
      again = attempt(body, formula, 8, free, executor, observer);  // gains nothing long before it has converged
    }
    if (!again.accepted()) {  // what there was is better than nothing
      if (free) enter_frame(body, wanted, executor);
      return attempt(body, formula, options_.iterations, free, executor, observer);
    }
    again.iterations += report.iterations;
    again.newton_iterations += report.newton_iterations;
    return again;
  }

  /// After an accepted step: exchanges the state that the body had before it for buffers of the same length.
  void swap_previous_state(Field<Scalar>& displacement, Field<Scalar>& velocity) {
    displacement_.swap(displacement);
    velocity_.swap(velocity);
  }

 private:
  /// One step of `most` linear solves at most.
  StepReport attempt(Body& body, const StepFormula<Scalar>& formula, int most, bool free, ExecutorRef executor,
                     PhaseObserver observer) {
    StepReport report;
    const bool newton = most > 1;
    equation_.project_twist(false);
    equation_.prepare(body, formula.c);
    start(body, formula, executor);
    if (balances(most)) balance_.begin(body, equation_, !formula.ahead);
    bool projected = false;
    double first_change = 0, last_decrement2 = 0, energy = 0, rounding = 0;
    for (bool done = false; !done;) {
      const bool first = report.newton_iterations == 0;
      equation_.build_matrix(body, formula.c, first, newton || formula.ahead, executor);
      if (first) build_first_right_side(body, formula, executor);
      equation_.isolate_pins(body);

      observer(StepPhase::solve);
      const SolveStatus status = solve(body, formula, report, executor);
      const double decrement2 = newton ? equation_.right_side_dot(change_, executor) : 0;  // g . A^-1 g
      if ((status == SolveStatus::breakdown || decrement2 < 0) && options_.tangent == Tangent::exact && !projected) {
        observer(StepPhase::assembly);
        projected = true;
        equation_.project_twist(true);
        if (first)
          start(body, formula, executor);
        else
          equation_.evaluate(body, displacement_, executor);
        continue;
      }
      if (status != SolveStatus::converged && report.solve != SolveStatus::iteration_limit) report.solve = status;
      if (status == SolveStatus::breakdown) return refused(report, Refusal::solver_breakdown);
      if (status == SolveStatus::invalid_options) return refused(report, Refusal::solver_options);
      ++report.newton_iterations;
      report.converged = report.converged && status == SolveStatus::converged;

      observer(StepPhase::update);
      const double gradient = newton ? equation_.right_side_norm(executor) : 0;
      double fraction = 1;
      bool rounding_hides = false;
      if (newton && first) {
        first_change = std::sqrt(decrement2);
        rounding = equation_.position_rounding(body, formula.c, executor);
      }
      if (newton && !first && Body::Law::is_conservative) {  // the first guess may not have the pins where they go
        const double noise = balance_.noise(energy, rounding);
        rounding_hides =
            decrement2 <= rounding * rounding || (decrement2 <= noise && decrement2 > 0.8 * last_decrement2);
        fraction = search_line(body, formula, decrement2, noise, energy, executor);
      }
      if (!move(body, formula, static_cast<Scalar>(fraction), executor)) return refused(report, Refusal::overflow);
      if (!newton) break;

      if (first) energy = balance_.elastic(body, displacement_);
      equation_.evaluate(body, displacement_, executor);
      equation_.linearise_here(body, formula, velocity_, executor);
      // What a correction of this size leaves if the error has shrunk as the gradient has.
      const double shrunk = gradient > 0 ? (std::min)(1.0, equation_.right_side_norm(executor) / gradient) : 0.0;
      const double left = std::sqrt(decrement2) * shrunk;
      report.newton_residual = first_change > 0 ? left / first_change : 0;
      report.newton_converged =
          detail::exactly_equal(fraction, 1.0) && (left <= options_.tolerance * first_change || rounding_hides);
      last_decrement2 = decrement2;
      done = report.newton_converged || detail::is_zero(fraction) || report.newton_iterations >= most;
      if (!done) observer(StepPhase::assembly);
    }

    const auto weigh = [&](const Field<Scalar>& before) {
      if (balances(most)) balance_.solved(body, equation_, before, displacement_, velocity_, executor);
    };
    if (!formula.ahead) weigh(formula.velocity);  // in the frame in which it was solved
    if (free && !frame_.leave(body, formula.c, displacement_, velocity_, executor))
      return refused(report, Refusal::overflow);
    if (formula.ahead) weigh(body.velocities());  // with what the projection of momenta gives
    body.swap_state(displacement_, velocity_);
    if (newton && !projected && !free) equation_.adopt(body);
    equation_.project_twist(false);
    equation_.evaluate(body, executor);
    const DeformationExtremes worst = equation_.worst();
    report.inverted_elements = worst.inverted_elements;
    report.largest_rotation = worst.largest_rotation();
    report.largest_strain = worst.largest_strain();
    return report;
  }

  /// Of a body without pins; one of second order is solved where it is.
  void enter_frame(const Body& body, const StepFormula<Scalar>& formula, ExecutorRef executor) {
    frame_.begin(body, formula.h, formula.ahead.has_value(), executor);
    if (formula.ahead) return equation_.leave_forces();
    frame_.enter(body, formula.h, seen_velocity_, executor);
    equation_.turn_forces(frame_.space(), frame_.mean_force());
  }

  /// Whether the energy of an attempt with `most` solves is compared with that before it.
  [[nodiscard]] bool balances(int most) const {
    return options_.bounds_energy && Body::Law::is_conservative && most == 1;
  }

  /// Evaluates where the force is linearised first. velocity_: a guess, from which the first solve finds the change:
  /// vbar with the pins' velocities put in, or where the force is linearised ahead, that state's.
  void start(const Body& body, const StepFormula<Scalar>& formula, ExecutorRef executor) {
    if (!formula.ahead) {
      for_ranges(executor, body.vertex_count(), RangeSum::grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) velocity_[at(i)] = formula.velocity[at(i)];
      });
      for (std::size_t p = 0; p < body.pins().vertices().size(); ++p)
        velocity_[at(body.pins().vertices()[p])] = pin_velocity(body, formula, p);
      equation_.evaluate(body, executor);
    } else {
      for_ranges(executor, body.vertex_count(), RangeSum::grain, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
          displacement_[at(i)] = body.displacements()[at(i)] + *formula.ahead * body.velocities()[at(i)];
          velocity_[at(i)] = (displacement_[at(i)] - formula.position[at(i)]) / formula.c;
        }
      });
      equation_.evaluate(body, displacement_, executor);
    }
  }

  /// Puts the pins' velocities into velocity_, if they are not there. A pin that jumps so pulls at the body as in
  /// linear elasticity, and where the force is linearised nothing is torn.
  void build_first_right_side(const Body& body, const StepFormula<Scalar>& formula, ExecutorRef executor) {
    if (!formula.ahead) return equation_.linearise_at_rest(body, formula, velocity_, executor);
    equation_.linearise_here(body, formula, velocity_, executor);
    for (std::size_t p = 0; p < body.pins().vertices().size(); ++p) {
      Vec3<Scalar>& here = velocity_[at(body.pins().vertices()[p])];
      const Vec3<Scalar> change = pin_velocity(body, formula, p) - here;
      equation_.lead(body.pins().vertices()[p], change);
      here += change;
    }
  }

  [[nodiscard]] static Vec3<Scalar> pin_velocity(const Body& body, const StepFormula<Scalar>& formula,
                                                 std::size_t pin) {
    return (body.pins().targets()[pin] - formula.position[at(body.pins().vertices()[pin])]) / formula.c;
  }

  /// velocity_ += fraction change_, and displacement_ follows. False if a number is not finite.
  [[nodiscard]] bool move(const Body& body, const StepFormula<Scalar>& formula, Scalar fraction, ExecutorRef executor) {
    const double not_finite = sum_(executor, [&](Index begin, Index end) {
      bool finite = true;
      for (Index i = begin; i < end; ++i) {
        velocity_[at(i)] += fraction * change_[at(i)];
        displacement_[at(i)] = formula.position[at(i)] + formula.c * velocity_[at(i)];
        finite = finite && velocity_[at(i)].allFinite() && displacement_[at(i)].allFinite();
      }
      return finite ? 0.0 : 1.0;
    });
    place_pins(body);
    return detail::is_zero(not_finite);
  }

  /// displacement_ = xbar + c (velocity_ + fraction change_).
  COROTET_COLD void try_move(const Body& body, const StepFormula<Scalar>& formula, Scalar fraction,
                             ExecutorRef executor) {
    for_ranges(executor, body.vertex_count(), RangeSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        displacement_[at(i)] = formula.position[at(i)] + formula.c * (velocity_[at(i)] + fraction * change_[at(i)]);
    });
    place_pins(body);
  }

  /// Exactly where they go, without rounding of c v.
  void place_pins(const Body& body) {
    for (std::size_t p = 0; p < body.pins().vertices().size(); ++p)
      displacement_[at(body.pins().vertices()[p])] = body.pins().targets()[p];
  }

  [[nodiscard]] SolveStatus solve(const Body& body, const StepFormula<Scalar>& formula, StepReport& report,
                                  ExecutorRef executor) {
    const StepSystem<Scalar> system{equation_.matrix(), equation_.right_side(), body.displacements(),
                                    body.pins().vertices(), equation_.era()};
    const SolveReport solve = solver_.solve(system, change_, executor);
    if (body.pins().vertices().empty()) equation_.settle_momentum(body, formula, velocity_, change_, executor);
    report.iterations += solve.iterations;
    report.residual = (std::max)(report.residual, solve.residual);
    return solve.status;
  }

  /// The fraction of change_ that lowers the incremental energy |x - xtilde|^2_M / 2 c^2 + W(x) - f_ext . x + D's
  /// part; `elastic` is W before and after, J. The terms that are quadratic in v are taken as differences: those that
  /// grow with velocity and with the distance from rest cancel without rounding.
  [[nodiscard]] COROTET_COLD double search_line(const Body& body, const StepFormula<Scalar>& formula, double decrement2,
                                                double noise, double& elastic, ExecutorRef executor) {
    const auto along = equation_.along(body, formula.c, change_, executor);
    const double before = elastic, slope = along.elastic - decrement2;
    return backtrack(-decrement2, noise, [&](double fraction) {
      try_move(body, formula, static_cast<Scalar>(fraction), executor);
      elastic = balance_.elastic(body, displacement_);
      return fraction * (slope + fraction * along.curvature / 2) + elastic - before;
    });
  }

  NewtonOptions options_;
  Solver solver_;
  StepEquation<Body> equation_;
  Field<Scalar> change_, velocity_, displacement_, seen_velocity_;
  RangeSum sum_;
  TurningFrame<Body> frame_;
  EnergyBalance<Body> balance_;
};

}  // namespace corotet::inline v0_1
