// The twist modes' part of a step's matrix.
#pragma once

#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <cstddef>

namespace corotet {

/// matrix += factor * (the twist modes of the evaluated state, N/m). Keeps both triangles bitwise mirror images.
/// Elements without any are skipped; see TwistModes::any for bodies without any.
template <std::floating_point Scalar, class Evaluation, Executor E>
void add_twist(const Evaluation& state, Scalar factor, BlockMatrix<Scalar>& matrix, E& executor) {
  constexpr std::size_t n = Evaluation::nodes;
  constexpr Index grain = 8 * BlockMatrix<Scalar>::row_grain;
  const BlockPattern& p = matrix.pattern();
  for_ranges(executor, size_of(p.upper), grain, [&](Index begin, Index end) {
    for (Index u = begin; u < end; ++u) {
      Mat3<Scalar> sum = Mat3<Scalar>::Zero();
      bool any = false;
      for (Index c = p.contribution_start[at(u)]; c < p.contribution_start[at(u) + 1]; ++c) {
        const std::size_t code = at(p.contribution[at(c)]), row = code / n, element = row / n;
        for (std::size_t q = 0; q < Evaluation::points; ++q) {
          if (!state.twist.any(q, element)) continue;
          any = true;
          const Eigen::Map<const Vec3<Scalar>> ga(state.gradient(q, row));
          const Eigen::Map<const Vec3<Scalar>> gb(state.gradient(q, element * n + code % n));
          const Mat3<Scalar> h = state.twist.matrix(q, element);
          Mat3<Scalar> turned;  // [g_a]x H
          for (int k = 0; k < 3; ++k) turned.col(k) = ga.cross(h.col(k));
          for (int k = 0; k < 3; ++k) sum.row(k) += gb.cross(turned.row(k).transpose()).transpose();
        }
      }
      if (!any) continue;
      const auto [slot, mirror] = p.upper[at(u)];
      if (slot == mirror) {
        sum = (sum + sum.transpose()).eval() / 2;
        matrix.block(slot) += factor * sum;
      } else {
        matrix.block(slot) += factor * sum;
        matrix.block(mirror) = matrix.block(slot).transpose();
      }
    }
  });
}

}  // namespace corotet
