/// @defgroup group_integrators Integrators
/// Time steps: ImplicitEuler and Bdf2. SubsteppingIntegrator divides steps that cannot be trusted, step_bodies steps
/// many bodies at once, and Integrator makes an integrator of your own TimeScheme.
#pragma once

#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/dynamics/integrator.hpp>
#include <corotet/detail/dynamics/step_bodies.hpp>
#include <corotet/detail/dynamics/step_context.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/step_phase.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <corotet/detail/dynamics/time_scheme.hpp>
#include <corotet/detail/dynamics/time_step.hpp>
