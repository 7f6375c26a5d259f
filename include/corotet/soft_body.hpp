/// @defgroup group_soft_body Bodies
/// A soft body: its model (mesh, material, mass), its state, pins, gravity and forces.
///
/// An integrator (@ref group_integrators) moves it.
#pragma once

#include <corotet/detail/assembly/mean_dilatation.hpp>
#include <corotet/detail/dynamics/body_model.hpp>
#include <corotet/detail/dynamics/pins.hpp>
#include <corotet/detail/dynamics/soft_body.hpp>
