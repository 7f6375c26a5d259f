// Linear solvers and preconditioners: AutoSolver is the default of all integrators; the others can be named instead.
#pragma once

#include <corotet/solve/auto_solver.hpp>
#include <corotet/solve/block_cholesky.hpp>
#include <corotet/solve/block_jacobi.hpp>
#include <corotet/solve/pcg.hpp>
#include <corotet/solve/rigid_aggregates.hpp>
#include <corotet/solve/solver.hpp>
#include <corotet/solve/step_system.hpp>
#include <corotet/solve/warped_cholesky.hpp>
