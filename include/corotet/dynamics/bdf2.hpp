// The backward differentiation formula of second order.
#pragma once

#include <algorithm>
#include <cmath>
#include <corotet/core/executor.hpp>
#include <corotet/core/instances.hpp>
#include <corotet/core/revision.hpp>
#include <corotet/core/types.hpp>
#include <corotet/dynamics/implicit_step.hpp>
#include <corotet/dynamics/newton_options.hpp>
#include <corotet/dynamics/soft_body.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/range_sum.hpp>
#include <corotet/solve/solver.hpp>
#include <utility>

namespace corotet::inline v0_1 {

/// v' = vbar + c M^-1 (f_ext + f_el(x') - D v'), x' = xbar + c v'. With steps of equal length c = 2h/3,
/// xbar = (4 x - x_before) / 3 and vbar likewise; in general, with w = h / h_before, c = h (1 + w) / (1 + 2 w) and
/// xbar = x + w^2 / (1 + 2 w) (x - x_before) (Hairer, Nørsett & Wanner 1993, section III.5). Error O(h^2); vibrations
/// much faster than a step are damped within a few steps, as by backward Euler (L-stable), slow ones hardly.
///
/// The force is linearised where the body would be after the step at its present velocity, and pins at their targets:
/// with one solve a step the error stays O(h^2) although the warped stiffness is not the exact tangent. Less far ahead
/// where motion is not smooth, for only near that line is the formula stable with another tangent than the exact: see
/// `extrapolate`.
///
/// A step that does not continue the last one is of backward Euler: the first, one after the caller set displacements
/// or velocities, one that is more than twice as long as the step before (zero-stability ends at 1 + sqrt 2), and those
/// that start with inverted elements, whose rotations jump: a second derivative in time means nothing there, and
/// backward Euler brings nearly incompressible ones home.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class Bdf2 {
 public:
  using Scalar = typename Body::scalar_type;

  /// Symbolic work and memory for `body` and its copies.
  explicit Bdf2(const Body& body, Solver solver = Solver(), const NewtonOptions& newton = {});
  Bdf2(const Body& body, const typename Solver::Options& options, const NewtonOptions& newton = {})
      : Bdf2(body, Solver(options), newton) {}

  [[nodiscard]] const Solver& solver() const { return implicit_.solver(); }
  [[nodiscard]] const NewtonOptions& newton() const { return implicit_.options(); }

  /// Advances `body` by `h` seconds. Whatever happens is in the report; a refused step leaves the body untouched.
  /// `observer` is told of each phase as it begins.
  StepReport step(Body& body, Scalar h, ExecutorRef executor = {}, PhaseObserver observer = {});

 private:
  [[nodiscard]] bool continues(const Body& body, Scalar h) const {
    return motion_ == body.motion_revision() && h <= 2 * last_h_;
  }

  /// Sets xbar and vbar. Returns how far ahead the force is to be linearised, 0 ... h s: all of it as long as the
  /// present velocity and the mean one of the last step differ by less than half of that, about their mean over the
  /// body; nothing once they differ by more than that. Near rest, with h times a frequency of the body above 1, they
  /// do, and the extrapolation would be unstable wherever the stiffness is more than 6/5 of the tangent's: z^3 = g (5/2
  /// z^2 - 2 z + 1/2) for a step's factor z has |z| < 1 for g > -1/5 only, where g = 1 - stiffness / tangent.
  [[nodiscard]] Scalar extrapolate(const Body& body, Scalar h, Scalar lead, ExecutorRef executor);

  ImplicitStep<Body, Solver> implicit_;
  RangeSums<8> sums_;
  Field<Scalar> last_position_, last_velocity_;  // before the last step
  Field<Scalar> position_, velocity_;            // xbar, vbar
  Scalar last_h_ = 0;
  Revision motion_;  // of the state after the last step, if it can be continued
};

template <class Body>
Bdf2(const Body&) -> Bdf2<Body>;

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
Bdf2<Body, Solver>::Bdf2(const Body& body, Solver solver, const NewtonOptions& newton)
    : implicit_(body, std::move(solver), newton),
      sums_(body.vertex_count()),
      last_position_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
      last_velocity_(last_position_),
      position_(last_position_),
      velocity_(last_position_) {}

template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
StepReport Bdf2<Body, Solver>::step(Body& body, Scalar h, ExecutorRef executor, PhaseObserver observer) {
  StepReport report = implicit_.validate(body, h);
  if (!report.accepted()) return report;
  if (continues(body, h)) {
    const Scalar w = h / last_h_;
    const Scalar ahead = extrapolate(body, h, w * w / (1 + 2 * w), executor);
    report = implicit_.advance(
        body, {.c = h * (1 + w) / (1 + 2 * w), .position = position_, .velocity = velocity_, .h = h, .ahead = ahead},
        executor, observer);
  } else {
    report = implicit_.advance(body, backward_euler(body, h), executor, observer);
  }
  if (!report.accepted()) return report;
  implicit_.swap_previous_state(last_position_, last_velocity_);
  last_h_ = h;
  motion_ = report.inverted_elements == 0 ? body.motion_revision() : Revision{};
  return report;
}

template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
typename Body::scalar_type Bdf2<Body, Solver>::extrapolate(const Body& body, Scalar h, Scalar lead,
                                                           ExecutorRef executor) {
  const auto sums = sums_(executor, [&](Index begin, Index end) {
    RangeSums<8>::Sums part{};
    for (Index i = begin; i < end; ++i) {
      const Vec3<Scalar>&x = body.displacements()[at(i)], &v = body.velocities()[at(i)];
      const Vec3<Scalar> moved = x - last_position_[at(i)];
      position_[at(i)] = x + lead * moved;
      velocity_[at(i)] = v + lead * (v - last_velocity_[at(i)]);
      const Vec3<Scalar> mean = moved / last_h_;
      const Vec3<double> before = mean.template cast<double>(), change = (v - mean).template cast<double>();
      part[0] += before.squaredNorm();
      part[1] += change.squaredNorm();
      for (int k = 0; k < 3; ++k) {
        part[at(2 + k)] += before[k];
        part[at(5 + k)] += change[k];
      }
    }
    return part;
  });
  const auto spread = [&](std::size_t square, std::size_t first) {  // about the mean
    const auto sum = Vec3<double>::load(&sums[first]);
    return std::sqrt((std::max)(0.0, sums[square] - sum.squaredNorm() / body.vertex_count()));
  };
  const double before = spread(0, 2), change = spread(1, 5);
  return h * static_cast<Scalar>(before > 0 ? std::clamp(2 - 2 * change / before, 0.0, 1.0) : 0.0);
}

COROTET_INSTANCES_OF_BODY(Bdf2)

}  // namespace corotet::inline v0_1
