// What corotet::compiled holds: the classes of these headers, for the scalar and element that the including source
// names. Each source defines the instances of one combination: see corotet/detail/core/instances.hpp.
#pragma once

#include <corotet/detail/contact/contacts.hpp>
#include <corotet/detail/dynamics/bdf2.hpp>
#include <corotet/detail/dynamics/implicit_euler.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
