// The yardstick for the time of a step.
#pragma once

#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/types.hpp>

namespace corotet::program {

/// y = A x as anybody would write it first: one number after the other, compiled without vectorisation. What a step
/// costs in units of it says as much on another machine.
void plain_product(const BlockMatrix<float>& matrix, const Field<float>& x, Field<float>& y);

}  // namespace corotet::program
