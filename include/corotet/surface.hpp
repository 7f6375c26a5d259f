/// @defgroup group_surface Surfaces
/// A detailed surface that moves with a body: bound once, then written into a vertex buffer each frame.
#pragma once

#include <corotet/embed/coordinates.hpp>
#include <corotet/embed/embedded_surface.hpp>
#include <corotet/embed/vertex_buffer.hpp>
