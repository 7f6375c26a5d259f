// The shape in which a body rests: static equilibrium under its pins, gravity, forces and terms.
#pragma once

#include <algorithm>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/integrator.hpp>
#include <corotet/detail/dynamics/static_report.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <limits>

namespace corotet::inline v0_1 {

/// When `solve_static` ends.
struct StaticOptions {
  /// Of the forces that are left on the free vertices, relative to those that load the body or were left at the start,
  /// whichever are larger (Euclidean norms), 0 < tolerance < 1. Where rounding does not allow that, above all in float,
  /// the solution ends when corrections no longer shrink.
  double tolerance = 1e-6;
  int max_steps = 200;                         ///< of pseudo-time
  int newton_iterations = 10;                  ///< at most, in each of them
  SolverOptions solver = {.tolerance = 1e-4};  ///< of each step
};

namespace detail {

/// A step from standstill: v' = gamma M^-1 f(x'), x' = x + gamma v'. It lowers the potential energy by the largest
/// amount that |x' - x|^2_M / 2 gamma^2 allows (proximal point algorithm, Rockafellar 1976; pseudo-transient
/// continuation, Kelley & Keyes 1998).
template <class Body>
class StandstillScheme {
 public:
  using Scalar = typename Body::scalar_type;

  COROTET_COLD explicit StandstillScheme(const Body& body) : still_(at(body.vertex_count()), Vec3<Scalar>::Zero()) {}

  [[nodiscard]] TimeStep<Scalar> discretize(const Body& body, Scalar h, ExecutorRef /*executor*/) const {
    return {.gamma = h, .x_history = body.displacements(), .v_history = still_, .h = h};
  }
  void accept(const Body& /*body*/, Scalar /*h*/, const StepReport& /*report*/, Field<Scalar>& /*displacement*/,
              Field<Scalar>& /*velocity*/) const {}

 private:
  Field<Scalar> still_;
};

/// Of gravity and nodal forces together, N.
template <class Body>
[[nodiscard]] COROTET_COLD double load_of(const Body& body) {
  double sum = 0;
  for (Index v = 0; v < body.vertex_count(); ++v)
    sum +=
        (body.external_forces()[at(v)] + body.mass().row_sum(v) * body.gravity()).template cast<double>().squaredNorm();
  return square_root(sum);
}

}  // namespace detail

/// Moves the body to static equilibrium under its pins, gravity, forces and terms, and sets its velocities to zero.
///
/// Use it for a rest configuration before a simulation, or for a static analysis. It is not a step of motion: use
/// ImplicitEuler for that. Each call allocates its memory anew.
/// @snippet steps.cpp static
/// The method is pseudo-transient continuation: steps from standstill that grow tenfold while Newton's method
/// converges, and shrink where it does not. It finds a minimum of the potential energy that lies downhill, not the
/// nearest stationary point. A body that is free to move along some direction converges only if nothing loads it along
/// that.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
COROTET_COLD StaticReport solve_static(Body& body, const StaticOptions& options = {},
                                       const StepContext<typename Body::scalar_type>& context = {}) {
  using Scalar = typename Body::scalar_type;
  Integrator<Body, detail::StandstillScheme<Body>, Solver> integrator(body, Solver(options.solver),
                                                                      {.iterations = options.newton_iterations,
                                                                       .tolerance = (std::min)(1e-3, options.tolerance),
                                                                       .tangent = Tangent::consistent,
                                                                       .keeps_angular_momentum = false,
                                                                       .bounds_energy = false});
  double size2 = 0;
  for (const Vec3<Scalar>& x : body.mesh().positions()) size2 = (std::max)(size2, double(x.squaredNorm()));
  const double epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  // What holds a body that has no pins is its mass: the matrix of longer steps would be singular but for rounding.
  const double shortest = body.wave_transit_time();
  double longest = shortest * (body.pins().vertices().empty() ? 0.25 / detail::square_root(epsilon) : 1e6);
  const double tiny2 = epsilon * size2;  // corrections of the longest steps that are as small may be rounding
  StaticReport report;
  double scale = detail::load_of(body), last_moved2 = std::numeric_limits<double>::infinity();
  for (double h = 100 * shortest; report.steps < options.max_steps;) {
    const Field<Scalar> before = body.displacements();
    report.last = integrator.step(body, static_cast<Scalar>(h), context);
    if (!report.last.accepted()) {
      longest = h /= 10;
      if (h < shortest / 100 || report.last.error <= StepError::newton_options) break;
      continue;
    }
    ++report.steps;
    report.newton_iterations += report.last.newton_iterations;
    report.iterations += report.last.iterations;
    const double left = detail::square_root(integrator.unbalanced_force2(body));
    scale = (std::max)(scale, left);
    report.residual = scale > 0 ? left / scale : 0;
    double moved2 = 0;
    for (std::size_t v = 0; v < before.size(); ++v)
      moved2 = (std::max)(moved2, double((body.displacements()[v] - before[v]).squaredNorm()));
    const bool rounded = h >= longest && moved2 <= tiny2 && moved2 > last_moved2 / 4;
    report.converged = report.last.newton_converged && (report.residual <= options.tolerance || rounded);
    if (report.converged) break;
    last_moved2 = h >= longest ? moved2 : last_moved2;
    h = report.last.newton_converged ? (std::min)(10 * h, longest) : (std::max)(h / 10, shortest / 100);
  }
  const Result<void> stopped = body.set_velocities(Field<Scalar>(at(body.vertex_count()), Vec3<Scalar>::Zero()));
  COROTET_ASSERT(stopped.ok(), "the field has the body's length");
  return report;
}

}  // namespace corotet::inline v0_1
