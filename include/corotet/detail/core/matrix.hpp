// Small matrices of fixed size: what is computed with 3-vectors, 3x3 blocks and 6x6 blocks.
#pragma once

#include <cmath>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <cstddef>

namespace corotet::inline v0_1 {

// NOLINTBEGIN(readability-identifier-naming): as in Eigen

template <std::floating_point T, int R, int C>
struct Matrix;

namespace detail {

/// A matrix of Eigen's, or an expression of such, of this size. Known by its interface: Eigen is not included.
template <class E, int R, int C>
concept EigenMatrix = requires(const E& e) {
  e.derived().eval().coeff(0, 0);
  requires int { E::RowsAtCompileTime }
  == R&& int{E::ColsAtCompileTime} == C;
};

/// A matrix of Eigen's of this size that holds its own numbers.
template <class E, class T, int R, int C>
concept EigenStorage =
    EigenMatrix<E, R, C> && std::same_as<typename E::PlainObject, E> && std::same_as<typename E::Scalar, T>;

}  // namespace detail

/// R x C numbers by columns, without padding: the same layout with every compiler flag. Members are named as Eigen's
/// are and mean the same, but every operation returns numbers, not an expression to be evaluated later: it compiles in
/// a fraction of the time, runs at a usable speed without optimisation, and sums in one order everywhere. Matrices of
/// Eigen's of the same size convert to this type and from it.
template <std::floating_point T, int R, int C>
struct Matrix {
  static constexpr int size_at_compile_time = R * C;  ///< numbers
  using Scalar = T;                                   ///< float or double

  /// Holds no numbers yet.
  Matrix() = default;
  Matrix(const Matrix&) = default;
  Matrix(Matrix&&) noexcept = default;
  // Not to a temporary: `m.col(0) = v` would be lost.
  Matrix& operator=(const Matrix&) & = default;
  Matrix& operator=(Matrix&&) & noexcept = default;
  ~Matrix() = default;
  /// Of the numbers, by columns.
  constexpr Matrix(T x, T y)
    requires(R* C == 2)
      : value_{x, y} {}
  /// The same for three numbers.
  constexpr Matrix(T x, T y, T z)
    requires(R* C == 3)
      : value_{x, y, z} {}
  /// The same for four numbers.
  constexpr Matrix(T x, T y, T z, T w)
    requires(R* C == 4)
      : value_{x, y, z, w} {}
  /// Of an Eigen matrix or expression of the same size and numbers.
  template <class E>
    requires detail::EigenMatrix<E, R, C> && std::same_as<typename E::Scalar, T>
  Matrix(const E& e) {  // NOLINT(google-explicit-constructor): the same numbers
    const auto& numbers = e.derived().eval();
    for (int c = 0; c < C; ++c)
      for (int r = 0; r < R; ++r) (*this)(r, c) = numbers.coeff(r, c);
  }
  /// To an Eigen matrix of the same size and numbers.
  template <class E>
    requires detail::EigenStorage<E, T, R, C>
  operator E() const {  // NOLINT(google-explicit-constructor): the same numbers
    E e;
    for (int c = 0; c < C; ++c)
      for (int r = 0; r < R; ++r) e.coeffRef(r, c) = (*this)(r, c);
    return e;
  }

  /// All entries the same.
  [[nodiscard]] static constexpr Matrix Constant(T value) {
    Matrix m;
    for (T& x : m.value_) x = value;
    return m;
  }
  [[nodiscard]] static constexpr Matrix Zero() { return Matrix{Numbers{}}; }  ///< all entries 0
  [[nodiscard]] static constexpr Matrix Ones() { return Constant(T(1)); }     ///< all entries 1
  /// 1 on the diagonal, 0 elsewhere.
  [[nodiscard]] static constexpr Matrix Identity() {
    Matrix m = Zero();
    for (int i = 0; i < R && i < C; ++i) m(i, i) = T(1);
    return m;
  }
  [[nodiscard]] static constexpr Matrix UnitX() { return unit(0); }  ///< entry 0 is 1, the others 0
  [[nodiscard]] static constexpr Matrix UnitY() { return unit(1); }  ///< entry 1 is 1, the others 0
  [[nodiscard]] static constexpr Matrix UnitZ() { return unit(2); }  ///< entry 2 is 1, the others 0
  /// The numbers that lie there, by columns.
  [[nodiscard]] static COROTET_ALWAYS_INLINE Matrix load(const T* numbers) {
    Matrix m;
    if constexpr (R * C <= 16) {
      COROTET_UNROLL
      for (int i = 0; i < R * C; ++i) m.value_[i] = numbers[i];
    } else {
      for (int i = 0; i < R * C; ++i) m.value_[i] = numbers[i];
    }
    return m;
  }

  [[nodiscard]] static constexpr int rows() { return R; }           ///< R
  [[nodiscard]] static constexpr int cols() { return C; }           ///< C
  [[nodiscard]] static constexpr int size() { return R * C; }       ///< R C
  [[nodiscard]] constexpr T* data() { return value_; }              ///< the numbers, by columns
  [[nodiscard]] constexpr const T* data() const { return value_; }  ///< the numbers, by columns

  /// The entry in a row and a column, from 0.
  [[nodiscard]] constexpr T& operator()(int row, int column) { return value_[column * R + row]; }
  /// The same, read-only.
  [[nodiscard]] constexpr const T& operator()(int row, int column) const { return value_[column * R + row]; }
  /// Number i, by columns.
  template <std::integral Subscript>
  [[nodiscard]] constexpr T& operator[](Subscript i) {
    return value_[i];
  }
  /// The same, read-only.
  template <std::integral Subscript>
  [[nodiscard]] constexpr const T& operator[](Subscript i) const {
    return value_[i];
  }
  /// The same as operator[].
  template <std::integral Subscript>
  [[nodiscard]] constexpr T& operator()(Subscript i) {
    return value_[i];
  }
  /// The same as operator[].
  template <std::integral Subscript>
  [[nodiscard]] constexpr const T& operator()(Subscript i) const {
    return value_[i];
  }
  [[nodiscard]] constexpr T& x() { return value_[0]; }                     ///< number 0
  [[nodiscard]] constexpr T& y() { return value_[1]; }                     ///< number 1
  [[nodiscard]] constexpr T& z() { return value_[2]; }                     ///< number 2
  [[nodiscard]] constexpr T& w() { return value_[3]; }                     ///< number 3
  [[nodiscard]] constexpr const T& x() const { return value_[0]; }         ///< number 0
  [[nodiscard]] constexpr const T& y() const { return value_[1]; }         ///< number 1
  [[nodiscard]] constexpr const T& z() const { return value_[2]; }         ///< number 2
  [[nodiscard]] constexpr const T& w() const { return value_[3]; }         ///< number 3
  [[nodiscard]] constexpr const T* begin() const { return value_; }        ///< the first number
  [[nodiscard]] constexpr const T* end() const { return value_ + R * C; }  ///< behind the last number
  [[nodiscard]] constexpr T* begin() { return value_; }                    ///< the first number
  [[nodiscard]] constexpr T* end() { return value_ + R * C; }              ///< behind the last number

  /// Adds b.
  COROTET_ALWAYS_INLINE constexpr Matrix& operator+=(const Matrix& b) & {
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) value_[i] += b.value_[i];
    return *this;
  }
  /// Subtracts b.
  COROTET_ALWAYS_INLINE constexpr Matrix& operator-=(const Matrix& b) & {
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) value_[i] -= b.value_[i];
    return *this;
  }
  /// Multiplies every entry.
  COROTET_ALWAYS_INLINE constexpr Matrix& operator*=(T factor) & {
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) value_[i] *= factor;
    return *this;
  }
  /// Divides every entry.
  COROTET_ALWAYS_INLINE constexpr Matrix& operator/=(T divisor) & {
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) value_[i] /= divisor;
    return *this;
  }
  /// Multiplies by b from the right.
  constexpr Matrix& operator*=(const Matrix& b) & requires(R == C && R > 1) {
    return *this = *this * b;
  } friend COROTET_ALWAYS_INLINE constexpr Matrix operator+(Matrix a, const Matrix& b) {
    return a += b;
  }
  friend COROTET_ALWAYS_INLINE constexpr Matrix operator-(Matrix a, const Matrix& b) { return a -= b; }
  friend COROTET_ALWAYS_INLINE constexpr Matrix operator-(Matrix a) { return a *= T(-1); }
  friend COROTET_ALWAYS_INLINE constexpr Matrix operator*(Matrix a, T factor) { return a *= factor; }
  friend COROTET_ALWAYS_INLINE constexpr Matrix operator*(T factor, Matrix a) { return a *= factor; }
  friend COROTET_ALWAYS_INLINE constexpr Matrix operator/(Matrix a, T divisor) { return a /= divisor; }
  friend constexpr bool operator==(const Matrix& a, const Matrix& b) {
    for (int i = 0; i < R * C; ++i)
      if (!detail::exactly_equal(a.value_[i], b.value_[i])) return false;
    return true;
  }

  /// The same numbers in another precision.
  template <std::floating_point U>
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<U, R, C> cast() const {
    Matrix<U, R, C> m;
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) m[i] = static_cast<U>(value_[i]);
    return m;
  }
  /// Rows become columns.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, C, R> transpose() const {
    Matrix<T, C, R> m;
    if constexpr (R * C <= 16) {
      COROTET_UNROLL
      for (int c = 0; c < C; ++c) {
        COROTET_UNROLL
        for (int r = 0; r < R; ++r) m(c, r) = (*this)(r, c);
      }
    } else {
      for (int c = 0; c < C; ++c)
        for (int r = 0; r < R; ++r) m(c, r) = (*this)(r, c);
    }
    return m;
  }

  /// Of h rows and w columns from (row, column) on.
  template <int h, int w>
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, h, w> block(int row, int column) const {
    Matrix<T, h, w> m;
    COROTET_UNROLL
    for (int c = 0; c < w; ++c) {
      COROTET_UNROLL
      for (int r = 0; r < h; ++r) m(r, c) = (*this)(row + r, column + c);
    }
    return m;
  }
  /// Writes `m` over the block that begins at (row, column).
  template <int h, int w>
  COROTET_ALWAYS_INLINE constexpr void set_block(int row, int column, const Matrix<T, h, w>& m) {
    COROTET_UNROLL
    for (int c = 0; c < w; ++c) {
      COROTET_UNROLL
      for (int r = 0; r < h; ++r) (*this)(row + r, column + c) = m(r, c);
    }
  }
  /// A column.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, R, 1> col(int c) const { return block<R, 1>(0, c); }
  /// A row.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, 1, C> row(int r) const { return block<1, C>(r, 0); }
  /// Replaces a column.
  COROTET_ALWAYS_INLINE constexpr void set_col(int c, const Matrix<T, R, 1>& v) { set_block(0, c, v); }
  /// Replaces a row.
  COROTET_ALWAYS_INLINE constexpr void set_row(int r, const Matrix<T, 1, C>& v) { set_block(r, 0, v); }
  /// The first n numbers of a vector.
  template <int n>
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, n, 1> head() const
    requires(C == 1)
  {
    return block<n, 1>(0, 0);
  }
  /// The last n numbers of a vector.
  template <int n>
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, n, 1> tail() const
    requires(C == 1)
  {
    return block<n, 1>(R - n, 0);
  }
  /// Entries (i, i), as a column.
  [[nodiscard]] constexpr Matrix<T, R, 1> diagonal() const
    requires(R == C)
  {
    Matrix<T, R, 1> d;
    for (int i = 0; i < R; ++i) d[i] = (*this)(i, i);
    return d;
  }

  /// The sum of all entries.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr T sum() const {
    T total = value_[0];
    COROTET_UNROLL
    for (int i = 1; i < R * C; ++i) total += value_[i];
    return total;
  }
  [[nodiscard]] constexpr T trace() const { return diagonal().sum(); }  ///< the sum of entries (i, i)
  /// The sum of products of entries at the same place.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr T dot(const Matrix& b) const {
    T total = value_[0] * b.value_[0];
    COROTET_UNROLL
    for (int i = 1; i < R * C; ++i) total += value_[i] * b.value_[i];
    return total;
  }
  /// The sum of squares of all entries.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr T squaredNorm() const { return dot(*this); }
  /// Euclidean, of a matrix that of Frobenius.
  [[nodiscard]] T norm() const { return detail::square_root(squaredNorm()); }
  /// The same for numbers whose squares leave the range of T.
  [[nodiscard]] T stableNorm() const {
    const T largest = cwiseAbs().maxCoeff();
    return largest > 0 && std::isfinite(largest) ? largest * (*this / largest).norm() : largest;
  }
  /// Of length 1; zero stays zero.
  [[nodiscard]] Matrix normalized() const {
    const T length = norm();
    return length > 0 ? *this / length : *this;
  }
  void normalize() { *this = normalized(); }  ///< to length 1; zero stays zero
  /// The same as normalized() for numbers whose squares leave the range of T.
  [[nodiscard]] Matrix stableNormalized() const {
    const T largest = cwiseAbs().maxCoeff();
    return largest > 0 ? (*this / largest).normalized() : *this;
  }

  /// The smaller of each two entries.
  [[nodiscard]] constexpr Matrix cwiseMin(const Matrix& b) const {
    return each([](T p, T q) { return q < p ? q : p; }, b);
  }
  /// The larger of each two entries.
  [[nodiscard]] constexpr Matrix cwiseMax(const Matrix& b) const {
    return each([](T p, T q) { return p < q ? q : p; }, b);
  }
  /// The larger of each entry and b.
  [[nodiscard]] constexpr Matrix cwiseMax(T b) const { return cwiseMax(Constant(b)); }
  /// Products of entries at the same place.
  [[nodiscard]] constexpr Matrix cwiseProduct(const Matrix& b) const {
    return each([](T p, T q) { return p * q; }, b);
  }
  /// The absolute value of each entry.
  [[nodiscard]] constexpr Matrix cwiseAbs() const {
    return each([](T p, T) { return p < 0 ? -p : p; }, *this);
  }
  /// The smallest entry.
  [[nodiscard]] constexpr T minCoeff() const {
    T least = value_[0];
    for (int i = 1; i < R * C; ++i)
      if (value_[i] < least) least = value_[i];
    return least;
  }
  [[nodiscard]] constexpr T maxCoeff() const { return value_[index_of_max()]; }  ///< the largest entry
  /// Where the largest number stands, by columns; the first of equals.
  [[nodiscard]] constexpr int index_of_max() const {
    int best = 0;
    for (int i = 1; i < R * C; ++i)
      if (value_[best] < value_[i]) best = i;
    return best;
  }
  /// Whether no entry is infinite or not a number.
  [[nodiscard]] bool allFinite() const {
    bool finite = true;
    for (int i = 0; i < R * C; ++i) finite = finite && std::isfinite(value_[i]);
    return finite;
  }
  [[nodiscard]] constexpr bool isZero() const { return *this == Zero(); }  ///< whether every entry is 0
  void setZero() { *this = Zero(); }                                       ///< every entry

  /// The cross product with b.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix cross(const Matrix& b) const
    requires(R* C == 3)
  {
    return {value_[1] * b[2] - value_[2] * b[1], value_[2] * b[0] - value_[0] * b[2],
            value_[0] * b[1] - value_[1] * b[0]};
  }
  /// One of length 1 that is perpendicular to this, which is not zero.
  [[nodiscard]] Matrix unitOrthogonal() const
    requires(R == 3 && C == 1)
  {
    // Across the axis that is farthest from it.
    int least = 0;
    for (int i = 1; i < 3; ++i)
      if (std::fabs(value_[i]) < std::fabs(value_[least])) least = i;
    return cross(unit(least)).normalized();
  }
  /// Of a 3x3 matrix.
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr T determinant() const
    requires(R == 3 && C == 3)
  {
    return col(0).dot(col(1).cross(col(2)));
  }
  /// Of a 3x3 matrix whose determinant is not 0.
  [[nodiscard]] constexpr Matrix inverse() const
    requires(R == 3 && C == 3)
  {
    Matrix m;  // rows: cross products of columns
    m.set_row(0, col(1).cross(col(2)).transpose());
    m.set_row(1, col(2).cross(col(0)).transpose());
    m.set_row(2, col(0).cross(col(1)).transpose());
    return m * (T(1) / determinant());
  }

 private:
  struct Numbers {};
  constexpr explicit Matrix(Numbers) : value_{} {}

  [[nodiscard]] static constexpr Matrix unit(int i) {
    Matrix m = Zero();
    m[i] = T(1);
    return m;
  }
  template <class F>
  [[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix each(F f, const Matrix& b) const {
    Matrix m;
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) m.value_[i] = f(value_[i], b.value_[i]);
    return m;
  }

  T value_[std::size_t{R * C}];
};

/// The product of matrices.
template <class T, int R, int K, int C>
[[nodiscard]] COROTET_ALWAYS_INLINE constexpr Matrix<T, R, C> operator*(const Matrix<T, R, K>& a,
                                                                        const Matrix<T, K, C>& b) {
  Matrix<T, R, C> ab;
  const auto set = [&](int r, int c) {
    T sum = a(r, 0) * b(0, c);
    COROTET_UNROLL
    for (int k = 1; k < K; ++k) sum += a(r, k) * b(k, c);
    ab(r, c) = sum;
  };
  if constexpr (R * K * C <= 64) {
    COROTET_UNROLL
    for (int c = 0; c < C; ++c) {
      COROTET_UNROLL
      for (int r = 0; r < R; ++r) set(r, c);
    }
  } else {  // as many lines again would take longer to fetch than they save
    for (int c = 0; c < C; ++c)
      for (int r = 0; r < R; ++r) set(r, c);
  }
  return ab;
}

namespace detail {

/// R x C numbers that lie in a larger array, by columns: a matrix to write to.
template <std::floating_point T, int R, int C>
class MatrixView {
 public:
  using Value = Matrix<T, R, C>;

  explicit MatrixView(T* numbers) : numbers_(numbers) {}
  MatrixView(const MatrixView&) = default;
  ~MatrixView() = default;
  COROTET_ALWAYS_INLINE const MatrixView& operator=(const Value& m) const {
    COROTET_UNROLL
    for (int i = 0; i < R * C; ++i) numbers_[i] = m[i];
    return *this;
  }
  // NOLINTNEXTLINE(bugprone-unhandled-self-assignment): copies numbers onto themselves
  COROTET_ALWAYS_INLINE MatrixView& operator=(const MatrixView& m) {
    *this = m.value();
    return *this;
  }
  COROTET_ALWAYS_INLINE const MatrixView& operator+=(const Value& m) const { return *this = value() + m; }
  COROTET_ALWAYS_INLINE const MatrixView& operator-=(const Value& m) const { return *this = value() - m; }
  void setZero() const { *this = Value::Zero(); }

  [[nodiscard]] COROTET_ALWAYS_INLINE Value value() const { return Value::load(numbers_); }
  COROTET_ALWAYS_INLINE operator Value() const { return value(); }  // NOLINT(google-explicit-constructor): as a matrix
  [[nodiscard]] COROTET_ALWAYS_INLINE T& operator()(int row, int column) const { return numbers_[column * R + row]; }
  [[nodiscard]] COROTET_ALWAYS_INLINE Matrix<T, C, R> transpose() const { return value().transpose(); }

 private:
  T* numbers_;
};

}  // namespace detail

// NOLINTEND(readability-identifier-naming)

}  // namespace corotet::inline v0_1
