/// @defgroup group_points Points of a body
/// A point inside a body or on its boundary: found at rest or deformed, followed, pulled and struck.
#pragma once

#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/embed/point_locator.hpp>
#include <corotet/detail/embed/point_on_body.hpp>
