// A fixed number of values that the compiler keeps in vector registers of whatever width it is allowed to use.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

// The vector extension of GCC and Clang costs almost no compile time (the same expressions over Eigen arrays took
// several times as long). Elsewhere a value stands alone, and the optimiser finds the vectors as well as it can. The
// layout is the same everywhere.
#if defined(__GNUC__)
#define COROTET_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define COROTET_ALWAYS_INLINE inline
#endif

namespace corotet::detail {

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

}  // namespace corotet::detail
