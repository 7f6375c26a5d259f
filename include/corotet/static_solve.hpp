/// @defgroup group_static_solve Static equilibrium
/// The shape in which a body rests under its pins, gravity, forces and terms.
#pragma once

#include <corotet/detail/dynamics/static_report.hpp>
#include <corotet/detail/dynamics/static_solve.hpp>
