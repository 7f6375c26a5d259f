// Batches: the same quantity of several elements side by side, so that one instruction serves all of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <corotet/detail/core/simd_pack.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <cstddef>
#include <cstring>
#include <utility>

namespace corotet::inline v0_1::inline COROTET_ISA {

/// Elements in a batch: 16 in float, 8 in double (64 bytes). The same on every machine, whatever its vector width, so
/// that layout does not depend on compiler flags. (Results may, in the last bit: -mfma fuses products and sums.)
template <std::floating_point Scalar>
inline constexpr int lane_count = sizeof(Scalar) <= 4 ? 16 : 8;

/// One truth value of each element in a batch.
template <std::floating_point Scalar>
class alignas(64) LaneMask {
 public:
  using Integer = detail::MaskInteger<Scalar>;             ///< as wide as a Scalar: -1 for true, 0 for false
  using Bits = detail::Pack<Integer, lane_count<Scalar>>;  ///< all lanes

  /// Of the bits of all lanes.
  COROTET_ALWAYS_INLINE explicit LaneMask(const Bits& bits) : bits_(bits) {}

  /// The bits of all lanes.
  [[nodiscard]] const Bits& bits() const { return bits_; }
  /// Whether lane `lane` is true.
  [[nodiscard]] bool operator[](int lane) const {
    return std::bit_cast<std::array<Integer, lane_count<Scalar>>>(bits_)[at(lane)] != 0;
  }
  /// Whether all lanes are true.
  [[nodiscard]] bool all() const {
    Integer both = -1;
    for (const Integer bit : std::bit_cast<std::array<Integer, lane_count<Scalar>>>(bits_)) both &= bit;
    return both != 0;
  }
  /// Whether any lane is true.
  [[nodiscard]] bool any() const {
    Integer either = 0;
    for (const Integer bit : std::bit_cast<std::array<Integer, lane_count<Scalar>>>(bits_)) either |= bit;
    return either != 0;
  }

  friend COROTET_ALWAYS_INLINE LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    return LaneMask(detail::map<Bits>([](const auto& x, const auto& y) { return x & y; }, a.bits_, b.bits_));
  }

 private:
  Bits bits_;
};

/// One scalar of each element in a batch, with the arithmetic of a scalar, lane by lane.
template <std::floating_point Scalar>
class alignas(64) Lanes {
 public:
  static constexpr int size = lane_count<Scalar>;         ///< numbers
  using Mask = LaneMask<Scalar>;                          ///< what comparisons give
  using Numbers = std::array<Scalar, std::size_t{size}>;  ///< one a lane

  Lanes() = default;
  /// The same number in all lanes.
  COROTET_ALWAYS_INLINE Lanes(Scalar value) : pack_(value) {}  // NOLINT(google-explicit-constructor): as a scalar

  /// The number in lane `lane`.
  [[nodiscard]] Scalar operator[](int lane) const { return values()[at(lane)]; }
  /// The numbers of all lanes.
  [[nodiscard]] Numbers values() const { return std::bit_cast<Numbers>(pack_); }
  /// Sets the number in lane `lane`.
  void set(int lane, Scalar value) {
    std::memcpy(reinterpret_cast<char*>(&pack_) + at(lane) * sizeof(Scalar), &value, sizeof(Scalar));
  }

  /// Lane by lane, as the operators below.
  COROTET_ALWAYS_INLINE Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  /// Lane by lane.
  COROTET_ALWAYS_INLINE Lanes& operator-=(const Lanes& b) { return *this = *this - b; }

  friend COROTET_ALWAYS_INLINE Lanes operator+(const Lanes& a, const Lanes& b) {
    return map([](const auto& x, const auto& y) { return x + y; }, a, b);
  }
  friend COROTET_ALWAYS_INLINE Lanes operator-(const Lanes& a, const Lanes& b) {
    return map([](const auto& x, const auto& y) { return x - y; }, a, b);
  }
  friend COROTET_ALWAYS_INLINE Lanes operator*(const Lanes& a, const Lanes& b) {
    return map([](const auto& x, const auto& y) { return x * y; }, a, b);
  }
  friend COROTET_ALWAYS_INLINE Lanes operator/(const Lanes& a, const Lanes& b) {
    return map([](const auto& x, const auto& y) { return x / y; }, a, b);
  }
  friend COROTET_ALWAYS_INLINE Lanes operator-(const Lanes& a) {
    return map([](const auto& x) { return -x; }, a);
  }
  friend COROTET_ALWAYS_INLINE Mask operator<(const Lanes& a, const Lanes& b) {
    constexpr auto less = [](const auto& x, const auto& y) {
      if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(x)>>)
        return static_cast<typename Mask::Integer>(x < y ? -1 : 0);
      else
        return x < y;
    };
    return Mask(detail::map<typename Mask::Bits>(less, a.pack_, b.pack_));
  }
  friend COROTET_ALWAYS_INLINE Mask operator>(const Lanes& a, const Lanes& b) { return b < a; }

  /// a where the mask is true, b elsewhere.
  friend COROTET_ALWAYS_INLINE Lanes select(const Mask& mask, const Lanes& a, const Lanes& b) {
    return Lanes(detail::map<Pack>([](const auto& x, const auto& y, const auto& m) { return m ? x : y; }, a.pack_,
                                   b.pack_, mask.bits()));
  }
  friend COROTET_ALWAYS_INLINE Lanes lane_max(const Lanes& a, const Lanes& b) { return select(b < a, a, b); }
  friend COROTET_ALWAYS_INLINE Lanes lane_min(const Lanes& a, const Lanes& b) { return select(a < b, a, b); }
  friend COROTET_ALWAYS_INLINE Lanes lane_abs(const Lanes& a) { return select(a < Lanes(0), -a, a); }
  friend Lanes sqrt(const Lanes& a) {
    Numbers root = a.values();
    detail::take_square_roots(root);
    return Lanes(std::bit_cast<Pack>(root));
  }

  /// Writes (x, y, z, w) of lane l to the four numbers at `out + l * stride`, for each lane < count.
  friend COROTET_ALWAYS_INLINE void store_side_by_side(const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w,
                                                       Scalar* out, std::size_t stride, int count) {
    interleave_and_store(x.pack_, y.pack_, z.pack_, w.pack_, out, stride, count);
  }

 private:
  using Pack = detail::Pack<Scalar, size>;

  template <class P>
  COROTET_ALWAYS_INLINE static void interleave_and_store(const P& x, const P& y, const P& z, const P& w, Scalar* out,
                                                         std::size_t stride, int count) {
    constexpr int lanes = sizeof(P) / sizeof(Scalar);
    if constexpr (lanes < 4) {
      std::array<std::array<Scalar, std::size_t{lanes}>, 4> part;
      const std::array<const P*, 4> source{&x, &y, &z, &w};
      for (std::size_t i = 0; i < 4; ++i) std::memcpy(part[i].data(), source[i], sizeof(P));
      for (int l = 0; l < (std::min)(lanes, count); ++l)
        for (std::size_t i = 0; i < 4; ++i) out[at(l) * stride + i] = part[i][at(l)];
    } else if constexpr (detail::Whole<P>) {
      const auto quads =
          detail::interleave4(x.value, y.value, z.value, w.value, std::make_integer_sequence<int, lanes>());
      if (count >= lanes) {
        detail::store_quads(quads, out, stride, std::make_integer_sequence<int, lanes>());
      } else {
        for (int l = 0; l < count; ++l)
          std::memcpy(out + at(l) * stride, reinterpret_cast<const Scalar*>(&quads[at(l % 4)]) + l / 4 * 4,
                      4 * sizeof(Scalar));
      }
    } else {
      interleave_and_store(x.low, y.low, z.low, w.low, out, stride, count);
      interleave_and_store(x.high, y.high, z.high, w.high, out + at(lanes / 2) * stride, stride, count - lanes / 2);
    }
  }

  COROTET_ALWAYS_INLINE explicit Lanes(const Pack& pack) : pack_(pack) {}

  template <class Function, class... L>
  COROTET_ALWAYS_INLINE static Lanes map(const Function& f, const L&... lanes) {
    return Lanes(detail::map<Pack>(f, lanes.pack_...));
  }

  Pack pack_;
};

/// A 3-vector of each element in a batch: [component], lane.
template <std::floating_point Scalar>
using Vec3Lanes = std::array<Lanes<Scalar>, 3>;

/// A 3x3 matrix of each element in a batch: (row, column), lane.
template <std::floating_point Scalar>
struct Mat3Lanes {
  std::array<std::array<Lanes<Scalar>, 3>, 3> entry;  ///< [row][column]

  /// The entry of all lanes.
  [[nodiscard]] COROTET_ALWAYS_INLINE Lanes<Scalar>& operator()(int row, int column) {
    return entry[at(row)][at(column)];
  }
  /// The same, read-only.
  [[nodiscard]] COROTET_ALWAYS_INLINE const Lanes<Scalar>& operator()(int row, int column) const {
    return entry[at(row)][at(column)];
  }

  /// The matrix in one lane.
  [[nodiscard]] Mat3<Scalar> lane(int l) const {
    Mat3<Scalar> m;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m(r, c) = (*this)(r, c)[l];
    return m;
  }

  /// Sets the matrix in lane `l`.
  void set_lane(int l, const Mat3<Scalar>& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) (*this)(r, c).set(l, m(r, c));
  }
};

/// The determinant in each lane.
template <std::floating_point Scalar>
[[nodiscard]] Lanes<Scalar> determinant(const Mat3Lanes<Scalar>& m) {
  return m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1)) - m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0)) +
         m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
}

/// Sets `ab` to a b.
template <std::floating_point Scalar>
void product(const Mat3Lanes<Scalar>& a, const Mat3Lanes<Scalar>& b, Mat3Lanes<Scalar>& ab) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) ab(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
}

/// a b^T.
template <std::floating_point Scalar>
void product_with_transpose(const Mat3Lanes<Scalar>& a, const Mat3Lanes<Scalar>& b, Mat3Lanes<Scalar>& abt) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) abt(i, j) = a(i, 0) * b(j, 0) + a(i, 1) * b(j, 1) + a(i, 2) * b(j, 2);
}

}  // namespace corotet::inline v0_1::inline COROTET_ISA
