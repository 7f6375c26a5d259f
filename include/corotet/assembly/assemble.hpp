// Filling the matrix of a step.
#pragma once

#include <corotet/assembly/block_matrix.hpp>
#include <corotet/assembly/elasticity.hpp>
#include <corotet/assembly/mass.hpp>
#include <corotet/core/executor.hpp>

namespace corotet {

/// matrix = mass_factor * M + stiffness_factor * K', with the warped stiffness K' of the evaluated state. Both
/// triangles are bitwise mirror images. `mass_factor` has no unit, `stiffness_factor` is in s^2 if the result is to be
/// in kg.
template <std::floating_point Scalar, class Law, Executor E>
void assemble(const Law& law, const typename Law::Evaluation& state, const Mass<Scalar>& mass, Scalar mass_factor,
              Scalar stiffness_factor, BlockMatrix<Scalar>& matrix, E& executor) {
  constexpr Index n = Law::nodes;
  constexpr Index grain = 8 * BlockMatrix<Scalar>::row_grain;
  const BlockPattern& p = matrix.pattern();
  for_ranges(executor, size_of(p.upper), grain, [&](Index begin, Index end) {
    for (Index u = begin; u < end; ++u) {
      Mat3<Scalar> k = Mat3<Scalar>::Zero();
      for (Index c = p.contribution_start[at(u)]; c < p.contribution_start[at(u) + 1]; ++c) {
        const Index code = p.contribution[at(c)];
        k += law.stiffness_block(state, code / (n * n), code / n % n, code % n);
      }
      const auto [slot, mirror] = p.upper[at(u)];
      const Index row = p.column[at(mirror)];
      k *= stiffness_factor;
      if (slot == mirror) k = (k + k.transpose().eval()) / Scalar(2);  // symmetric up to rounding: make it exact
      k.diagonal().array() += mass_factor * mass.factor(p, row, slot);
      matrix.block(slot) = k;
      matrix.block(mirror) = k.transpose();
    }
  });
}

}  // namespace corotet
