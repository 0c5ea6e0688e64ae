#pragma once

/// Before a loop that clang would make gathers of, where the processor has them, and be slower. GCC makes
/// permutations of it.
#ifdef __clang__
#define FRONTLUX_NO_GATHERS _Pragma("clang loop vectorize(disable)")
#else
#define FRONTLUX_NO_GATHERS
#endif

#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 takes the intrinsics' own undefined registers for ours (its bug 105593), GCC 14 vectors of one lane
// that have been set for ones that have not.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

/// What stands between FRONTLUX_BEGIN_AVX512 or FRONTLUX_BEGIN_AVX2 and FRONTLUX_END_TARGET is compiled for
/// that instruction set, templates and lambdas included, which an attribute on a function does not reach.
/// Where there are such sets FRONTLUX_X86_SETS is defined.
#if defined(__x86_64__) && defined(__GNUC__)  // clang as well
#define FRONTLUX_X86_SETS
#include <immintrin.h>
#define FRONTLUX_PRAGMA(text) _Pragma(#text)
#define FRONTLUX_AVX512 "avx512f,avx512vl,avx512dq,avx512bw,popcnt"
#ifdef __clang__
#define FRONTLUX_BEGIN(set) \
  FRONTLUX_PRAGMA(clang attribute push(__attribute__((target(set))), apply_to = function))
#define FRONTLUX_BEGIN_AVX512 FRONTLUX_BEGIN(FRONTLUX_AVX512)
#define FRONTLUX_END_TARGET _Pragma("clang attribute pop")
#else
#define FRONTLUX_BEGIN(set) _Pragma("GCC push_options") FRONTLUX_PRAGMA(GCC target(set))
#define FRONTLUX_BEGIN_AVX512 FRONTLUX_BEGIN(FRONTLUX_AVX512 ",prefer-vector-width=512")
#define FRONTLUX_END_TARGET _Pragma("GCC pop_options")
#endif
#define FRONTLUX_BEGIN_AVX2 FRONTLUX_BEGIN("avx2,fma,popcnt")
#endif
