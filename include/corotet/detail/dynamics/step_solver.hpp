// The implicit solve that all integrators share.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/contraction.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/span_of.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/energy_bound.hpp>
#include <corotet/detail/dynamics/linearized_step.hpp>
#include <corotet/detail/dynamics/newton.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/step_check.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/dynamics/turning_frame.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/prepared_preconditioner.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <optional>

namespace corotet::inline v0_1::detail {

/// Solves a TimeStep, by one linear solve or by Newton's method, and moves the body. Owns all that a step needs besides
/// the body: made once for a body and its copies, then `advance` allocates nothing.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
class StepSolver {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory.
  COROTET_COLD StepSolver(const Body& body, const Solver& solver, const StepOptions& newton)
      : options_(newton),
        solver_(detail::unanalyzed(solver)),
        equation_(body, newton.tangent),
        change_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        velocity_(change_),
        displacement_(change_),
        frame_velocity_(change_),
        sum_(body.vertex_count()),
        frame_(body.vertex_count()),
        energy_bound_(body) {
    detail::expect_deterministic();
    solver_.analyze(body.pattern(), body.mesh().positions());
  }

  [[nodiscard]] const Solver& solver() const { return solver_; }
  [[nodiscard]] const StepOptions& options() const { return options_; }

  /// See check_step. The body must be the one that this was made for, or a copy.
  [[nodiscard]] StepReport validate(const Body& body, Scalar h) const {
    COROTET_ASSERT(body.pattern() == equation_.matrix().shared_pattern(), "this integrator was made for another body");
    return check_step(body, h, options_);
  }

  /// Before a step of h seconds. Returns whether it must be of backward Euler.
  [[nodiscard]] bool begin(Body& body, Scalar h, const StepContext<Scalar>& context) {
    equation_.terms().begin(body.terms(), context.terms, context.piece);
    return !context.terms.empty() && begin_terms(body, h, context);
  }

  /// Moves the body as `step` says; a refused step leaves it untouched. The step's fields may be the body's.
  COROTET_COLD StepReport advance(Body& body, const TimeStep<Scalar>& step, const StepContext<Scalar>& context) {
    const StepReport report = advance_bounded(body, step, context);
    if (report.accepted()) equation_.commit(body);
    if (!context.terms.empty() && report.accepted()) end_terms(body, step, context);
    return report;
  }

  /// After an accepted step: the state that the body had before it. A scheme may exchange the buffers for its own.
  [[nodiscard]] Field<Scalar>& previous_displacement() { return displacement_; }
  [[nodiscard]] Field<Scalar>& previous_velocity() { return velocity_; }

  /// After an accepted step: the forces on the components of vertices that are not pinned, elastic and of all terms but
  /// damping, squared and summed, N^2.
  [[nodiscard]] COROTET_COLD double unbalanced_force2(const Body& body) const {
    double sum = 0;
    for (Index v = 0; v < body.vertex_count(); ++v) {
      const PinnedAxes pinned = body.pins().axes_of(v);
      const Vec3<Scalar> force = equation_.force(body, v);
      for (int i = 0; i < 3; ++i)
        if (!pinned[i]) sum += double(force[i]) * double(force[i]);
    }
    return sum;
  }

  /// Of a solver that does not tell its own: without it.
  [[nodiscard]] COROTET_COLD MemoryUse memory() const {
    MemoryUse use = equation_.memory() + frame_.memory() + energy_bound_.memory() + sum_.memory();
    for (const Field<Scalar>* field : {&change_, &velocity_, &displacement_, &frame_velocity_})
      use.owned += bytes_of(*field);
    if constexpr (requires { solver_.memory(); }) use += solver_.memory();
    return use;
  }

  /// For snapshots: what earlier steps have left that later ones depend on.
  COROTET_COLD void visit_state(detail::StateArchive& archive, const Body& body) {
    equation_.visit_state(archive, body);
    energy_bound_.visit_state(archive, body);
    if constexpr (requires { solver_.visit_state(archive); }) solver_.visit_state(archive);
  }

  /// As if it had just been made for the body.
  COROTET_COLD void reset(const Body& body) { *this = StepSolver(body, solver_, options_); }

 private:
  [[nodiscard]] COROTET_COLD bool begin_terms(const Body& body, Scalar h, const StepContext<Scalar>& context) {
    equation_.terms().set_frame({});
    equation_.terms().begin_step(
        equation_.state(body, backward_euler(body, h), body.displacements(), body.velocities(), context.executor));
    return equation_.terms().needs_first_order();
  }
  COROTET_COLD void end_terms(const Body& body, const TimeStep<Scalar>& step, const StepContext<Scalar>& context) {
    equation_.terms().set_frame({});
    equation_.terms().end_step(equation_.state(body, step, body.displacements(), body.velocities(), context.executor));
  }

  /// A step, again where it has gained energy: by Newton's method, one of second order by backward Euler.
  COROTET_COLD StepReport advance_bounded(Body& body, const TimeStep<Scalar>& step,
                                          const StepContext<Scalar>& context) {
    const StepReport report = solve_step(body, step, options_.iterations, context);
    if (!bounds_energy(options_.iterations) || !report.accepted() ||
        !energy_bound_.exceeds(body, step, displacement_, velocity_, equation_, context.executor))
      return report;
    body.swap_state(displacement_, velocity_);  // as it was
    StepReport again;
    if (step.is_first_order()) {
      constexpr int max_iterations = 8;  // it gains nothing long before it has converged
      again = solve_step(body, step, max_iterations, context);
    } else {
      again = advance_bounded(body, backward_euler(body, step.h), context);
    }
    if (!again.accepted()) return solve_step(body, step, options_.iterations, context);
    again.iterations += report.iterations;
    again.newton_iterations += report.newton_iterations;
    return again;
  }

  /// One step of at most `max_iterations` linear solves: Müller & Gross 2004, section 3.4, with what keeps a free
  /// body's momenta.
  COROTET_COLD StepReport solve_step(Body& body, const TimeStep<Scalar>& wanted, int max_iterations,
                                     const StepContext<Scalar>& context) {
    const ExecutorRef executor = context.executor;
    context.observer(StepPhase::assembly);
    const bool free = options_.keeps_angular_momentum && body.pins().vertices().empty();
    const bool turns = free && wanted.is_first_order();
    if (free) frame_.begin(body, wanted, equation_.terms().damping().mass, executor);
    if (turns) frame_.enter(body, wanted.h, frame_velocity_, executor);  // Coriolis and centrifugal forces
    equation_.terms().set_frame(turns ? frame_.placement() : TurningPlacement<Scalar>());
    TimeStep<Scalar> step = wanted;
    const TimeStep<Scalar> in_frame{
        .gamma = step.gamma, .x_history = step.x_history, .v_history = frame_velocity_, .h = step.h};
    return solve_in_frame(body, turns ? in_frame : step, free, max_iterations, context);
  }

  COROTET_COLD StepReport solve_in_frame(Body& body, const TimeStep<Scalar>& step, bool free, int max_iterations,
                                         const StepContext<Scalar>& context) {
    const ExecutorRef executor = context.executor;
    StepReport report;
    Problem problem{*this, body, step, context, report, max_iterations > 1};
    const bool bounded = bounds_energy(max_iterations);

    equation_.project_twist(false);
    equation_.prepare(body, step.gamma);
    problem.predict();  // where the force is linearised first
    if (bounded)
      energy_bound_.begin(body, equation_, step.is_first_order(), problem.energy_of_terms(body.displacements()),
                          executor);

    // A dv = M (v_history - v) + gamma (f_ext + f_el(x) - D v), v += dv, x = x_history + gamma v, once or until
    // converged.
    const NewtonResult solved = newton_solve(problem, max_iterations, options_.tolerance, Body::Law::is_conservative);
    report.solve = solved.solve;
    report.newton_iterations = solved.iterations;
    report.newton_converged = solved.converged;
    report.newton_residual = solved.residual;
    report.converged = solved.all_solved;
    if (solved.solve == SolveStatus::breakdown) return refused(report, StepError::solver_breakdown);
    if (solved.solve == SolveStatus::invalid_options) return refused(report, StepError::solver_options);
    if (!solved.finite) return refused(report, StepError::overflow);
    problem.balance_momentum();

    const auto weigh = [&](const Field<Scalar>& velocity_before) {
      if (bounded)
        energy_bound_.solved(body, equation_, step.gamma, velocity_before, displacement_, velocity_,
                             problem.energy_of_terms(displacement_), executor);
    };
    if (step.is_first_order()) weigh(step.v_history);  // in the frame in which it was solved
    if (free && !(step.order > 1 && equation_.terms().is_implicit()) &&
        !frame_.leave(body, step.gamma, equation_.terms(), problem.state(), displacement_, velocity_, executor))
      return refused(report, StepError::overflow);
    if (!step.is_first_order()) limit_pin_velocities(body, step);
    if (!step.is_first_order()) weigh(body.velocities());  // with what the projection of momenta gives

    body.swap_state(displacement_, velocity_);
    if (problem.iterates && !problem.projected && !free) equation_.mark_evaluated(body);
    equation_.project_twist(false);
    equation_.evaluate(body, executor);  // from which the next step starts
    const DeformationExtremes worst = equation_.summary();
    report.inverted_elements = worst.inverted_elements;
    report.max_rotation = worst.max_rotation();
    report.max_strain = worst.max_strain();
    return report;
  }

  /// The incremental energy of a step, |x - xtilde|^2_M / 2 gamma^2 + W(x) - f_ext . x + D's part + terms, as a
  /// NewtonProblem in the new velocities (Radovitzky & Ortiz 1999; Gast et al. 2015).
  struct Problem {
    StepSolver& s;
    Body& body;
    const TimeStep<Scalar>& step;
    const StepContext<Scalar>& context;
    StepReport& report;
    bool iterates;
    bool projected = false;
    bool at_rest = true;                    // linearised where v_k = 0
    bool is_partial = false;                // the last change was taken in part, for which momentum is not balanced
    double elastic = 0, rounding_of_x = 0;  // J, sqrt(J)

    /// Evaluates where the force is linearised first. velocity_: a guess, from which the first solve finds the change:
    /// v_history with the pins' velocities put in, or where the force is linearised ahead, that state's.
    COROTET_COLD void predict() {
      at_rest = step.is_first_order();
      if (at_rest) {
        for_ranges(context.executor, body.vertex_count(), DeterministicSum::grain, [&](Index begin, Index end) {
          for (Index i = begin; i < end; ++i) s.velocity_[at(i)] = step.v_history[at(i)];
        });
        body.pins().for_each_component(
            [&](std::size_t p, Index v, int i) { s.velocity_[at(v)][i] = pin_velocity(p, v, i); });
        s.equation_.evaluate(body, context.executor);
      } else {
        for_ranges(context.executor, body.vertex_count(), DeterministicSum::grain, [&](Index begin, Index end) {
          for (Index i = begin; i < end; ++i) {
            s.displacement_[at(i)] = body.displacements()[at(i)] + step.linearization_time * body.velocities()[at(i)];
            s.velocity_[at(i)] = (s.displacement_[at(i)] - step.x_history[at(i)]) / step.gamma;
          }
        });
        s.equation_.evaluate(body, s.displacement_, context.executor);
      }
      s.equation_.terms().evaluate(state());
    }

    void linearize(bool first) {
      if (!first) context.observer(StepPhase::assembly);
      s.equation_.assemble_matrix(body, step.gamma, first, iterates || !step.is_first_order(), context.executor);
      s.equation_.add_terms_to_matrix(state(), at_rest);
      if (first) build_first_right_side();
      s.equation_.eliminate_pinned_rows(body);
    }

    [[nodiscard]] SolveStatus solve() {
      context.observer(StepPhase::solve);
      const SolveReport solved = s.equation_.terms().has_piecewise()
                                     ? solve_in_passes()
                                     : s.solver_.solve(system(1, nullptr), s.change_, context.executor);
      find_impulses();
      if (body.pins().vertices().empty())
        s.equation_.project_linear_momentum(body, step, s.velocity_, s.change_, context.executor);
      report.iterations += solved.iterations;
      report.residual = (std::max)(report.residual, solved.residual);
      context.observer(StepPhase::update);
      return solved.status;
    }

    [[nodiscard]] double decrement2() { return s.equation_.right_side_dot(s.change_, context.executor); }
    [[nodiscard]] double gradient_norm() { return s.equation_.right_side_norm(context.executor); }

    /// Tangent::consistent: leaves out what is negative of it for the rest of the step.
    [[nodiscard]] bool project_tangent(bool first) {
      if (s.options_.tangent != Tangent::consistent || projected) return false;
      context.observer(StepPhase::assembly);
      projected = true;
      s.equation_.project_twist(true);
      if (first)
        predict();
      else
        s.equation_.evaluate(body, s.displacement_, context.executor);
      return true;
    }

    [[nodiscard]] double rounding() const { return rounding_of_x; }
    [[nodiscard]] double noise() const { return s.energy_bound_.noise(elastic, rounding_of_x); }

    /// The fraction of the change that lowers the energy. `elastic` is that of body and terms, before and after. What
    /// is quadratic in v is taken as a difference: what grows with velocity and with the distance from rest cancels
    /// without rounding.
    [[nodiscard]] COROTET_COLD double search(double decrement2, double noise) {
      const auto along = s.equation_.directional_terms(body, step.gamma, s.change_, context.executor);
      const double before = elastic, slope = along.slope - decrement2;
      return backtrack(-decrement2, noise, [&](double fraction) {
        s.try_increment(body, step, static_cast<Scalar>(fraction), context.executor);
        elastic = energy_at(s.displacement_);
        return fraction * (slope + fraction * along.curvature / 2) + elastic - before;
      });
    }

    [[nodiscard]] bool apply(double fraction) {
      if (s.equation_.terms().has_given()) fraction = apply_to_terms(fraction);
      return s.apply_increment(body, step, static_cast<Scalar>(fraction), context.executor);
    }

    void evaluate() {
      if (report.newton_iterations == 0) {
        rounding_of_x = s.equation_.position_rounding(body, step.gamma, context.executor);
        elastic = energy_at(s.displacement_);
      }
      ++report.newton_iterations;
      at_rest = false;
      s.equation_.evaluate(body, s.displacement_, context.executor);
      s.equation_.terms().evaluate(state());
      s.equation_.linearize_here(body, step, s.velocity_, context.executor);
    }

    [[nodiscard]] double energy_at(const Field<Scalar>& displacement) {
      return s.energy_bound_.elastic(body, displacement, context.executor) + energy_of_terms(displacement);
    }
    [[nodiscard]] double energy_of_terms(const Field<Scalar>& displacement) {
      return s.equation_.terms().has_given() ? energy_of_given(displacement) : 0;
    }

    /// After the last change: where contact was solved for and the change was taken in part, momentum is what impulses
    /// have given. The body stays where its contacts are.
    COROTET_COLD void balance_momentum() {
      if (!is_partial || !s.equation_.terms().has_piecewise() || !body.pins().vertices().empty()) return;
      for (Vec3<Scalar>& d : s.change_) d.setZero();
      s.equation_.project_linear_momentum(body, step, s.velocity_, s.change_, context.executor);
      for (Index i = 0; i < body.vertex_count(); ++i) s.velocity_[at(i)] += s.change_[at(i)];
    }

    /// Where forces are linearised now.
    [[nodiscard]] TermState<Scalar> state() const {
      return s.equation_.state(body, step, at_rest ? body.displacements() : s.displacement_, s.velocity_,
                               context.executor);
    }

   private:
    /// The system of this linearisation, as terms change it between solves.
    struct Passes final : PassSystem<Scalar> {
      Problem& p;

      Passes(Problem& problem, const TermState<Scalar>& here)
          : PassSystem<Scalar>(here, problem.s.equation_.matrix_of_terms(), problem.s.equation_.right_side_of_terms(),
                               problem.s.change_, problem.at_rest ? &problem.s.velocity_ : nullptr,
                               problem.s.equation_.terms().scratch(), problem.s.equation_.terms().product()),
            p(problem) {}
      [[nodiscard]] SolveReport solve(double looseness, const MatrixFreeTerm<Scalar>* coupling) override {
        return p.s.solver_.solve(p.system(looseness, coupling), this->change, p.context.executor);
      }
      void eliminate_pinned_rows() override { p.s.equation_.eliminate_pinned_rows(p.body); }
      void clear_pinned(PaddedField<Scalar>& field) const override {
        p.body.pins().for_each_component([&](std::size_t, Index v, int i) { field[at(v)][at(i)] = 0; });
      }
      [[nodiscard]] std::optional<PreparedPreconditioner<Scalar>> prepare() override {
        return detail::prepare<Scalar>(p.s.solver_, p.system(1, nullptr), p.context.executor);
      }
    };

    [[nodiscard]] StepSystem<Scalar> system(double looseness, const MatrixFreeTerm<Scalar>* coupling) const {
      return {s.equation_.matrix(),
              s.equation_.right_side(),
              body.displacements(),
              span_of(body.pins().vertices()),
              s.equation_.lag_key(),
              coupling,
              looseness};
    }

    [[nodiscard]] COROTET_COLD SolveReport solve_in_passes() {
      const TermState<Scalar> here = s.equation_.terms().seen_by_given(state());
      Passes passes(*this, here);
      return s.equation_.terms().solve_in_passes(passes);
    }

    [[nodiscard]] COROTET_COLD double energy_of_given(const Field<Scalar>& displacement) {
      return s.equation_.terms().energy(s.equation_.state(body, step, displacement, s.velocity_, context.executor));
    }

    void find_impulses() {
      if (!s.equation_.terms().has_given()) return;
      s.equation_.terms().find_impulses(state(), s.change_, at_rest ? &s.velocity_ : nullptr);
    }

    /// Puts the pins' velocities into velocity_, if they are not there. A pin that jumps so pulls at the body as in
    /// linear elasticity, and where the force is linearised nothing is torn.
    COROTET_COLD void build_first_right_side() {
      if (at_rest) return s.equation_.linearize_at_rest(body, step, s.velocity_, context.executor);
      s.equation_.linearize_here(body, step, s.velocity_, context.executor);
      body.pins().for_each_component([&](std::size_t p, Index v, int i) {
        Vec3<Scalar> change = Vec3<Scalar>::Zero();
        change[i] = pin_velocity(p, v, i) - s.velocity_[at(v)][i];
        s.equation_.prescribe(v, change);
        s.velocity_[at(v)][i] += change[i];
      });
    }

    [[nodiscard]] Scalar pin_velocity(std::size_t slot, Index vertex, int i) const {
      return (body.pins().targets()[slot][i] - step.x_history[at(vertex)][i]) / step.gamma;
    }

    /// Takes a fraction of the change, or less where a term says so. Returns what is then left to take: all.
    COROTET_COLD double apply_to_terms(double fraction) {
      for (Vec3<Scalar>& d : s.change_) d *= static_cast<Scalar>(fraction);
      is_partial = limit_change() || fraction < 1;
      find_impulses();
      return 1;
    }

    /// Shortens the change to what the terms allow of the way from where they are linearised. False if that is all.
    COROTET_COLD bool limit_change() {
      Field<Scalar>& there = s.equation_.terms().scratch();
      for (Index i = 0; i < body.vertex_count(); ++i)
        there[at(i)] = step.x_history[at(i)] + step.gamma * (s.velocity_[at(i)] + s.change_[at(i)]);
      const auto to = s.equation_.state(body, step, there, s.velocity_, context.executor);
      const auto safe = static_cast<Scalar>(s.equation_.terms().max_safe_fraction(state(), to));
      if (!(safe < 1)) return false;
      for (Index i = 0; i < body.vertex_count(); ++i) {
        Vec3<Scalar>& d = s.change_[at(i)];
        d = at_rest ? Vec3<Scalar>(safe * (s.velocity_[at(i)] + d) - s.velocity_[at(i)]) : Vec3<Scalar>(safe * d);
      }
      return true;
    }
  };

  /// Whether the energy after a step of so many solves is compared with that before it.
  [[nodiscard]] bool bounds_energy(int max_iterations) const {
    return options_.bounds_energy && Body::Law::is_conservative && max_iterations == 1;
  }

  /// velocity_ += fraction change_, and displacement_ follows. False if a number is not finite.
  [[nodiscard]] bool apply_increment(const Body& body, const TimeStep<Scalar>& step, Scalar fraction,
                                     ExecutorRef executor) {
    const double not_finite = sum_(executor, [&](Index begin, Index end) {
      bool finite = true;
      for (Index i = begin; i < end; ++i) {
        velocity_[at(i)] += fraction * change_[at(i)];
        displacement_[at(i)] = step.x_history[at(i)] + step.gamma * velocity_[at(i)];
        finite = finite && velocity_[at(i)].allFinite() && displacement_[at(i)].allFinite();
      }
      return finite ? 0.0 : 1.0;
    });
    place_pins(body);
    return detail::is_zero(not_finite);
  }

  /// displacement_ = x_history + gamma (velocity_ + fraction change_).
  COROTET_COLD void try_increment(const Body& body, const TimeStep<Scalar>& step, Scalar fraction,
                                  ExecutorRef executor) {
    for_ranges(executor, body.vertex_count(), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        displacement_[at(i)] = step.x_history[at(i)] + step.gamma * (velocity_[at(i)] + fraction * change_[at(i)]);
    });
    place_pins(body);
  }

  /// Exactly where they go, without rounding of gamma v.
  void place_pins(const Body& body) {
    body.pins().for_each_component(
        [&](std::size_t p, Index v, int i) { displacement_[at(v)][i] = body.pins().targets()[p][i]; });
  }

  /// The velocities with which pinned vertices would leave. A scheme of second order finds them by extrapolation from
  /// the last step, which means something only where a path is smooth: where a pin has just started or stopped, its
  /// mean velocity in the step.
  COROTET_COLD void limit_pin_velocities(const Body& body, const TimeStep<Scalar>& step) {
    const auto& pins = body.pins();
    for (std::size_t p = 0; p < pins.vertices().size(); ++p) {
      const std::size_t v = at(pins.vertices()[p]);
      const Vec3<Scalar> mean = (displacement_[v] - body.displacements()[v]) / step.h;
      const Vec3<Scalar> extrapolated = velocity_[v] - mean;  // half the change from the mean of the last step
      const Scalar speed = (std::min)(mean.norm(), (mean - 2 * extrapolated).norm());
      const Scalar change = 2 * extrapolated.norm();
      const Scalar share = speed > 0 ? std::clamp(2 - 2 * change / speed, Scalar(0), Scalar(1)) : Scalar(0);
      for (int i = 0; i < 3; ++i)
        if (pins.axes()[p][i]) velocity_[v][i] = mean[i] + share * extrapolated[i];
    }
  }

  StepOptions options_;
  Solver solver_;
  LinearizedStep<Body> equation_;
  Field<Scalar> change_, velocity_, displacement_, frame_velocity_;
  DeterministicSum sum_;
  TurningFrame<Body> frame_;
  EnergyBound<Body> energy_bound_;
};

}  // namespace corotet::inline v0_1::detail
