/// @defgroup group_matrices Stiffness and mass matrices
/// Sparse matrices of 3x3 blocks, without a body or time steps: for vibration modes and solvers of your own.
#pragma once

#include <corotet/detail/assembly/assemble.hpp>
#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/assembly/mass.hpp>
