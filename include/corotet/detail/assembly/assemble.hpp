// Filling the matrix of a step.
#pragma once

#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/assembly/elasticity.hpp>
#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/core/executor.hpp>
#include <cstddef>
#include <utility>

namespace corotet::inline v0_1 {

namespace detail {

/// Adds the mass to a block of the stiffness and to its mirror image; on the diagonal, makes the block as symmetric as
/// it is but for rounding.
template <std::floating_point Scalar>
void add_mass(const BlockPattern& pattern, const Mass<Scalar>& mass, Scalar mass_factor, Index row, Index slot,
              Index mirror, BlockMatrix<Scalar>& matrix) {
  const Scalar m = mass_factor * mass.factor(pattern, row, slot);
  // Number by number: a vector that was just stored in parts is slow to load.
  Scalar* const k = matrix.values(slot);
  Scalar* const k_t = matrix.values(mirror);
  for (std::size_t i = 0; i < 9; i += 4) k[i] += m;
  if (slot == mirror)
    for (const auto& [i, j] : {std::pair{1, 3}, std::pair{2, 6}, std::pair{5, 7}}) k[i] = k[j] = (k[i] + k[j]) / 2;
  else
    for (std::size_t i = 0; i < 9; i += 4) k_t[i] = k[i];
}

/// Adds what MeanDilatation contributes to the upper block `u`.
template <std::floating_point Scalar, bool same_ratio, class Law>
void add_mean_dilatation(const BlockPattern& p, const typename Law::Evaluation& state, std::size_t u,
                         StiffnessSum<Scalar, same_ratio>& sum) {
  constexpr std::size_t n = Law::nodes;
  if constexpr (MeanDilatation<Scalar, typename Law::element_type>::over_patches) {
    for (Index c = p.stencil_contribution_start[u]; c < p.stencil_contribution_start[u + 1]; ++c) {
      const Index code = p.stencil_contribution[at(c)];
      sum.add_mean(state.mean_gradient(BlockPattern::row_of_stencil(code)),
                   state.mean_gradient(BlockPattern::column_of_stencil(code)));
    }
  } else {
    for (Index c = p.contribution_start[u]; c < p.contribution_start[u + 1]; ++c) {
      const std::size_t code = at(p.contribution[at(c)]), row = code / n;
      sum.add_mean(state.mean_gradient(row), state.mean_gradient(row / n * n + code % n));
    }
  }
}

/// As `assemble`, for elements of one Lamé ratio or of several.
template <bool same_ratio, std::floating_point Scalar, class Law>
void assemble_blocks(const Law& law, const typename Law::Evaluation& state, const Mass<Scalar>& mass,
                     Scalar mass_factor, Scalar stiffness_factor, BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
  constexpr std::size_t n = Law::nodes;
  constexpr Index grain = 8 * BlockMatrix<Scalar>::row_grain;
  const BlockPattern& p = matrix.pattern();
  const bool consistent = mass.model() == MassModel::consistent, mean_dilatation = law.mean_dilatation().on();
  for_ranges(executor, size_of(p.upper), grain, [&](Index begin, Index end) {
    for (Index u = begin; u < end; ++u) {
      StiffnessSum<Scalar, same_ratio> sum;
      for (Index c = p.contribution_start[at(u)]; c < p.contribution_start[at(u) + 1]; ++c) {
        const std::size_t code = at(p.contribution[at(c)]), row = code / n;
        sum.add(state, row, row / n * n + code % n);
      }
      if constexpr (same_ratio) sum.set_ratio(*law.common_lame_ratio());
      if (mean_dilatation) add_mean_dilatation<Scalar, same_ratio, Law>(p, state, at(u), sum);
      const auto [slot, mirror] = p.upper[at(u)];
      sum.write(stiffness_factor, matrix.values(slot), matrix.values(mirror));
      const Index row = p.column[at(mirror)];
      if (slot == mirror || consistent) add_mass(p, mass, mass_factor, row, slot, mirror, matrix);
    }
  });
}

/// As `assemble`, for models that have evaluated the blocks of each element.
template <std::floating_point Scalar, class Law>
void assemble_element_blocks(const typename Law::Evaluation& state, const Mass<Scalar>& mass, Scalar mass_factor,
                             Scalar stiffness_factor, BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
  constexpr std::size_t n = Law::nodes;
  constexpr Index grain = 8 * BlockMatrix<Scalar>::row_grain;
  const BlockPattern& p = matrix.pattern();
  const bool consistent = mass.model() == MassModel::consistent;
  for_ranges(executor, size_of(p.upper), grain, [&](Index begin, Index end) {
    for (Index u = begin; u < end; ++u) {
      BlockSum<Scalar> sum;
      for (Index c = p.contribution_start[at(u)]; c < p.contribution_start[at(u) + 1]; ++c) {
        const std::size_t code = at(p.contribution[at(c)]), row = code / n;
        sum.add(state, row / n, row % n, code % n);
      }
      const auto [slot, mirror] = p.upper[at(u)];
      sum.write(stiffness_factor, matrix.values(slot), matrix.values(mirror));
      if (slot == mirror || consistent) add_mass(p, mass, mass_factor, p.column[at(mirror)], slot, mirror, matrix);
    }
  });
}

}  // namespace detail

/// matrix = mass_factor * M + stiffness_factor * K', with the warped stiffness K' of the evaluated state, or for a
/// model other than Corotated its tangent stiffness. Both triangles are bitwise mirror images. `mass_factor` has no
/// unit, `stiffness_factor` is in s^2 if the result is to be in kg.
template <std::floating_point Scalar, class Law>
void assemble(const Law& law, const typename Law::Evaluation& state, const Mass<Scalar>& mass, Scalar mass_factor,
              Scalar stiffness_factor, BlockMatrix<Scalar>& matrix, ExecutorRef executor) {
  if constexpr (!Law::has_warped_stiffness)
    detail::assemble_element_blocks<Scalar, Law>(state, mass, mass_factor, stiffness_factor, matrix, executor);
  else if (law.common_lame_ratio().has_value())
    detail::assemble_blocks<true>(law, state, mass, mass_factor, stiffness_factor, matrix, executor);
  else
    detail::assemble_blocks<false>(law, state, mass, mass_factor, stiffness_factor, matrix, executor);
}

}  // namespace corotet::inline v0_1
