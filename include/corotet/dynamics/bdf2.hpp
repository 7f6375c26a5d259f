// The backward differentiation formula of second order.
#pragma once

#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/implicit_step.hpp>
#include <corotet/dynamics/newton_options.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/solver.hpp>
#include <cstdint>
#include <utility>

namespace corotet {

/// v' = vbar + c M^-1 (f_ext + f_el(x') - D v'), x' = xbar + c v'. With steps of equal length c = 2h/3,
/// xbar = (4 x - x_before) / 3 and vbar likewise; in general, with w = h / h_before, c = h (1 + w) / (1 + 2 w) and
/// xbar = x + w^2 / (1 + 2 w) (x - x_before) (Hairer, Nørsett & Wanner 1993, section III.5). Error O(h^2); vibrations
/// much faster than a step are damped within a few steps, as by backward Euler (L-stable), slow ones hardly.
///
/// The force is linearised where the body would be after the step at its present velocity, and pins at their targets:
/// with one solve a step the error stays O(h^2) although the warped stiffness is not the exact tangent.
///
/// A step that does not continue the last one is of backward Euler: the first, one after the caller set displacements
/// or velocities, and one that is more than twice as long as the step before (zero-stability ends at 1 + sqrt 2).
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class Bdf2 {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory for `body` and its copies.
  explicit Bdf2(const Body& body, Solver solver = Solver(), const NewtonOptions& newton = {})
      : implicit_(body, std::move(solver), newton, true),
        last_position_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        last_velocity_(last_position_),
        position_(last_position_),
        velocity_(last_position_) {}
  Bdf2(const Body& body, const typename Solver::Options& options, const NewtonOptions& newton = {})
      : Bdf2(body, Solver(options), newton) {}

  [[nodiscard]] const Solver& solver() const { return implicit_.solver(); }
  [[nodiscard]] const NewtonOptions& newton() const { return implicit_.options(); }

  /// Advances `body` by `h` seconds. Whatever happens is in the report; a refused step leaves the body untouched.
  /// `observer` is told of each phase as it begins.
  template <Executor E, StepObserver O = IgnorePhases>
  StepReport step(Body& body, Scalar h, E& executor, O&& observer = O()) {
    StepReport report = implicit_.check(body, h);
    if (!report.accepted()) return report;
    if (continues(body, h)) {
      const Scalar w = h / last_h_, lead = w * w / (1 + 2 * w);
      flat(position_) = flat(body.displacements()) + lead * (flat(body.displacements()) - flat(last_position_));
      flat(velocity_) = flat(body.velocities()) + lead * (flat(body.velocities()) - flat(last_velocity_));
      report = implicit_.advance(
          body, {.c = h * (1 + w) / (1 + 2 * w), .position = position_, .velocity = velocity_, .ahead = h}, executor,
          observer);
    } else {
      report = implicit_.advance(body, {.c = h, .position = body.displacements(), .velocity = body.velocities()},
                                 executor, observer);
    }
    if (!report.accepted()) return report;
    implicit_.swap_previous_state(last_position_, last_velocity_);
    last_h_ = h;
    motion_ = body.motion_revision();
    return report;
  }
  StepReport step(Body& body, Scalar h) {
    SerialExecutor serial;
    return step(body, h, serial);
  }

 private:
  [[nodiscard]] bool continues(const Body& body, Scalar h) const {
    return motion_ == body.motion_revision() && h <= 2 * last_h_;
  }

  ImplicitStep<Body, Solver> implicit_;
  Field<Scalar> last_position_, last_velocity_;  // before the last step
  Field<Scalar> position_, velocity_;            // xbar, vbar
  Scalar last_h_ = 0;
  std::uint64_t motion_ = 0;  // of the state after the last step; no body has 0
};

}  // namespace corotet
