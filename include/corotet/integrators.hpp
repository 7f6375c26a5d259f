/// @defgroup group_integrators Integrators
/// Time steps: ImplicitEuler and Bdf2. SubsteppingIntegrator divides steps that cannot be trusted, step_bodies steps
/// many bodies at once, and Integrator makes an integrator of your own TimeScheme.
#pragma once

#include <corotet/dynamics/bdf2.hpp>
#include <corotet/dynamics/implicit_euler.hpp>
#include <corotet/dynamics/integrator.hpp>
#include <corotet/dynamics/step_bodies.hpp>
#include <corotet/dynamics/step_context.hpp>
#include <corotet/dynamics/step_options.hpp>
#include <corotet/dynamics/step_phase.hpp>
#include <corotet/dynamics/step_report.hpp>
#include <corotet/dynamics/substepping_integrator.hpp>
#include <corotet/dynamics/time_scheme.hpp>
#include <corotet/dynamics/time_step.hpp>
