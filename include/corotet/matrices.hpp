// Stiffness and mass as sparse matrices of 3x3 blocks, without a body or time steps: for modes, statics, own solvers.
#pragma once

#include <corotet/assembly/assemble.hpp>
#include <corotet/assembly/block_matrix.hpp>
#include <corotet/assembly/block_pattern.hpp>
#include <corotet/assembly/elasticity.hpp>
#include <corotet/assembly/mass.hpp>
