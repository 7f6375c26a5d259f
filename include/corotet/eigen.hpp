/// @defgroup group_eigen Eigen (opt-in)
/// Fields and small matrices as Eigen's (3.4 or 5). Link corotet::eigen.
#pragma once

#include <corotet/detail/core/eigen.hpp>
