// The simplest preconditioners: the inverse of the diagonal, by numbers or by 3x3 blocks.
#pragma once

#include <corotet/detail/assembly/block_matrix.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/memory_use.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/deterministic_reduction.hpp>
#include <corotet/detail/solve/solver.hpp>
#include <memory>

namespace corotet::inline v0_1 {

/// z = D^-1 r, D = the 3x3 diagonal blocks, or only their diagonals.
template <std::floating_point Scalar>
class BlockJacobi {
 public:
  using scalar_type = Scalar;  ///< of the matrix
  /// The residual says little about the error here: see Pcg.
  static constexpr int estimator_delay = 16;

  /// `whole_blocks`: inverts the 3x3 blocks on the diagonal; otherwise their diagonals alone.
  explicit BlockJacobi(bool whole_blocks = true) : whole_blocks_(whole_blocks) {}

  /// See Preconditioner.
  void analyze(const std::shared_ptr<const BlockPattern>& pattern, const Field<Scalar>& /*rest*/) {
    inverse_ = detail::Scratch<Inverse>(at(pattern->rows()));
    sum_ = DeterministicSum(pattern->rows());
  }

  /// See Preconditioner.
  void update(const StepSystem<Scalar>& system, ExecutorRef executor) {
    for_ranges(executor, size_of(inverse_), DeterministicSum::grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        inverse_[at(i)] = Inverse::Zero();
        inverse_[at(i)].set_block(0, 0, inverse(system.matrix.diagonal(i)));
      }
    });
  }

  /// See Preconditioner.
  double apply(const PaddedField<Scalar>& r, PaddedField<Scalar>& z, ExecutorRef executor) {
    return sum_(executor, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) z[at(i)].set(apply_to(i, r[at(i)]));
      return detail::range_dot(r, z, begin, end);
    });
  }

  /// D^-1 r of one vertex.
  [[nodiscard]] COROTET_ALWAYS_INLINE detail::Vec4<Scalar> apply_to(Index vertex, const PaddedVector<Scalar>& r) const {
    const Scalar* d = inverse_[at(vertex)].data();
    return detail::Vec4<Scalar>::load(d) * detail::Vec4<Scalar>(r[0]) +
           detail::Vec4<Scalar>::load(d + 4) * detail::Vec4<Scalar>(r[1]) +
           detail::Vec4<Scalar>::load(d + 8) * detail::Vec4<Scalar>(r[2]);
  }

  /// Bytes of its own.
  [[nodiscard]] MemoryUse memory() const { return MemoryUse{detail::bytes_of(inverse_), 0} + sum_.memory(); }

 private:
  using Inverse = Matrix<Scalar, 4, 3>;  // each column with a zero behind it: a Vec4

  [[nodiscard]] Mat3<Scalar> inverse(const Mat3<Scalar>& block) const {
    if (!whole_blocks_) {
      Mat3<Scalar> inverses = Mat3<Scalar>::Zero();
      for (int i = 0; i < 3; ++i) inverses(i, i) = 1 / block(i, i);
      return inverses;
    }
    const Scalar scale = 1 / block.diagonal().maxCoeff();  // the determinant of a stiff block leaves the range of float
    return (block * scale).inverse() * scale;
  }

  bool whole_blocks_ = true;
  detail::Scratch<Inverse> inverse_;
  DeterministicSum sum_;
};

}  // namespace corotet::inline v0_1
