// Backward Euler: the default integrator. First order, damps all motion, never grows.
#pragma once

#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/dynamics/integrator.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/time_scheme.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <corotet/detail/solve/solver.hpp>

namespace corotet::inline v0_1 {

/// The integrator of first order, backward Euler: stable at any step, it damps all motion.
///
/// Use it by default, above all for games. Use Bdf2 where motion must not be damped, SubsteppingIntegrator around
/// either where steps may fail, and `solve_static` where only the rest configuration matters.
/// @snippet steps.cpp euler
/// It solves v' = v + h M^-1 (f_ext + f_el(x') - D v'), x' = x + h v'. With one solve a step, the default, that is
/// (M + h D + h^2 K) dv = h (f_ext + f_el(x) - D v) - h^2 K v, then v += dv, x += h v. K is evaluated at the start of
/// the step: the warped stiffness K' (Müller & Gross 2004, section 3.4; Baraff & Witkin 1998, eq. 6) and what
/// StepOptions::tangent adds to it. D = a M + b K'. A body without pins is solved in a frame that turns with it.
/// Pieces of the body that do not touch move as each does alone.
///
/// The integrator owns all that a step needs besides the body: make it once for a body, then `step` allocates nothing.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class ImplicitEuler {
 public:
  using Scalar = typename Body::scalar_type;                                           ///< of the body
  using Implementation = Integrator<Body, detail::BackwardEulerScheme<Body>, Solver>;  ///< what it is made of

  /// Symbolic work and memory for `body` and its copies.
  explicit ImplicitEuler(const Body& body, const Solver& solver = Solver(), const StepOptions& newton = {});
  /// The same with the options of the solver alone.
  ImplicitEuler(const Body& body, const typename Solver::Options& options, const StepOptions& newton = {})
      : ImplicitEuler(body, Solver(options), newton) {}

  /// The linear solver, with its options.
  [[nodiscard]] const Solver& solver() const { return implementation_.solver(); }
  /// The options of the step's equation.
  [[nodiscard]] const StepOptions& newton() const { return implementation_.newton(); }

  /// Advances `body` by `h` seconds. Whatever happens is in the report; a refused step leaves the body untouched.
  /// `observer` is told of each phase as it begins.
  StepReport step(Body& body, Scalar h, ExecutorRef executor = {}, PhaseObserver observer = {}) {
    return step(body, h, StepContext<Scalar>{executor, observer, {}, {}});
  }
  /// The same with terms that act on the body besides its own. The first step with some allocates memory for them.
  StepReport step(Body& body, Scalar h, const StepContext<Scalar>& context);

  /// Bytes that the integrator takes besides the body, and those that it shares with its copies.
  [[nodiscard]] COROTET_COLD MemoryUse memory() const { return implementation_.memory(); }

  /// Forgets all earlier steps, as if it had just been made for the body. Allocates.
  COROTET_COLD void reset(const Body& body) { implementation_.reset(body); }

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive, const Body& body) {
    implementation_.visit_state(archive, body);
  }

  /// For integrators around this one: see Integrator::step_pieces.
  [[nodiscard]] Implementation& implementation() { return implementation_; }

 private:
  Implementation implementation_;
};

template <class Body>
ImplicitEuler(const Body&) -> ImplicitEuler<Body>;

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
ImplicitEuler<Body, Solver>::ImplicitEuler(const Body& body, const Solver& solver, const StepOptions& newton)
    : implementation_(body, solver, newton) {}

template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
StepReport ImplicitEuler<Body, Solver>::step(Body& body, Scalar h, const StepContext<Scalar>& context) {
  return implementation_.step(body, h, context);
}

COROTET_INSTANCES_OF_BODY(ImplicitEuler)

}  // namespace corotet::inline v0_1
