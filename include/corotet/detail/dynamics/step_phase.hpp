// Lets a caller see where in a step the time goes: the library itself reads no clock.
#pragma once

#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <cstdint>
#include <type_traits>

namespace corotet::inline v0_1 {

/// The parts of a step, in order.
enum class StepPhase : std::uint8_t {
  assembly,  ///< matrix and right-hand side, from rotations and forces
  solve,     ///< the linear system
  update     ///< the new state, with the rotations and forces there, from which the next step starts
};

/// Refers to a callable that is told of each phase as it begins, on the thread that called `step`; it must outlive the
/// step. A refused step may not reach all of them. Made from nothing, it tells nobody.
class PhaseObserver {
 public:
  PhaseObserver() = default;
  /// Refers to a callable that takes a StepPhase; it must outlive the reference.
  template <std::invocable<StepPhase> O>
    requires(!std::same_as<std::remove_cvref_t<O>, PhaseObserver>)
  PhaseObserver(O&& observer)  // NOLINT(google-explicit-constructor, bugprone-forwarding-reference-overload)
      : object_(detail::address_of(observer)),
        call_(&detail::call_object<void, std::remove_reference_t<O>, StepPhase>) {}

  /// Whether there is anybody to tell.
  explicit operator bool() const { return call_ != nullptr; }

  /// Tells of a phase that begins.
  void operator()(StepPhase phase) const {
    if (call_ != nullptr) call_(object_, phase);
  }

 private:
  void* object_ = nullptr;
  void (*call_)(void*, StepPhase) = nullptr;
};

}  // namespace corotet::inline v0_1
