// Lets a caller see where in a step the time goes: the library itself reads no clock.
#pragma once

#include <concepts>
#include <cstdint>

namespace corotet {

/// The parts of a step, in order.
enum class StepPhase : std::uint8_t {
  assembly,  ///< matrix and right-hand side, from rotations and forces
  solve,     ///< the linear system
  update     ///< the new state, with the rotations and forces there, from which the next step starts
};

/// Called with each phase as it begins, on the thread that called `step`. A refused step may not reach all of them.
template <class O>
concept StepObserver = std::invocable<O&, StepPhase>;

/// The default: costs nothing.
struct IgnorePhases {
  void operator()(StepPhase) const {}
};

}  // namespace corotet
