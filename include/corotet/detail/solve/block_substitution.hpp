// Solving with a Cholesky factor by small blocks.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// Substitutions with L, whose blocks on the diagonal are inverted, by columns (Davis 2006, "Direct Methods for Sparse
/// Linear Systems", section 3.2).
template <std::floating_point Scalar, int B>
class BlockSubstitution {
 public:
  static constexpr std::size_t width = B <= 4 ? 4 : 8;  ///< of a segment: B numbers, and any behind them

  /// `value`: the numbers of the blocks of L. `segment`: those of the right side, in the order of elimination.
  BlockSubstitution(const SymbolicFactor& factor, const Scalar* value, Scalar* segment)
      : start_(factor.column_start.data()),
        row_(factor.row.data()),
        rows_(factor.rows()),
        value_(value),
        segment_(segment) {}

  /// Replaces the right side by the solution of L L^T x = b.
  void solve() {
    for (Index j = 0; j < rows_; ++j) eliminate(j);
    for (Index j = rows_ - 1; j >= 0; --j) substitute(j);
  }

 private:
  using Segment = SimdVec<Scalar, int{width}>;

  [[nodiscard]] Scalar* segment(Index k) const { return segment_ + at(k) * width; }
  [[nodiscard]] const Scalar* values(Index p) const { return value_ + std::size_t{B} * B * at(p); }

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
    const Segment done = product(values(start_[j]), y);
    done.store(y.data());
    done.store(segment(j));
    for (Index p = start_[j] + 1; p < start_[j + 1]; ++p) {
      Scalar* target = segment(row_[p]);
      (Segment::load(target) - product(values(p), y)).store(target);
    }
  }

  /// Backward: y_j = L_jj^-T (y_j - sum over i of L_ij^T y_i).
  void substitute(Index j) {
    std::array<Segment, std::size_t{B}> sum;
    sum.fill(Segment(Scalar(0)));
    for (Index p = start_[j] + 1; p < start_[j + 1]; ++p) add_transposed(p, row_[p], sum);
    Scalar* y = segment(j);
    COROTET_UNROLL
    for (std::size_t c = 0; c < std::size_t{B}; ++c) y[c] -= total(sum[c]);
    sum.fill(Segment(Scalar(0)));
    add_transposed(start_[j], j, sum);
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

  const Index *start_, *row_;
  Index rows_;
  const Scalar* value_;
  Scalar* segment_;
};

}  // namespace corotet::inline v0_1::detail
