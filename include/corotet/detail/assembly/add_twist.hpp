// The twist modes' part of a step's matrix.
#pragma once

#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/lanes.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// mu V [g_a]x H [g_b]x^T of an element at point q, with the nodes that are number `row` and `column`.
template <std::floating_point Scalar, class Evaluation>
[[nodiscard]] Mat3<Scalar> twist_block(const Evaluation& state, std::size_t q, const Mat3<Scalar>& h, std::size_t row,
                                       std::size_t column) {
  const Vec3<Scalar> ga = Vec3<Scalar>::load(state.gradient(q, row).data()),
                     gb = Vec3<Scalar>::load(state.gradient(q, column).data());
  Mat3<Scalar> turned, block;
  for (int k = 0; k < 3; ++k) turned.set_col(k, ga.cross(h.col(k)));
  for (int k = 0; k < 3; ++k) block.set_row(k, gb.cross(turned.row(k).transpose()).transpose());
  return block;
}

/// Adds a block and its mirror image, or the symmetric part of a block on the diagonal.
template <std::floating_point Scalar>
void add_symmetric(BlockMatrix<Scalar>& matrix, Index slot, Index mirror, const Mat3<Scalar>& block) {
  if (slot == mirror) {
    matrix.block(slot) += (block + block.transpose()) / 2;
  } else {
    matrix.block(slot) += block;
    matrix.block(mirror) = matrix.block(slot).transpose();
  }
}

/// As add_twist.
template <std::floating_point Scalar, class Law>
void add_twist_modes(const Law& law, const typename Law::Evaluation& state, Scalar factor, BlockMatrix<Scalar>& matrix,
                     ExecutorRef executor) {
  constexpr std::size_t n = Law::nodes, points = Law::points;
  const BlockPattern& p = matrix.pattern();
  // Where few elements have any, it is cheaper to go through these, on one thread, than through all blocks.
  if (state.twist.active_share() < 0.1) {
    for (Index e = 0; e < law.element_count(); ++e)
      for (std::size_t q = 0; q < points; ++q) {
        if (!state.twist.any(q, at(e))) continue;
        const auto& vertex = law.batches()[at(e / lane_count<Scalar>)].vertex;
        const auto lane = at(e % lane_count<Scalar>);
        const Mat3<Scalar> h = factor * state.twist.matrix(q, at(e));
        if (h.isZero()) continue;
        for (std::size_t a = 0; a < n; ++a)
          for (std::size_t b = a; b < n; ++b)
            add_symmetric<Scalar>(matrix, p.slot(vertex[a][lane], vertex[b][lane]),
                                  p.slot(vertex[b][lane], vertex[a][lane]),
                                  twist_block<Scalar>(state, q, h, at(e) * n + a, at(e) * n + b));
      }
    return;
  }
  for_ranges(executor, size_of(p.upper), 8 * BlockMatrix<Scalar>::row_grain, [&](Index begin, Index end) {
    for (Index u = begin; u < end; ++u) {
      Mat3<Scalar> sum = Mat3<Scalar>::Zero();
      for (Index c = p.contribution_start[at(u)]; c < p.contribution_start[at(u) + 1]; ++c) {
        const std::size_t code = at(p.contribution[at(c)]), row = code / n, element = row / n;
        for (std::size_t q = 0; q < points; ++q)
          if (state.twist.any(q, element))
            sum += twist_block<Scalar>(state, q, state.twist.matrix(q, element), row, element * n + code % n);
      }
      add_symmetric<Scalar>(matrix, p.upper[at(u)].slot, p.upper[at(u)].mirror, factor * sum);
    }
  });
}

/// matrix += factor * (the twist modes of the evaluated state, N/m). Keeps both triangles bitwise mirror images.
/// Batches without any are skipped; see TwistModes::active_share for bodies without any. Nothing for laws that have
/// none.
template <std::floating_point Scalar, class Law>
void add_twist(const Law& law, const typename Law::Evaluation& state, Scalar factor, BlockMatrix<Scalar>& matrix,
               ExecutorRef executor) {
  if constexpr (Law::has_twist_modes) add_twist_modes(law, state, factor, matrix, executor);
}

}  // namespace corotet::inline v0_1::detail
