#include "view/exact/trie_walk.hpp"

#include "isa/targets.hpp"

#include <cstring>

// Vectors are passed among functions of this file only, and those are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace frontlux::detail {

namespace {

#ifdef FRONTLUX_X86_SETS
FRONTLUX_BEGIN_AVX512
namespace avx512 {
using Part = __m512i;
using HalfPart = __m256i;
[[gnu::always_inline]] inline bool any_of(const Part& part) {
  return _mm512_test_epi64_mask(part, part) != 0;
}
[[gnu::always_inline]] inline bool any_of(const HalfPart& part) {
  return _mm256_testz_si256(part, part) == 0;
}
#include "view/exact/trie_walk_body.inl"
}  // namespace avx512
FRONTLUX_END_TARGET

FRONTLUX_BEGIN_AVX2
namespace avx2 {
using Part = __m256i;
using HalfPart = Part;
[[gnu::always_inline]] inline bool any_of(const Part& part) { return _mm256_testz_si256(part, part) == 0; }
#include "view/exact/trie_walk_body.inl"
}  // namespace avx2
FRONTLUX_END_TARGET
#endif

namespace plain {
using Part [[gnu::vector_size(16)]] = std::uint64_t;
using HalfPart = Part;
[[gnu::always_inline]] inline bool any_of(const Part& part) { return (part[0] | part[1]) != 0; }
#include "view/exact/trie_walk_body.inl"
}  // namespace plain

constexpr TrieWalk kWalks[] = {
#ifdef FRONTLUX_X86_SETS
    {InstructionSet::kAvx512, &avx512::add_up, &avx512::find_groups, &avx512::count, &avx512::spread},
    {InstructionSet::kAvx2, &avx2::add_up, &avx2::find_groups, &avx2::count, &avx2::spread},
#endif
    {InstructionSet::kNone, &plain::add_up, &plain::find_groups, &plain::count, &plain::spread}};

}  // namespace

std::span<const TrieWalk> trie_walks() { return runnable(std::span<const TrieWalk>(kWalks)); }

}  // namespace frontlux::detail
