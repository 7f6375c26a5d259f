// The simplest preconditioners: the inverse of the diagonal, by numbers or by 3x3 blocks.
#pragma once

#include <corotet/assembly/block_matrix.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <corotet/solve/solver.hpp>
#include <vector>

namespace corotet {

/// z = D^-1 r, D = the 3x3 diagonal blocks (`by_blocks`) or only their diagonals.
template <std::floating_point Scalar, bool by_blocks>
class DiagonalPreconditioner {
 public:
  DiagonalPreconditioner() = default;
  explicit DiagonalPreconditioner(const BlockPattern& pattern) : inverse_(at(pattern.rows())) {}

  template <Executor E>
  void update(const BlockMatrix<Scalar>& matrix, E& executor) {
    for_ranges(executor, matrix.rows(), grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        if constexpr (by_blocks)
          inverse_[at(i)] = inverse(matrix.diagonal(i));
        else
          inverse_[at(i)] = matrix.diagonal(i).diagonal().cwiseInverse().asDiagonal();
      }
    });
  }

  template <Executor E>
  void apply(const Field<Scalar>& r, Field<Scalar>& z, E& executor) const {
    for_ranges(executor, size_of(inverse_), grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) z[at(i)] = inverse_[at(i)] * r[at(i)];
    });
  }

 private:
  /// Scaled first: the determinant of a stiff block leaves the range of float.
  [[nodiscard]] static Mat3<Scalar> inverse(const Mat3<Scalar>& block) {
    const Scalar scale = 1 / block.diagonal().maxCoeff();
    return (block * scale).inverse() * scale;
  }

  static constexpr Index grain = 1024;
  std::vector<Mat3<Scalar>> inverse_;
};

template <std::floating_point Scalar>
using Jacobi = DiagonalPreconditioner<Scalar, false>;

template <std::floating_point Scalar>
using BlockJacobi = DiagonalPreconditioner<Scalar, true>;

static_assert(Preconditioner<BlockJacobi<float>, float> && Preconditioner<Jacobi<double>, double>);

}  // namespace corotet
