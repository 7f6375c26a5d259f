/// @defgroup group_measures Measures
/// What a body tells besides its state: strain, stress, energy and volume of each element, and the reactions of pins.
#pragma once

#include <corotet/detail/assembly/element_measures.hpp>
#include <corotet/detail/dynamics/measures.hpp>
