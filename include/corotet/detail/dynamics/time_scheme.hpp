// The policy slot "how is time discretised", and the scheme of first order.
#pragma once

#include <concepts>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/time_step.hpp>

namespace corotet::inline v0_1 {

/// What makes an Integrator of the implicit solve. `discretize` returns the step of h seconds from the body's present
/// state; its fields may be the body's or the scheme's. `accept`: the body has made that step; the fields are its state
/// before, whose buffers the scheme may exchange for its own. A refused step is not reported. A scheme is copied with
/// its integrator. `visit_state`, if there is one, names what a snapshot keeps of it: see StateArchive.
template <class S, class Body>
concept TimeScheme = std::constructible_from<S, const Body&> &&
                     requires(S& scheme, Body& body, typename Body::scalar_type h, const StepReport& report,
                              Field<typename Body::scalar_type>& previous, ExecutorRef executor) {
                       { scheme.discretize(body, h, executor) } -> std::same_as<TimeStep<typename Body::scalar_type>>;
                       scheme.accept(body, h, report, previous, previous);
                     };

namespace detail {

/// Backward Euler remembers nothing.
template <class Body>
class BackwardEulerScheme {
 public:
  using Scalar = typename Body::scalar_type;

  explicit BackwardEulerScheme(const Body& /*body*/) {}

  [[nodiscard]] TimeStep<Scalar> discretize(const Body& body, Scalar h, ExecutorRef /*executor*/) const {
    return backward_euler(body, h);
  }
  void accept(const Body& /*body*/, Scalar /*h*/, const StepReport& /*report*/, Field<Scalar>& /*displacement*/,
              Field<Scalar>& /*velocity*/) const {}
};

}  // namespace detail

}  // namespace corotet::inline v0_1
