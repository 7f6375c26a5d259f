/// @defgroup group_solvers Linear solvers
/// Solvers and preconditioners of the linear systems of a step. AutoSolver is the default of all integrators.
#pragma once

#include <corotet/detail/core/register.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <corotet/detail/solve/block_cholesky.hpp>
#include <corotet/detail/solve/block_jacobi.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/pcg.hpp>
#include <corotet/detail/solve/pcg_solver.hpp>
#include <corotet/detail/solve/refactorization_policy.hpp>
#include <corotet/detail/solve/rigid_aggregates.hpp>
#include <corotet/detail/solve/rotation_of_points.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <corotet/detail/solve/step_system.hpp>
#include <corotet/detail/solve/warped_cholesky.hpp>
