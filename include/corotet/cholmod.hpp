/// @defgroup group_cholmod CHOLMOD (opt-in)
/// SuiteSparse's Cholesky factorisation as a solver (GPL in part). Link corotet::cholmod.
#pragma once

#include <corotet/detail/solve/cholmod.hpp>
