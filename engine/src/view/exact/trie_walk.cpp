#include "view/exact/trie_walk.hpp"

#include <algorithm>
#include <cstring>

// Vectors are passed among functions of this file only, and those are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FRONTLUX_TRIE_WALKS
#include <immintrin.h>
// GCC 12 takes the intrinsics' own undefined registers for ours (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace frontlux::detail {

namespace {

// A body for each instruction set. The target holds for everything up to the pop, lambdas and templates
// included, which an attribute on a function does not.
#ifdef FRONTLUX_TRIE_WALKS
#pragma GCC push_options
#pragma GCC target("avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512")
namespace avx512 {
using Part = __m512i;
[[gnu::always_inline]] inline bool any_of(const Part& part) {
  return _mm512_test_epi64_mask(part, part) != 0;
}
#include "view/exact/trie_walk_body.inl"
}  // namespace avx512
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
using Part = __m256i;
[[gnu::always_inline]] inline bool any_of(const Part& part) { return _mm256_testz_si256(part, part) == 0; }
#include "view/exact/trie_walk_body.inl"
}  // namespace avx2
#pragma GCC pop_options
#endif

namespace plain {
using Part [[gnu::vector_size(16)]] = std::uint64_t;
[[gnu::always_inline]] inline bool any_of(const Part& part) { return (part[0] | part[1]) != 0; }
#include "view/exact/trie_walk_body.inl"
}  // namespace plain

std::span<const TrieWalk> choose() {
  static constexpr TrieWalk kPlain{"none", &plain::gather, &plain::count, &plain::spread};
#ifdef FRONTLUX_TRIE_WALKS
  static constexpr std::array<TrieWalk, 3> kWalks{
      {{"AVX-512", &avx512::gather, &avx512::count, &avx512::spread},
       {"AVX2", &avx2::gather, &avx2::count, &avx2::spread},
       kPlain}};
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  return std::span(kWalks).subspan(has_avx512 ? 0 : __builtin_cpu_supports("avx2") ? 1 : 2);
#else
  return {&kPlain, 1};
#endif
}

}  // namespace

std::span<const TrieWalk> trie_walks() {
  static const std::span<const TrieWalk> walks = choose();
  return walks;
}

}  // namespace frontlux::detail
