// The matrix of a body: 3x3 blocks in compressed rows on a fixed pattern.
#pragma once

#include <corotet/assembly/block_pattern.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/types.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace corotet {

/// The values of a symmetric matrix on a BlockPattern, which it shares. Both triangles are stored.
template <std::floating_point Scalar>
class BlockMatrix {
 public:
  using scalar_type = Scalar;
  using Block = Mat3<Scalar>;

  BlockMatrix() = default;
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern)
      : pattern_(std::move(pattern)), block_(at(pattern_->blocks()), Block::Zero()) {}

  [[nodiscard]] const BlockPattern& pattern() const { return *pattern_; }

  [[nodiscard]] const std::shared_ptr<const BlockPattern>& shared_pattern() const { return pattern_; }

  /// Block rows, one a vertex.
  [[nodiscard]] Index rows() const { return pattern_->rows(); }

  [[nodiscard]] Block& block(Index slot) { return block_[at(slot)]; }
  [[nodiscard]] const Block& block(Index slot) const { return block_[at(slot)]; }
  [[nodiscard]] const Block& diagonal(Index row) const { return block_[at(pattern_->diagonal[at(row)])]; }

  /// (A x) of one block row.
  [[nodiscard]] Vec3<Scalar> row_product(Index row, const Field<Scalar>& x) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k)
      sum += block_[at(k)] * x[at(pattern_->column[at(k)])];
    return sum;
  }

  /// Sum over j of A_ij (x_j - x_i): (A x)_i for a matrix whose rows sum to zero, free of the rounding that a rigid
  /// translation in x would cause.
  [[nodiscard]] Vec3<Scalar> row_difference(Index row, const Field<Scalar>& x) const {
    Vec3<Scalar> sum = Vec3<Scalar>::Zero();
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k)
      sum += block_[at(k)] * (x[at(pattern_->column[at(k)])] - x[at(row)]);
    return sum;
  }

  /// y = A x. Both fields have `rows()` entries and do not alias.
  template <Executor E>
  void apply(const Field<Scalar>& x, Field<Scalar>& y, E& executor) const {
    for_ranges(executor, rows(), row_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) y[at(i)] = row_product(i, x);
    });
  }

  /// Rows that one task works on: some tens of microseconds.
  static constexpr Index row_grain = 512;

  /// Makes row and column `row` zero off the diagonal; the equation of that vertex then stands alone.
  void isolate(Index row) {
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k) {
      const Index column = pattern_->column[at(k)];
      if (column == row) continue;
      block_[at(k)].setZero();
      block_[at(pattern_->slot(column, row))].setZero();
    }
  }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<Block> block_;
};

}  // namespace corotet
