/// @defgroup group_surface Surfaces
/// A detailed surface that moves with a body: bound once, then written into a vertex buffer each frame.
#pragma once

#include <corotet/detail/embed/coordinates.hpp>
#include <corotet/detail/embed/embedded_surface.hpp>
#include <corotet/detail/embed/vertex_buffer.hpp>
