// A sparse triangular factor of small blocks, ready to be solved with.
#pragma once

#include <algorithm>
#include <array>
#include <corotet/core/buffer.hpp>
#include <corotet/core/compiler.hpp>
#include <corotet/core/register.hpp>
#include <corotet/core/types.hpp>
#include <cstddef>
#include <vector>

namespace corotet::inline v0_1 {

/// A = P^T L L^T P, L by block columns. Kept apart from the factorisation, so that a factor made in double can be
/// solved with in float: half the memory to read, and still symmetric and positive definite.
template <std::floating_point Scalar, int B>
class BlockFactor {
 public:
  using Block = Matrix<Scalar, B, B>;

  std::vector<Index> order;         ///< order[k]: the row eliminated as k-th
  std::vector<Index> column_start;  ///< rows() + 1 entries
  std::vector<Index> row;           ///< of each block, permuted; the diagonal block comes first in its column

  [[nodiscard]] Index rows() const { return size_of(order); }

  /// Block `p`, column-major. On the diagonal: the inverse of L_jj.
  [[nodiscard]] MatrixView<Scalar, B, B> block(Index p) { return MatrixView<Scalar, B, B>(values(p)); }
  [[nodiscard]] Block block(Index p) const { return Block::load(values(p)); }

  /// Memory for the blocks of a pattern that is there.
  COROTET_COLD void allocate() {
    value_.assign(block_size * row.size() + width, Scalar(0));
    work_.assign(at(rows()) * width, Scalar(0));
  }

  /// The same factor in another precision; allocates the first time only, and for another pattern.
  template <std::floating_point Other>
  void assign(const BlockFactor<Other, B>& other) {
    order = other.order;
    column_start = other.column_start;
    row = other.row;
    if (value_.size() != block_size * row.size() + width || work_.size() != at(rows()) * width) allocate();
    for (Index p = 0; p < size_of(row); ++p) block(p) = other.block(p).template cast<Scalar>();
  }

  /// x = A^-1 b; both are rows() times B numbers, and may be the same.
  void solve(const Scalar* b, Scalar* x) {
    const Index n = rows();
    for (Index k = 0; k < n; ++k) std::copy_n(b + at(order[at(k)]) * std::size_t{B}, B, segment(k));
    for (Index j = 0; j < n; ++j) eliminate(j);
    for (Index j = n - 1; j >= 0; --j) substitute(j);
    for (Index k = 0; k < n; ++k) std::copy_n(segment(k), B, x + at(order[at(k)]) * std::size_t{B});
  }
  void solve(const Field<Scalar>& b, Field<Scalar>& x)
    requires(B == 3)
  {
    solve(b.front().data(), x.front().data());
  }

 private:
  static constexpr std::size_t width = B <= 4 ? 4 : 8;  // of a segment: what lies behind its B numbers is not used
  static constexpr std::size_t block_size = std::size_t{B} * B;
  using Segment = Register<Scalar, int{width}>;

  [[nodiscard]] Scalar* values(Index p) { return value_.data() + block_size * at(p); }
  [[nodiscard]] const Scalar* values(Index p) const { return value_.data() + block_size * at(p); }
  [[nodiscard]] Scalar* segment(Index k) { return work_.data() + at(k) * width; }

  /// The block at `a` times y.
  [[nodiscard]] COROTET_ALWAYS_INLINE static Segment product(const Scalar* a, const std::array<Scalar, width>& y) {
    Segment even(Scalar(0)), odd(Scalar(0));
    COROTET_UNROLL
    for (std::size_t c = 0; c < std::size_t{B}; ++c)
      (c % 2 == 0 ? even : odd) += Segment::load(a + B * c) * Segment(y[c]);
    return even + odd;
  }

  /// Forward: y_j = L_jj^-1 y_j, then y_i -= L_ij y_j below.
  void eliminate(Index j) {
    std::array<Scalar, width> y;
    Segment::load(segment(j)).store(y.data());
    const Segment done = product(values(column_start[at(j)]), y);
    done.store(y.data());
    done.store(segment(j));
    for (Index p = column_start[at(j)] + 1; p < column_start[at(j) + 1]; ++p) {
      Scalar* target = segment(row[at(p)]);
      (Segment::load(target) - product(values(p), y)).store(target);
    }
  }

  /// Backward: y_j = L_jj^-T (y_j - sum over i of L_ij^T y_i).
  void substitute(Index j) {
    std::array<Segment, std::size_t{B}> sum;
    sum.fill(Segment(Scalar(0)));
    for (Index p = column_start[at(j)] + 1; p < column_start[at(j) + 1]; ++p) add_transposed(p, row[at(p)], sum);
    Scalar* y = segment(j);
    COROTET_UNROLL
    for (std::size_t c = 0; c < std::size_t{B}; ++c) y[c] -= total(sum[c]);
    sum.fill(Segment(Scalar(0)));
    add_transposed(column_start[at(j)], j, sum);
    COROTET_UNROLL
    for (std::size_t c = 0; c < std::size_t{B}; ++c) y[c] = total(sum[c]);
  }

  /// sum_c += column c of block p, times y_i, number by number.
  COROTET_ALWAYS_INLINE void add_transposed(Index p, Index i, std::array<Segment, std::size_t{B}>& sum) {
    const Scalar* a = values(p);
    const Segment y = Segment::load(segment(i));
    COROTET_UNROLL
    for (std::size_t c = 0; c < std::size_t{B}; ++c) sum[c] += Segment::load(a + B * c) * y;
  }
  [[nodiscard]] COROTET_ALWAYS_INLINE static Scalar total(const Segment& s) {
    std::array<Scalar, width> part;
    s.store(part.data());
    Scalar sum = part[0];
    for (std::size_t r = 1; r < std::size_t{B}; ++r) sum += part[r];
    return sum;
  }

  detail::Buffer<Scalar> value_, work_;
};

}  // namespace corotet::inline v0_1
