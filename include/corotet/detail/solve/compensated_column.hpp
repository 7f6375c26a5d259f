// A column of a Cholesky factor that is made in double, although all columns are kept in float.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/register.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/small_cholesky.hpp>
#include <corotet/detail/solve/symbolic_factor.hpp>
#include <cstddef>

namespace corotet::inline v0_1::detail {

/// One column of L by blocks of 3x3, A = L L^T, where L is kept in Scalar, rounded: L = R + E. The blocks of R L^T are
/// computed in double from R. What the rounding takes from them, E R^T + R E^T, is as small as E: Scalar holds it with
/// almost as many digits again. It is added up in the places of those columns of R that are not made yet. So R is the
/// factor of double precision, rounded, to some 2^-46. (As compensated summation does it with sums: Kahan 1965.)
template <std::floating_point Scalar>
class CompensatedColumn {
 public:
  /// In memory of the caller's, aligned for double, of bytes_for(blocks): for columns of at most so many blocks.
  CompensatedColumn(std::byte* memory, std::size_t blocks)
      : number_(static_cast<double*>(static_cast<void*>(memory))),
        lost_(reinterpret_cast<Scalar*>(number_ + stride * blocks)) {}
  [[nodiscard]] static std::size_t bytes_for(std::size_t blocks) {
    return stride * blocks * sizeof(double) + (9 * blocks + 1) * sizeof(Scalar);
  }

  /// Sets the column to minus the `count` blocks at `lost`, which earlier columns have left there.
  void begin(const Scalar* lost, std::size_t count) {
    for (std::size_t p = 0; p < count; ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        double* const target = number_ + stride * p + 4 * c;
        for (std::size_t i = 0; i < 3; ++i) target[i] = -static_cast<double>(lost[9 * p + 3 * c + i]);
        target[3] = 0;
      }
  }

  /// Adds a block of A.
  void add(Index place, const Mat3<double>& a) {
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) number_[stride * at(place) + at(4 * c + i)] += a(i, c);
  }

  /// Subtracts R_ij R_kj^T for the `count` blocks of another column at `source`, the first of which is R_kj. Their rows
  /// are `row`, and have their place in this column in `place`.
  void subtract(const Scalar* source, const Index* row, Index count, const Index* place) {
    const Mat3<double> factor = Mat3<Scalar>::load(source).template cast<double>();
    for (Index p = 0; p < count; ++p) {
      double* const target = number_ + stride * at(place[row[p]]);
      std::array<Column, 3> sum{Column::load(target), Column::load(target + 4), Column::load(target + 8)};
      COROTET_UNROLL
      for (int r = 0; r < 3; ++r) {
        const Column column = Column::load_converted(source + 9 * at(p) + 3 * r);
        COROTET_UNROLL
        for (int c = 0; c < 3; ++c) sum[at(c)] -= column * Column(factor(c, r));
      }
      for (std::size_t c = 0; c < 3; ++c) sum[c].store(target + 4 * c);
    }
  }

  /// Writes the column to `out`: first the inverse of its block on the diagonal. Keeps what rounding takes from the
  /// others. False if the pivot is not positive definite.
  [[nodiscard]] bool finish(std::size_t count, Scalar* out) {
    Mat3<double> inverse;
    if (!inverse_cholesky(block(0), inverse)) return false;
    for (int i = 0; i < 9; ++i) out[i] = static_cast<Scalar>(inverse[i]);
    const Mat3<double> transposed = inverse.transpose();
    for (std::size_t p = 1; p < count; ++p) {
      const Mat3<double> exact = block(p) * transposed;
      for (std::size_t i = 0; i < 9; ++i) {
        const auto rounded = static_cast<Scalar>(exact[i]);
        out[9 * p + i] = rounded;
        lost_[9 * p + i] = static_cast<Scalar>(exact[i] - static_cast<double>(rounded));
      }
    }
    lost_[9 * count] = 0;  // is read with the last block
    return true;
  }

  /// Adds E_i R_j^T + R_i E_j^T to block (i, j) for all rows i >= j that this column has below its diagonal. `own`:
  /// this column as `finish` wrote it, with the rows `own_row`; `all`: the numbers of all columns.
  void compensate(const Scalar* own, const Index* own_row, std::size_t count, const SymbolicFactor& factor,
                  Scalar* all) const {
    const Index* const row = factor.row.data();
    using Q = Vec4<Scalar>;
    for (std::size_t b = 1; b < count; ++b) {
      const Scalar *const rounded = own + 9 * b, *const lost = lost_ + 9 * b;
      Index place = factor.column_start[at(own_row[b])];
      for (std::size_t a = b; a < count; ++a) {
        while (row[place] != own_row[a]) ++place;
        Scalar* const target = all + 9 * at(place);
        std::array<Q, 3> sum{Q::load(target), Q::load(target + 3), Q::load(target + 6)};
        COROTET_UNROLL
        for (std::size_t r = 0; r < 3; ++r) {
          const Q e = Q::load(lost_ + 9 * a + 3 * r), l = Q::load(own + 9 * a + 3 * r);
          COROTET_UNROLL
          for (std::size_t c = 0; c < 3; ++c) sum[c] += e * Q(rounded[3 * r + c]) + l * Q(lost[3 * r + c]);
        }
        sum[0].store(target);  // and one number more, which the next store corrects
        sum[1].store(target + 3);
        sum[2].template store_part<3>(target + 6);
      }
    }
  }

 private:
  using Column = SimdVec<double, 4>;  // of a 3x3 block, and a number without meaning
  static constexpr std::size_t stride = 12;

  [[nodiscard]] Mat3<double> block(std::size_t p) const {
    Mat3<double> m;
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) m(i, c) = number_[stride * p + at(4 * c + i)];
    return m;
  }

  double* number_;
  Scalar* lost_;  // E
};

}  // namespace corotet::inline v0_1::detail
