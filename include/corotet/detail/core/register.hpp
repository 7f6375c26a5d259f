// A few numbers in one register: a 3-vector and one number more, or a column of a small matrix.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/buffer.hpp>
#include <corotet/detail/core/simd_pack.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstring>
#include <utility>

namespace corotet::inline v0_1 {

namespace detail {
inline namespace COROTET_ISA {

/// N numbers (a power of two) with the arithmetic of one. Loads and stores may be unaligned. Code that keeps fewer than
/// N numbers that matter in it reads N all the same, and lets those behind them reach nothing.
template <std::floating_point Scalar, int N>
class SimdVec {
 public:
  SimdVec() = default;
  /// The same number N times.
  COROTET_ALWAYS_INLINE SimdVec(Scalar value) : pack_(value) {}  // NOLINT(google-explicit-constructor): as a scalar

  [[nodiscard]] COROTET_ALWAYS_INLINE static SimdVec load(const Scalar* p) {
    SimdVec r;
    std::memcpy(&r.pack_, p, sizeof(r.pack_));
    return r;
  }
  /// N numbers of another precision.
  template <std::floating_point From>
  [[nodiscard]] COROTET_ALWAYS_INLINE static SimdVec load_converted(const From* p) {
    return SimdVec(detail::load_converted<Pack, Scalar>(p));
  }
  /// `count` numbers, and zeros: reads nothing behind them.
  template <int count>
  [[nodiscard]] COROTET_ALWAYS_INLINE static SimdVec load_part(const Scalar* p) {
    std::array<Scalar, std::size_t{N}> all{};
    for (std::size_t i = 0; i < std::size_t{count}; ++i) all[i] = p[i];
    return load(all.data());
  }
  COROTET_ALWAYS_INLINE void store(Scalar* p) const { std::memcpy(p, &pack_, sizeof(pack_)); }
  /// The first `count` numbers.
  template <int count>
  COROTET_ALWAYS_INLINE void store_part(Scalar* p) const {
    std::memcpy(p, &pack_, std::size_t{count} * sizeof(Scalar));
  }

  /// The first three of four, and zero.
  [[nodiscard]] COROTET_ALWAYS_INLINE SimdVec first_three() const
    requires(N == 4)
  {
    if constexpr (Whole<Pack>) {
      return SimdVec(Pack(detail::first_three(pack_.value)));
    } else {
      std::array<Scalar, 4> numbers;
      store(numbers.data());
      numbers[3] = 0;
      return load(numbers.data());
    }
  }

  COROTET_ALWAYS_INLINE SimdVec& operator+=(const SimdVec& b) { return *this = *this + b; }
  COROTET_ALWAYS_INLINE SimdVec& operator-=(const SimdVec& b) { return *this = *this - b; }

  friend COROTET_ALWAYS_INLINE SimdVec operator+(const SimdVec& a, const SimdVec& b) {
    return SimdVec(map<Pack>([](const auto& x, const auto& y) { return x + y; }, a.pack_, b.pack_));
  }
  friend COROTET_ALWAYS_INLINE SimdVec operator-(const SimdVec& a, const SimdVec& b) {
    return SimdVec(map<Pack>([](const auto& x, const auto& y) { return x - y; }, a.pack_, b.pack_));
  }
  friend COROTET_ALWAYS_INLINE SimdVec operator*(const SimdVec& a, const SimdVec& b) {
    return SimdVec(map<Pack>([](const auto& x, const auto& y) { return x * y; }, a.pack_, b.pack_));
  }

  /// The transpose of the 3x3 matrix with columns a, b, c, by columns with zeros behind them.
  friend COROTET_ALWAYS_INLINE std::array<SimdVec, 3> transposed(const SimdVec& a, const SimdVec& b, const SimdVec& c)
    requires(N == 4)
  {
    if constexpr (Whole<Pack>) {
      const auto rows = interleave4(a.pack_.value, b.pack_.value, c.pack_.value, Pack(Scalar(0)).value,
                                    std::make_integer_sequence<int, N>());
      return {SimdVec(Pack(rows[0])), SimdVec(Pack(rows[1])), SimdVec(Pack(rows[2]))};
    } else {
      std::array<std::array<Scalar, 4>, 3> m;
      a.store(m[0].data());
      b.store(m[1].data());
      c.store(m[2].data());
      const auto row = [&](std::size_t r) {
        const std::array<Scalar, 4> numbers{m[0][r], m[1][r], m[2][r], Scalar(0)};
        return load(numbers.data());
      };
      return {row(0), row(1), row(2)};
    }
  }

 private:
  using Pack = detail::Pack<Scalar, N>;
  COROTET_ALWAYS_INLINE explicit SimdVec(const Pack& pack) : pack_(pack) {}

  Pack pack_;
};

/// A 3-vector and one number more.
template <std::floating_point Scalar>
using Vec4 = SimdVec<Scalar, 4>;

}  // namespace COROTET_ISA
}  // namespace detail

/// A field in which each 3-vector has a zero behind it, so that it is loaded and stored as a Vec4.
template <std::floating_point Scalar>
struct alignas(4 * sizeof(Scalar)) PaddedVector : std::array<Scalar, 4> {
  /// The vector and its zero in one register.
  [[nodiscard]] COROTET_ALWAYS_INLINE detail::Vec4<Scalar> vec4() const {
    return detail::Vec4<Scalar>::load(this->data());
  }
  /// The fourth number of `q` must be zero.
  COROTET_ALWAYS_INLINE void set(const detail::Vec4<Scalar>& q) { q.store(this->data()); }
  /// Sets the vector, and the zero behind it.
  COROTET_ALWAYS_INLINE void set(const Vec3<Scalar>& v) {
    static_cast<std::array<Scalar, 4>&>(*this) = {v[0], v[1], v[2], 0};
  }
  /// The vector alone.
  [[nodiscard]] Vec3<Scalar> vector() const { return {(*this)[0], (*this)[1], (*this)[2]}; }
};
/// One padded vector a vertex.
template <std::floating_point Scalar>
using PaddedField = detail::Buffer<PaddedVector<Scalar>>;

}  // namespace corotet::inline v0_1
