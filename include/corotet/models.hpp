/// @defgroup group_models Elastic models and rotations
/// The constitutive law of a body: how each quadrature point's rotation is found, and what energy the strain has.
#pragma once

#include <corotet/material/corotated.hpp>
#include <corotet/material/elastic_model.hpp>
#include <corotet/material/point_states.hpp>
#include <corotet/material/principal_tangent.hpp>
#include <corotet/material/stable_neo_hookean.hpp>
#include <corotet/material/strain.hpp>
#include <corotet/material/tangent_lanes.hpp>
#include <corotet/rotation/gram_schmidt.hpp>
#include <corotet/rotation/identity.hpp>
#include <corotet/rotation/per_element.hpp>
#include <corotet/rotation/polar.hpp>
#include <corotet/rotation/rotation_extractor.hpp>
