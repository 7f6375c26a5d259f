/// @defgroup group_points Points of a body
/// A point inside a body or on its boundary: found at rest or deformed, followed, pulled and struck.
#pragma once

#include <corotet/embed/body_point.hpp>
#include <corotet/embed/point_locator.hpp>
#include <corotet/embed/point_on_body.hpp>
