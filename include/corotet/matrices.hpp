/// @defgroup group_matrices Stiffness and mass matrices
/// Sparse matrices of 3x3 blocks, without a body or time steps: for vibration modes and solvers of your own.
#pragma once

#include <corotet/assembly/assemble.hpp>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/assembly/elasticity.hpp>
#include <corotet/assembly/mass.hpp>
