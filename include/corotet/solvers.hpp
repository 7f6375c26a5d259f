/// @defgroup group_solvers Linear solvers
/// Solvers and preconditioners of the linear systems of a step. AutoSolver is the default of all integrators.
#pragma once

#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/pcg.hpp>
#include <corotet/solve/pcg_solver.hpp>
#include <corotet/solve/rigid_aggregates.hpp>
#include <corotet/solve/solver.hpp>
#include <corotet/solve/warped_cholesky.hpp>
