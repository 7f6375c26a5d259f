/// @defgroup group_models Elastic models and rotations
/// The constitutive law of a body: how each quadrature point's rotation is found, and what energy the strain has.
#pragma once

#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/material/corotated.hpp>
#include <corotet/detail/material/elastic_model.hpp>
#include <corotet/detail/material/point_states.hpp>
#include <corotet/detail/material/principal_tangent.hpp>
#include <corotet/detail/material/stable_neo_hookean.hpp>
#include <corotet/detail/material/tangent_lanes.hpp>
#include <corotet/detail/rotation/gram_schmidt.hpp>
#include <corotet/detail/rotation/identity.hpp>
#include <corotet/detail/rotation/per_element.hpp>
#include <corotet/detail/rotation/polar.hpp>
#include <corotet/detail/rotation/rotation_extractor.hpp>
