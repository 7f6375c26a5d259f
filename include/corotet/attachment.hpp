/// @defgroup group_attachment Attachments
/// Points of bodies tied to points in space, to obstacles, to each other.
#pragma once

#include <corotet/detail/contact/attachment.hpp>
#include <corotet/detail/contact/obstacles.hpp>
