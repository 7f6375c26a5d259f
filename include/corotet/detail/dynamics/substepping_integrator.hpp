// Steps that cannot be trusted are accepted, refused or divided: the caller chooses.
#pragma once

#include <algorithm>
#include <corotet/detail/core/assert.hpp>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/revision.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// What becomes of a step that cannot be trusted. StepReport::warning says why in each case.
enum class OnUnreliable : std::uint8_t {
  accept,  ///< the body is where the step took it
  refuse,  ///< the body is where it was: StepError::unreliable
  divide   ///< h is gone through in 2, 4, 8, ... equal steps until all can be trusted, or there are too many
};

/// As in a scene file.
[[nodiscard]] constexpr std::string_view name_of(OnUnreliable on_unreliable) {
  return on_unreliable == OnUnreliable::accept ? "accept" : on_unreliable == OnUnreliable::refuse ? "refuse" : "divide";
}

/// Which steps SubsteppingIntegrator trusts, and what it does with the others.
struct SubsteppingOptions {
  OnUnreliable on_unreliable = OnUnreliable::divide;  ///< what happens to a step that cannot be trusted
  int max_halvings = 4;        ///< of the step, 0 ... 30: 4 means at most 16 steps instead of one
  double max_residual = 0.05;  ///< relative, of a linear solve or of Newton's method that has not converged
  /// Of StepReport::max_strain in one step. Known, as is how many elements are newly inverted, if the last step
  /// ended in this state or the body is in its rest shape; not in the first step from another state that was set.
  double max_strain_growth = 0.5;
};

/// An integrator around an integrator: it divides, refuses or marks steps that cannot be trusted.
///
/// Use it where pins jump, forces are hard or steps are long. It does not control the error of time integration: choose
/// Bdf2 or a shorter step for that.
/// @snippet steps.cpp adaptive
/// The report joins those of the steps that were kept: iterations are summed, of residuals the largest counts, and
/// deformation is that at the end.
///
/// Pins go to their targets in a straight line at equal speed during the sub-steps of a step; forces stay. Costs a copy
/// of the state a step (`accept`: nothing) as long as steps can be trusted. A Bdf2 begins anew after a division, by a
/// step of backward Euler. Pieces of a body that do not touch are divided each for itself. Made once for a body and its
/// copies; then `step` allocates nothing.
template <class Integrator, class Body>
class SubsteppingIntegrator {
 public:
  using Scalar = typename Body::scalar_type;  ///< of the body

  /// Takes `integrator`, which must have been made for `body`.
  SubsteppingIntegrator(Integrator integrator, const Body& body, const SubsteppingOptions& options = {})
      : integrator_(std::move(integrator)), options_(options) {
    COROTET_ASSERT(options.max_halvings >= 0 && options.max_halvings <= 30, "that many halvings mean nothing");
    memory_.resize(at(integrator_.implementation().piece_count()));
    if (options_.on_unreliable == OnUnreliable::accept) return;
    for (Memory& memory : memory_) {
      memory.displacement.reserve(at(body.vertex_count()));
      memory.velocity.reserve(at(body.vertex_count()));
      memory.target.reserve(at(body.vertex_count()));  // as many as there may be pins
    }
  }

  /// The integrator that makes the steps.
  [[nodiscard]] const Integrator& integrator() const { return integrator_; }
  /// What it was made with.
  [[nodiscard]] const SubsteppingOptions& options() const { return options_; }

  /// Advances `body` by `h` seconds. A refused step leaves it untouched, also where only a sub-step was refused.
  StepReport step(Body& body, Scalar h, ExecutorRef executor = {}, PhaseObserver observer = {}) {
    return step(body, h, StepContext<Scalar>{executor, observer, {}, {}});
  }
  /// The same with terms: see ImplicitEuler::step.
  StepReport step(Body& body, Scalar h, const StepContext<Scalar>& context) {
    return integrator_.implementation().step_pieces(
        body, context, [&](Index piece, auto& integrator, Body& of_piece, const StepContext<Scalar>& inner) {
          return divide(memory_[at(piece)], integrator, of_piece, h, inner);
        });
  }

  /// For snapshots.
  COROTET_COLD void visit_state(detail::StateArchive& archive, Body& body) {
    auto& implementation = integrator_.implementation();
    implementation.visit_state(archive, body);
    for (std::size_t p = 0; p < memory_.size(); ++p) {
      archive(memory_[p].known);
      archive(memory_[p].before.inverted_elements);
      archive(memory_[p].before.max_strain);
      detail::visit_revision(archive, memory_[p].motion,
                             implementation.piece_body(static_cast<Index>(p), body).motion_revision());
    }
  }

  /// As if it had just been made for the body.
  COROTET_COLD void reset(const Body& body) {
    integrator_.implementation().reset(body);
    for (Memory& memory : memory_) memory.motion = {};
  }

 private:
  /// Of a piece, when a step begins; `target`: where its pins shall go.
  struct Memory {
    Field<Scalar> displacement, velocity, target;
    // Of the state that a step begins in: whether its deformation is known, and if so the report that tells it.
    bool known = false;
    StepReport before;
    Revision motion;  // in which the last step that was kept ended
  };

  template <class Piece>
  StepReport divide(Memory& memory, Piece& integrator, Body& body, Scalar h, const StepContext<Scalar>& context) {
    if (options_.on_unreliable != OnUnreliable::accept) {
      memory.displacement = body.displacements();
      memory.velocity = body.velocities();
      memory.target = body.pins().targets();
    }
    const Revision start = body.motion_revision();
    if (memory.motion != start) {
      memory.before = {};
      memory.known = std::all_of(body.displacements().begin(), body.displacements().end(),
                                 [](const Vec3<Scalar>& u) { return u.isZero(); });
    }
    const int most = options_.on_unreliable == OnUnreliable::divide ? 1 << options_.max_halvings : 1;
    StepReport report;
    for (int parts = 1, tried = 0;; parts *= 2) {
      const bool last = parts >= most;
      report = go_through(memory, integrator, body, h, parts, last, context);
      tried += report.steps_tried;
      report.steps_tried = tried;
      const bool good_enough =
          report.warning == StepWarning::none || (last && options_.on_unreliable != OnUnreliable::refuse);
      if (report.accepted() && good_enough) {
        memory.motion = body.motion_revision();
        memory.known = true;
        memory.before = report;
        return report;
      }
      if (body.motion_revision() != start) restore(memory, body);
      if (last || is_misuse(report.error)) break;
    }
    if (report.accepted()) report.error = StepError::unreliable;
    return report;
  }

  /// Whether smaller steps would be refused just the same.
  [[nodiscard]] static bool is_misuse(StepError error) {
    return error != StepError::none && error != StepError::solver_breakdown && error != StepError::overflow;
  }

  /// Goes through h in so many equal parts; where there is another attempt, only up to the first that cannot be
  /// trusted.
  template <class Piece>
  StepReport go_through(const Memory& memory, Piece& integrator, Body& body, Scalar h, int parts, bool last,
                        const StepContext<Scalar>& context) {
    StepReport all, before = memory.before;
    bool known = memory.known;
    for (int part = 1; part <= parts; ++part) {
      if (parts > 1) lead_pins(memory, body, static_cast<Scalar>(part) / static_cast<Scalar>(parts));
      StepReport now = integrator.step(body, h / static_cast<Scalar>(parts), context);
      now.warning = now.accepted() ? warning_of(now, before, known) : StepWarning::none;
      before = now;
      known = true;
      all = part == 1 ? now : joined(all, now);
      all.steps_tried = part;
      if (!now.accepted() || (now.warning != StepWarning::none && !last)) break;
    }
    if (parts > 1) lead_pins(memory, body, 1);
    all.sub_steps = parts;
    return all;
  }

  [[nodiscard]] StepWarning warning_of(const StepReport& now, const StepReport& before, bool known) const {
    const auto too_far = [this](bool converged, double residual) {
      return !converged && !(residual <= options_.max_residual);
    };
    if (too_far(now.converged, now.residual) || too_far(now.newton_converged, now.newton_residual))
      return StepWarning::residual;
    if (known && now.inverted_elements > before.inverted_elements) return StepWarning::inverted;
    if (known && !(now.max_strain - before.max_strain <= options_.max_strain_growth)) return StepWarning::strain;
    return StepWarning::none;
  }

  [[nodiscard]] static StepReport joined(const StepReport& before, StepReport now) {
    now.converged = before.converged && now.converged;
    if (now.solve == SolveStatus::converged) now.solve = before.solve;
    now.iterations += before.iterations;
    now.residual = (std::max)(before.residual, now.residual);
    now.newton_iterations += before.newton_iterations;
    now.newton_converged = before.newton_converged && now.newton_converged;
    now.newton_residual = (std::max)(before.newton_residual, now.newton_residual);
    if (now.warning == StepWarning::none) now.warning = before.warning;
    return now;
  }

  /// Sets the targets of pins to where they are after this share of the step.
  void lead_pins(const Memory& memory, Body& body, Scalar share) const {
    const auto& pinned = body.pins().vertices();
    for (std::size_t p = 0; p < pinned.size(); ++p) {
      const Vec3<Scalar>& from = memory.displacement[at(pinned[p])];
      body.pins().move(pinned[p], detail::exactly_equal(share, Scalar(1)) ? memory.target[p]
                                                                          : (from + share * (memory.target[p] - from)));
    }
  }

  void restore(const Memory& memory, Body& body) const {
    Result<void> restored = body.set_displacements(memory.displacement);
    if (restored.ok()) restored = body.set_velocities(memory.velocity);
    COROTET_ASSERT(restored.ok(), "the state was the body's");
  }

  Integrator integrator_;
  SubsteppingOptions options_;
  std::vector<Memory> memory_;  // one a piece
};

template <class Integrator, class Body>
SubsteppingIntegrator(Integrator, const Body&) -> SubsteppingIntegrator<Integrator, Body>;

}  // namespace corotet::inline v0_1
