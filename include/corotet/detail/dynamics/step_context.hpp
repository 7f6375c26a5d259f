// What the caller of a step gives besides the body and the length of the step.
#pragma once

#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/terms/step_term.hpp>

namespace corotet::inline v0_1 {

/// All have defaults: serial, unobserved, no terms but the body's own.
template <std::floating_point Scalar>
struct StepContext {
  ExecutorRef executor = {};    ///< the caller's threads
  PhaseObserver observer = {};  ///< is told of each phase
  Terms<Scalar> terms = {};     ///< besides gravity, nodal forces and damping
  PieceVertices piece = {};     ///< set by the integrator of a body of several pieces
};

}  // namespace corotet::inline v0_1
