// The matrix of a body: small square blocks in compressed rows on a fixed pattern.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/detail/assembly/block_pattern.hpp>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <memory>
#include <utility>

namespace corotet::inline v0_1 {

/// The values of a symmetric matrix on a BlockPattern, which it shares. Both triangles are stored, so that rows can be
/// multiplied side by side; one triangle alone is a quarter faster on one thread (docs/benchmarks/speed.md).
/// B = 3: a body's vertices; B = 6: rigid aggregates of them.
template <std::floating_point Scalar, int B = 3>
class BlockMatrix {
 public:
  using scalar_type = Scalar;          ///< the type of its numbers
  using Block = Matrix<Scalar, B, B>;  ///< the type of its blocks

  BlockMatrix() = default;
  /// Zero on the pattern, which must not be null.
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern)
      : pattern_(std::move(pattern)), value_(block_size * at(pattern_->blocks()) + padding, Scalar(0)) {}

  /// Which blocks are stored.
  [[nodiscard]] const BlockPattern& pattern() const { return *pattern_; }

  /// The same, to be shared with other matrices.
  [[nodiscard]] const std::shared_ptr<const BlockPattern>& shared_pattern() const { return pattern_; }

  /// Block rows, one a vertex.
  [[nodiscard]] Index rows() const { return pattern_->rows(); }

  /// A block, column-major in memory.
  [[nodiscard]] detail::MatrixView<Scalar, B, B> block(Index slot) {
    return detail::MatrixView<Scalar, B, B>(values(slot));
  }
  /// The block in slot `slot` of the pattern.
  [[nodiscard]] Block block(Index slot) const { return Block::load(values(slot)); }
  /// The block on the diagonal of a row.
  [[nodiscard]] Block diagonal(Index row) const { return block(pattern_->diagonal[at(row)]); }

  /// The numbers of a block and of those behind it; at least three more can be read after the last.
  [[nodiscard]] Scalar* values(Index slot) { return value_.data() + block_size * at(slot); }
  /// The numbers of the block in slot `slot`, by columns.
  [[nodiscard]] const Scalar* values(Index slot) const { return value_.data() + block_size * at(slot); }

  /// (A x) of one block row; the fourth number is zero.
  template <class FieldType>
  [[nodiscard]] COROTET_ALWAYS_INLINE detail::Vec4<Scalar> row_product(Index row, const FieldType& x) const
    requires(B == 3)
  {
    // Three columns of each of two blocks: six chains of additions, or their latency is what takes the time.
    std::array<detail::Vec4<Scalar>, 6> sum;
    sum.fill(detail::Vec4<Scalar>(Scalar(0)));
    const auto add = [&](Index k, std::size_t first) {
      const Scalar* a = values(k);
      const Scalar* v = x[at(pattern_->column[at(k)])].data();
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c)
        sum[first + c] += detail::Vec4<Scalar>::load(a + 3 * c) * detail::Vec4<Scalar>(v[c]);
    };
    const Index end = pattern_->row_start[at(row) + 1];
    Index k = pattern_->row_start[at(row)];
    for (; k + 1 < end; k += 2) {
      add(k, 0);
      add(k + 1, 3);
    }
    if (k < end) add(k, 0);
    return ((sum[0] + sum[3]) + (sum[1] + sum[4]) + (sum[2] + sum[5])).first_three();
  }

  /// Sum over j of A_ij (x_j - x_i): (A x)_i for a matrix whose rows sum to zero, free of the rounding that a rigid
  /// translation in x would cause.
  [[nodiscard]] COROTET_ALWAYS_INLINE detail::Vec4<Scalar> row_difference(Index row, const Field<Scalar>& x) const
    requires(B == 3)
  {
    std::array<detail::Vec4<Scalar>, 3> sum;
    sum.fill(detail::Vec4<Scalar>(Scalar(0)));
    const Vec3<Scalar> here = x[at(row)];
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k) {
      const Scalar* a = values(k);
      const Vec3<Scalar> v = x[at(pattern_->column[at(k)])] - here;
      COROTET_UNROLL
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += detail::Vec4<Scalar>::load(a + 3 * c) * detail::Vec4<Scalar>(v[static_cast<int>(c)]);
    }
    return (sum[0] + sum[1] + sum[2]).first_three();
  }

  /// y = A x. Both fields have `rows()` entries and do not alias.
  void apply(const Field<Scalar>& x, Field<Scalar>& y, ExecutorRef executor) const
    requires(B == 3)
  {
    for_ranges(executor, rows(), row_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) row_product(i, x).template store_part<3>(y[at(i)].data());
    });
  }

  /// *this += factor * other, of the same pattern.
  void add(Scalar factor, const BlockMatrix& other, ExecutorRef executor) {
    for_ranges(executor, rows(), row_grain, [&](Index begin, Index end) {
      const std::size_t first = block_size * at(pattern_->row_start[at(begin)]);
      const std::size_t last = block_size * at(pattern_->row_start[at(end)]);
      for (std::size_t k = first; k < last; ++k) value_[k] += factor * other.value_[k];
    });
  }

  /// Rows that one task works on: some tens of microseconds.
  static constexpr Index row_grain = 256;

  /// Makes row and column `row` zero off the diagonal; the equation of that vertex then stands alone.
  void isolate(Index row) {
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k) {
      const Index column = pattern_->column[at(k)];
      if (column == row) continue;
      block(k).setZero();
      block(pattern_->slot(column, row)).setZero();
    }
  }

  /// The same for one of the vertex's equations, which then stands apart from its other ones, too.
  void isolate(Index row, int component) {
    for (Index k = pattern_->row_start[at(row)]; k < pattern_->row_start[at(row) + 1]; ++k) {
      const Index column = pattern_->column[at(k)];
      auto here = block(k), there = block(pattern_->slot(column, row));
      for (int i = 0; i < B; ++i) {
        if (column == row && i == component) continue;
        here(component, i) = 0;
        there(i, component) = 0;
      }
    }
  }

  /// Of the values; the pattern is shared.
  [[nodiscard]] std::size_t bytes() const { return detail::bytes_of(value_); }

 protected:
  /// A matrix on the same pattern, with any values.
  [[nodiscard]] BlockMatrix without_values() const {
    BlockMatrix other;
    other.pattern_ = pattern_;
    other.value_ = value_.without_values();
    if (!other.value_.empty()) std::fill(other.value_.end() - padding, other.value_.end(), Scalar(0));
    return other;
  }

 private:
  static constexpr std::size_t block_size = std::size_t{B} * B;
  static constexpr std::size_t padding = 4;

  std::shared_ptr<const BlockPattern> pattern_;
  detail::Buffer<Scalar> value_;
};

namespace detail {

/// A matrix whose values mean nothing between two calls of its owner: copies have the pattern and any values. See
/// Scratch.
template <std::floating_point Scalar>
class ScratchMatrix : public BlockMatrix<Scalar> {
 public:
  ScratchMatrix() = default;
  explicit ScratchMatrix(std::shared_ptr<const BlockPattern> pattern) : BlockMatrix<Scalar>(std::move(pattern)) {}
  ScratchMatrix(const ScratchMatrix& other) : BlockMatrix<Scalar>(other.without_values()) {}
  ScratchMatrix(ScratchMatrix&&) noexcept = default;
  ScratchMatrix& operator=(const ScratchMatrix& other) {
    if (this != &other) *this = ScratchMatrix(other);
    return *this;
  }
  ScratchMatrix& operator=(ScratchMatrix&&) noexcept = default;
  ~ScratchMatrix() = default;
};

}  // namespace detail

}  // namespace corotet::inline v0_1
