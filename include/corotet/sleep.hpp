/// @defgroup group_sleep Sleep
/// Bodies that have come to rest are not stepped until something wakes them.
#pragma once

#include <corotet/detail/contact/sleep.hpp>
#include <corotet/detail/contact/term_rest.hpp>
