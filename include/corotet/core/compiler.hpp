// What is asked of the compiler beyond the language. Nothing here changes what code means.
#pragma once

#if defined(__GNUC__)
#define COROTET_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define COROTET_ALWAYS_INLINE inline
#endif

// A function of which there is one copy in machine code.
#if defined(__clang__)
#define COROTET_NEVER_INLINE __attribute__((noinline))
#elif defined(__GNUC__)
#define COROTET_NEVER_INLINE __attribute__((noinline, noclone))
#elif defined(_MSC_VER)
#define COROTET_NEVER_INLINE __declspec(noinline)
#else
#define COROTET_NEVER_INLINE
#endif

// Before a loop over a few registers: at -O2, GCC 12 keeps them in memory unless the loop is unrolled.
#if defined(__GNUC__) && !defined(__clang__)
#define COROTET_UNROLL _Pragma("GCC unroll 8")
#else
#define COROTET_UNROLL
#endif
