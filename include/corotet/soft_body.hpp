// A soft body: its model (mesh, material, mass), its state, pins, gravity and forces. An integrator
// (<corotet/integrators.hpp>) moves it.
#pragma once

#include <corotet/dynamics/body_model.hpp>
#include <corotet/dynamics/pins.hpp>
#include <corotet/dynamics/soft_body.hpp>
