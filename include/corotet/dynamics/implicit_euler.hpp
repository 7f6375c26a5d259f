// Backward Euler: the default integrator. First order, damps all motion, never grows.
#pragma once

#include <corotet/core/executor.hpp>
#include <corotet/core/instances.hpp>
#include <corotet/dynamics/implicit_step.hpp>
#include <corotet/dynamics/newton_options.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/solver.hpp>
#include <utility>

namespace corotet::inline v0_1 {

/// v' = v + h M^-1 (f_ext + f_el(x') - D v'), x' = x + h v'. With one solve a step, the default, that is
/// (M + h D + h^2 K) dv = h (f_ext + f_el(x) - D v) - h^2 K v, then v += dv, x += h v, with K at the start of the step:
/// the warped stiffness K' (Müller & Gross 2004, section 3.4; Baraff & Witkin 1998, eq. 6) and what NewtonOptions'
/// tangent adds to it, and D = a M + b K'. A body without pins is solved for in a frame that turns with it: see
/// TurningFrame.
///
/// The integrator owns all that a step needs besides the body: make it once for a body, then `step` allocates nothing.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class ImplicitEuler {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory for `body` and its copies.
  explicit ImplicitEuler(const Body& body, Solver solver = Solver(), const NewtonOptions& newton = {});
  ImplicitEuler(const Body& body, const typename Solver::Options& options, const NewtonOptions& newton = {})
      : ImplicitEuler(body, Solver(options), newton) {}

  [[nodiscard]] const Solver& solver() const { return implicit_.solver(); }
  [[nodiscard]] const NewtonOptions& newton() const { return implicit_.options(); }

  /// Advances `body` by `h` seconds. Whatever happens is in the report; a refused step leaves the body untouched.
  /// `observer` is told of each phase as it begins.
  StepReport step(Body& body, Scalar h, ExecutorRef executor = {}, PhaseObserver observer = {});

 private:
  ImplicitStep<Body, Solver> implicit_;
};

template <class Body>
ImplicitEuler(const Body&) -> ImplicitEuler<Body>;

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
ImplicitEuler<Body, Solver>::ImplicitEuler(const Body& body, Solver solver, const NewtonOptions& newton)
    : implicit_(body, std::move(solver), newton) {}

template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
StepReport ImplicitEuler<Body, Solver>::step(Body& body, Scalar h, ExecutorRef executor, PhaseObserver observer) {
  const StepReport checked = implicit_.validate(body, h);
  if (!checked.accepted()) return checked;
  return implicit_.advance(body, backward_euler(body, h), executor, observer);
}

COROTET_INSTANCES_OF_BODY(ImplicitEuler)

}  // namespace corotet::inline v0_1
