// What corotet::compiled holds: the classes of these headers, for the scalar and element that the including source
// names. Each source defines the instances of one combination: see corotet/core/instances.hpp.
#pragma once

#include <corotet/dynamics/bdf2.hpp>
#include <corotet/dynamics/implicit_euler.hpp>
#include <corotet/embed/embedded_surface.hpp>
