/// @defgroup group_terms Terms
/// Forces of your own in a step (springs, attachments, contacts, drag), with their stiffness and energy.
#pragma once

#include <corotet/detail/terms/body_terms.hpp>
#include <corotet/detail/terms/piecewise_term.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <corotet/detail/terms/term_state.hpp>
