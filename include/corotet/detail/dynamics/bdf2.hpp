// The backward differentiation formula of second order.
#pragma once

#include <algorithm>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/instances.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/integrator.hpp>
#include <corotet/detail/dynamics/pins.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/time_scheme.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <limits>

namespace corotet::inline v0_1 {

namespace detail {

/// The backward differentiation formula of second order for steps of any length: docs/theory.md, equation 12 (Hairer,
/// Nørsett & Wanner 1993, section III.5).
///
/// The force is linearised where the body would be after the step at its present velocity, and pins at their targets.
/// With one solve a step the error then stays O(h^2), although the warped stiffness is not the exact tangent. Where
/// motion is not smooth the force is linearised less far ahead, for stability: see `extrapolate`.
///
/// A step that does not continue the last one is of backward Euler: the first, one after the caller set displacements
/// or velocities, one that is more than twice as long as the step before (zero-stability ends at 1 + sqrt 2), and one
/// that starts with inverted elements. Their rotations jump, so that a second derivative in time means nothing there.
template <class Body>
class Bdf2Scheme {
 public:
  using Scalar = typename Body::scalar_type;

  COROTET_COLD explicit Bdf2Scheme(const Body& body)
      : sums_(body.vertex_count()),
        last_position_(at(body.vertex_count()), Vec3<Scalar>::Zero()),
        last_velocity_(last_position_),
        x_history_(last_position_),
        v_history_(last_position_),
        pinned_(at(body.vertex_count()), PinnedAxes{false, false, false}) {}

  [[nodiscard]] TimeStep<Scalar> discretize(const Body& body, Scalar h, ExecutorRef executor) {
    if (motion_ != body.motion_revision() || h > 2 * last_h_) return backward_euler(body, h);
    if (shift_ != body.origin_shift()) follow_origin(body);
    if (pins_ != body.pins().revision()) forget_released(body);
    const Scalar w = h / last_h_;
    const Scalar time = extrapolate(body, h, w * w / (1 + 2 * w), executor);
    return {.gamma = h * (1 + w) / (1 + 2 * w),
            .x_history = x_history_,
            .v_history = v_history_,
            .h = h,
            .order = 2,
            .linearization_time = time};
  }

  void accept(const Body& body, Scalar h, const StepReport& report, Field<Scalar>& displacement,
              Field<Scalar>& velocity) {
    last_position_.swap(displacement);
    last_velocity_.swap(velocity);
    last_h_ = h;
    shift_ = body.origin_shift();
    motion_ = report.inverted_elements == 0 ? body.motion_revision() : Revision{};
    if (pins_ == body.pins().revision()) return;
    pins_ = body.pins().revision();
    for (Index v = 0; v < body.vertex_count(); ++v) pinned_[at(v)] = body.pins().axes_of(v);
  }

  [[nodiscard]] MemoryUse memory() const {
    MemoryUse use = sums_.memory();
    for (const Field<Scalar>* field : {&last_position_, &last_velocity_, &x_history_, &v_history_})
      use.owned += bytes_of(*field);
    use.owned += bytes_of(pinned_);
    return use;
  }

  /// For snapshots.
  void visit_state(StateArchive& archive, const Body& body) {
    archive(last_position_);
    archive(last_velocity_);
    archive(last_h_);
    archive(shift_);
    archive(pinned_);
    visit_revision(archive, motion_, body.motion_revision());
    visit_revision(archive, pins_, body.pins().revision());
  }

 private:
  void follow_origin(const Body& body) {
    const Vec3<Scalar> shift = (body.origin_shift() - shift_).template cast<Scalar>();
    for (Vec3<Scalar>& x : last_position_) x -= shift;
    shift_ = body.origin_shift();
  }

  /// What was pinned in the last step and is free now has no history but its present velocity.
  void forget_released(const Body& body) {
    for (Index v = 0; v < body.vertex_count(); ++v)
      for (int i = 0; i < 3; ++i)
        if (pinned_[at(v)][i] && !body.pins().axes_of(v)[i]) {
          last_velocity_[at(v)][i] = body.velocities()[at(v)][i];
          last_position_[at(v)][i] = body.displacements()[at(v)][i] - last_h_ * body.velocities()[at(v)][i];
        }
  }

  /// Sets x_history and v_history. Returns how far ahead the force is to be linearised, 0 ... h s: all of it as long as
  /// the present velocity and the mean one of the last step differ by less than half of that, about their mean over the
  /// body; nothing once they differ by more than that. Near rest, with h times a frequency of the body above 1, they
  /// do, and the extrapolation would be unstable wherever the stiffness is more than 6/5 of the tangent's:
  /// z^3 = g (5/2 z^2 - 2 z + 1/2) for a step's factor z has |z| < 1 for g > -1/5 only, where
  /// g = 1 - stiffness / tangent.
  [[nodiscard]] Scalar extrapolate(const Body& body, Scalar h, Scalar lead, ExecutorRef executor) {
    const auto sums = sums_(executor, [&](Index begin, Index end) {
      DeterministicReduction<9>::Sums part{};
      for (Index i = begin; i < end; ++i) {
        const Vec3<Scalar>&x = body.displacements()[at(i)], &v = body.velocities()[at(i)];
        const Vec3<Scalar> moved = x - last_position_[at(i)];
        x_history_[at(i)] = x + lead * moved;
        v_history_[at(i)] = v + lead * (v - last_velocity_[at(i)]);
        const Vec3<Scalar> mean = moved / last_h_;
        const Vec3<double> before = mean.template cast<double>(), change = (v - mean).template cast<double>();
        part[0] += before.squaredNorm();
        part[1] += change.squaredNorm();
        part[8] += double(x.squaredNorm());
        for (int k = 0; k < 3; ++k) {
          part[at(2 + k)] += before[k];
          part[at(5 + k)] += change[k];
        }
      }
      return part;
    });
    const auto spread = [&](std::size_t square, std::size_t first) {  // about the mean
      const auto sum = Vec3<double>::load(&sums[first]);
      return detail::square_root((std::max)(0.0, sums[square] - sum.squaredNorm() / body.vertex_count()));
    };
    // Velocities are known to the rounding of positions over the last step: a body that only flies has no spread.
    const double rounding = 2 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) *
                            detail::square_root(sums[8]) / static_cast<double>(last_h_);
    const double before = spread(0, 2), change = (std::max)(0.0, spread(1, 5) - rounding);
    if (is_zero(change)) return h;
    return h * static_cast<Scalar>(before > 0 ? std::clamp(2 - 2 * change / before, 0.0, 1.0) : 0.0);
  }

  DeterministicReduction<9> sums_;
  Field<Scalar> last_position_, last_velocity_;  // before the last step
  Field<Scalar> x_history_, v_history_;
  Buffer<PinnedAxes> pinned_;                  // in the last step
  Vec3<double> shift_ = Vec3<double>::Zero();  // of the body's origin, to which last_position_ refers
  Scalar last_h_ = 0;
  Revision pins_;
  Revision motion_;  // of the state after the last step, if it can be continued
};

}  // namespace detail

/// The integrator of second order, BDF2: error O(h^2), little damping of slow vibrations.
///
/// Use it where motion is compared with measurement or another program, or must keep its energy. ImplicitEuler takes
/// less time a step and damps more. Vibrations much faster than a step are damped within a few steps (L-stable).
/// @snippet steps.cpp bdf2
/// The scheme is equation 12 of docs/theory.md. A step that does not continue the last one, as after set_displacements,
/// is of backward Euler. Steps may differ in length.
template <class Body, class Solver = AutoSolver<typename Body::scalar_type>>
  requires LinearSolver<Solver, typename Body::scalar_type>
class Bdf2 {
 public:
  using Scalar = typename Body::scalar_type;                                  ///< of the body
  using Implementation = Integrator<Body, detail::Bdf2Scheme<Body>, Solver>;  ///< what it is made of

  /// Symbolic work and memory for `body` and its copies.
  explicit Bdf2(const Body& body, const Solver& solver = Solver(), const StepOptions& newton = {});
  /// The same with the options of the solver alone.
  Bdf2(const Body& body, const typename Solver::Options& options, const StepOptions& newton = {})
      : Bdf2(body, Solver(options), newton) {}

  /// The linear solver, with its options.
  [[nodiscard]] const Solver& solver() const { return implementation_.solver(); }
  /// The options of the step's equation.
  [[nodiscard]] const StepOptions& newton() const { return implementation_.newton(); }

  /// Advances `body` by `h` seconds: see ImplicitEuler::step.
  StepReport step(Body& body, Scalar h, ExecutorRef executor = {}, PhaseObserver observer = {}) {
    return step(body, h, StepContext<Scalar>{executor, observer, {}, {}});
  }
  /// The same with terms: see ImplicitEuler::step.
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
Bdf2(const Body&) -> Bdf2<Body>;

// Below the class, and so compiled where it is instantiated: once, where the program links corotet::compiled.
template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
Bdf2<Body, Solver>::Bdf2(const Body& body, const Solver& solver, const StepOptions& newton)
    : implementation_(body, solver, newton) {}

template <class Body, class Solver>
  requires LinearSolver<Solver, typename Body::scalar_type>
StepReport Bdf2<Body, Solver>::step(Body& body, Scalar h, const StepContext<Scalar>& context) {
  return implementation_.step(body, h, context);
}

COROTET_INSTANCES_OF_BODY(Bdf2)

}  // namespace corotet::inline v0_1
