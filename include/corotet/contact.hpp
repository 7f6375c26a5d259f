/// @defgroup group_contact Contact
/// Contact of bodies with obstacles: floors, walls, rigid bodies, with friction.
#pragma once

#include <corotet/detail/contact/collider.hpp>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/contact/contacts.hpp>
#include <corotet/detail/contact/mesh_collider.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/contact/point_contact.hpp>
#include <corotet/detail/contact/solid_properties.hpp>
