#include "view/exact/trie_walk.hpp"

#include "isa/targets.hpp"

#include <bit>
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

TileRows TileRows::with(const TileBits& places) {
  constexpr std::uint32_t kHalf = ViewTile::kRows / 2;
  constexpr std::uint32_t kWordRows = 64 / ViewTile::kColumns;
  const auto row_of = [](std::size_t word, int bit) {
    return static_cast<std::uint32_t>(word) * kWordRows +
           static_cast<std::uint32_t>(bit) / ViewTile::kColumns;
  };
  std::uint32_t first = ViewTile::kRows, last = 0;
  for (std::size_t w = 0; w < places.words.size(); ++w)
    if (const std::uint64_t word = places.words[w]; word != 0) {
      first = std::min(first, row_of(w, std::countr_zero(word)));
      last = row_of(w, 63 - std::countl_zero(word));
    }
  if (last >= first + kHalf) return {};
  return {std::min(first, kHalf), true};
}

std::span<const TrieWalk> trie_walks() { return runnable(std::span<const TrieWalk>(kWalks)); }

}  // namespace frontlux::detail
