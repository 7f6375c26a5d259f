// A fixed number of values that the compiler keeps in vector registers of whatever width it is allowed to use.
#pragma once

#include <array>
#include <concepts>
#include <corotet/detail/core/compiler.hpp>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

// The vector extension of GCC and Clang costs almost no compile time (the same expressions over Eigen arrays took
// several times as long). Elsewhere a value stands alone, and the optimiser finds the vectors as well as it can. The
// layout is the same everywhere.

namespace corotet::inline v0_1::detail::inline COROTET_ISA {

/// Bytes in the widest register.
#if !defined(__GNUC__)
inline constexpr int register_bytes = 0;
#elif defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

/// N values as two halves, down to what a register holds: GCC 12 spills vectors that are wider than its registers.
template <class T, int N>
struct Pack {
  Pack<T, N / 2> low, high;
  Pack() = default;
  COROTET_ALWAYS_INLINE Pack(const Pack<T, N / 2>& l, const Pack<T, N / 2>& h) : low(l), high(h) {}
  COROTET_ALWAYS_INLINE explicit Pack(T value) : low(value), high(value) {}
};

#if defined(__GNUC__)
template <class T, int N>
  requires(N* int{sizeof(T)} <= register_bytes)
struct Pack<T, N> {
  typedef T Native __attribute__((vector_size(N * sizeof(T))));  // NOLINT(modernize-use-using): clang takes it so only
  Native value;
  Pack() = default;
  COROTET_ALWAYS_INLINE Pack(const Native& v) : value(v) {}  // NOLINT(google-explicit-constructor)
  COROTET_ALWAYS_INLINE explicit Pack(T v) : value(v - Native{}) {}
};
#else
template <class T>
struct Pack<T, 1> {
  T value;
  Pack() = default;
  explicit Pack(T v) : value(v) {}
};
#endif

template <class P>
concept Whole = requires(const P& p) { p.value; };

/// Integers of the size of T, -1 for true and 0 for false: what comparing gives.
template <class T>
using MaskInteger = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

#if defined(__GNUC__)
/// Four values of T for each of N items, given as one pack a value, in the order in which each item's four lie side by
/// side: out[k] holds items k, 4 + k, 8 + k, ... Each register of the pack must hold four values or more.
template <class V, int... i>
[[nodiscard]] COROTET_ALWAYS_INLINE std::array<V, 4> interleave4(const V& x, const V& y, const V& z, const V& w,
                                                                 std::integer_sequence<int, i...>) {
  constexpr int n = sizeof...(i);
  // Within each group of four: x0 y0 x1 y1, x2 y2 x3 y3, and the same of z and w; then halves side by side.
  const V a = __builtin_shufflevector(x, y, (i / 4 * 4 + i % 4 / 2 + i % 2 * n)...);
  const V b = __builtin_shufflevector(x, y, (i / 4 * 4 + 2 + i % 4 / 2 + i % 2 * n)...);
  const V c = __builtin_shufflevector(z, w, (i / 4 * 4 + i % 4 / 2 + i % 2 * n)...);
  const V d = __builtin_shufflevector(z, w, (i / 4 * 4 + 2 + i % 4 / 2 + i % 2 * n)...);
  const auto low = [](const V& p, const V& q) {
    return __builtin_shufflevector(p, q, (i / 4 * 4 + i % 2 + i % 4 / 2 * n)...);
  };
  const auto high = [](const V& p, const V& q) {
    return __builtin_shufflevector(p, q, (i / 4 * 4 + 2 + i % 2 + i % 4 / 2 * n)...);
  };
  return {low(a, c), high(a, c), low(b, d), high(b, d)};
}

/// Writes item l of what interleave4 made to `out + l * stride`.
template <class V, class T, int... l>
COROTET_ALWAYS_INLINE void store_quads(const std::array<V, 4>& quads, T* out, std::size_t stride,
                                       std::integer_sequence<int, l...>) {
  const auto store = [](const auto& quad, T* place) { __builtin_memcpy(place, &quad, 4 * sizeof(T)); };
  (store(__builtin_shufflevector(quads[l % 4], quads[l % 4], l / 4 * 4, l / 4 * 4 + 1, l / 4 * 4 + 2, l / 4 * 4 + 3),
         out + static_cast<std::size_t>(l) * stride),
   ...);
}

/// The first three of four values, and zero.
template <class V>
[[nodiscard]] COROTET_ALWAYS_INLINE V first_three(const V& v) {
  return __builtin_shufflevector(v, V{}, 0, 1, 2, 7);
}
#else
// Named, but never called: without the extension no pack holds four values in one register.
template <class V, int... i>
std::array<V, 4> interleave4(const V& x, const V& y, const V& z, const V& w, std::integer_sequence<int, i...>);
template <class V, class T, int... l>
void store_quads(const std::array<V, 4>& quads, T* out, std::size_t stride, std::integer_sequence<int, l...>);
template <class V>
V first_three(const V& v);
#endif

/// The numbers at `from`, which are of another precision.
template <class P, class T, class From>
[[nodiscard]] COROTET_ALWAYS_INLINE P load_converted(const From* from) {
  constexpr std::size_t count = sizeof(P) / sizeof(T);
  if constexpr (Whole<P>) {
#if defined(__GNUC__)
    typedef From Source __attribute__((vector_size(count * sizeof(From))));  // NOLINT(modernize-use-using): as above
    Source numbers;
    __builtin_memcpy(&numbers, from, sizeof(numbers));
    return P(__builtin_convertvector(numbers, typename P::Native));
#else
    return P(static_cast<T>(*from));
#endif
  } else {
    using Half = decltype(P::low);
    return P(load_converted<Half, T>(from), load_converted<Half, T>(from + count / 2));
  }
}

/// f on each register of the arguments, for results of the same type as the first.
template <class Result, class Function, class P, class... Q>
[[nodiscard]] COROTET_ALWAYS_INLINE Result map(const Function& f, const P& p, const Q&... q) {
  if constexpr (Whole<P>) {
    return Result(f(p.value, q.value...));
  } else {
    using Half = decltype(Result::low);
    return Result(map<Half>(f, p.low, q.low...), map<Half>(f, p.high, q.high...));
  }
}

}  // namespace corotet::inline v0_1::detail::inline COROTET_ISA
