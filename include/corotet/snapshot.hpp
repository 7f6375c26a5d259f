/// @defgroup group_snapshot Snapshots
/// The state of a body and of its integrator as bytes. After it is restored, steps repeat to the last bit.
#pragma once

#include <corotet/detail/dynamics/snapshot.hpp>
