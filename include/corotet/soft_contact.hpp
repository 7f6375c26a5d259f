/// @defgroup group_soft_contact Contact between soft bodies
/// Contact of soft bodies with each other, and of bodies with themselves.
#pragma once

#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/contact_surface.hpp>
#include <corotet/detail/contact/soft_contacts.hpp>
