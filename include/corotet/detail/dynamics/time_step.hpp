// How a time scheme discretises one step.
#pragma once

#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1 {

/// One step of an implicit scheme: v' = v_history + gamma M^-1 (f_ext + f_el(x') - D v'), x' = x_history + gamma v'.
template <std::floating_point Scalar>
struct TimeStep {
  Scalar gamma;                    ///< s
  const Field<Scalar>& x_history;  ///< as displacement from rest, m
  const Field<Scalar>& v_history;  ///< m/s
  Scalar h;                        ///< length of the step, s
  int order = 1;                   ///< of the scheme. 1: x_history and v_history are the present state
  /// Second order: forces are linearised first where the body will be in this time (s) at its present velocity. First
  /// order: in the present state.
  Scalar linearization_time = 0;

  /// Whether it is a step of backward Euler.
  [[nodiscard]] bool is_first_order() const { return order == 1; }
};

/// v' = v + h M^-1 (f_ext + f_el(x') - D v'), x' = x + h v', linearised where the body is.
template <class Body>
[[nodiscard]] TimeStep<typename Body::scalar_type> backward_euler(const Body& body, typename Body::scalar_type h) {
  return {.gamma = h, .x_history = body.displacements(), .v_history = body.velocities(), .h = h};
}

}  // namespace corotet::inline v0_1
