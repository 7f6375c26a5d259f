// What is asked of the compiler beyond the language. Nothing here changes what code means.
#pragma once

#if defined(__GNUC__)
#define COROTET_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define COROTET_ALWAYS_INLINE inline
#endif

// A function that many places call: not copied into them.
#if defined(__GNUC__)
#define COROTET_NOINLINE __attribute__((noinline))
#elif defined(_MSC_VER)
#define COROTET_NOINLINE __declspec(noinline)
#else
#define COROTET_NOINLINE
#endif

// A function that is seldom called: not inlined, and made small rather than fast.
#if defined(__GNUC__)
#define COROTET_COLD __attribute__((cold, noinline))
#elif defined(_MSC_VER)
#define COROTET_COLD __declspec(noinline)
#else
#define COROTET_COLD
#endif

// Before a loop over a few registers: at -O2, GCC 12 keeps them in memory unless the loop is unrolled.
#if defined(__GNUC__) && !defined(__clang__)
#define COROTET_UNROLL _Pragma("GCC unroll 8")
#else
#define COROTET_UNROLL
#endif

// The instruction set that a source is compiled for. Types that live in registers are in an inline namespace of this
// name: sources of one program that are compiled for several share all data, but no function that passes registers.
#if !defined(__GNUC__)
#define COROTET_ISA isa_generic
#elif defined(__AVX512F__)
#define COROTET_ISA isa_avx512
#elif defined(__AVX2__) && defined(__FMA__)
#define COROTET_ISA isa_avx2_fma
#elif defined(__AVX2__)
#define COROTET_ISA isa_avx2
#elif defined(__AVX__)
#define COROTET_ISA isa_avx
#else
#define COROTET_ISA isa_baseline
#endif
