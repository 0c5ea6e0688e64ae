#include "packet/packet_walk.hpp"

#include "isa/targets.hpp"

#include <bit>

namespace frontlux::detail {
namespace {

constexpr std::uint32_t kWentThrough = PacketWalk::kWentThrough;

#ifdef FRONTLUX_X86_SETS
// For AVX2, which cannot expand: which of the next lines' values goes to which lane, by the lanes to fill.
template <unsigned kLanes>
constexpr auto make_expansion() {
  std::array<std::array<std::uint32_t, 8>, 1U << kLanes> table{};
  constexpr unsigned kWords = 8 / kLanes;  // of 32 bits, to a lane
  for (unsigned fill = 0; fill < table.size(); ++fill) {
    unsigned from = 0;
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      for (unsigned w = 0; w < kWords; ++w) table[fill][lane * kWords + w] = from * kWords + w;
      from += fill >> lane & 1U;
      if (from >= kLanes) from = 0;
    }
  }
  return table;
}
alignas(64) constexpr auto kExpand8 = make_expansion<8>();
alignas(64) constexpr auto kExpand4 = make_expansion<4>();

// What the 32-bit and the 64-bit lanes of an instruction set have in common.
#define FRONTLUX_COMMON_AVX512                                                    \
  static M none() { return 0; }                                                   \
  static M both(M a, M b) { return static_cast<M>(a & b); }                       \
  static M any(M a, M b) { return static_cast<M>(a | b); }                        \
  static M but_not(M a, M b) { return static_cast<M>(a & ~b); }                   \
  static V add_unless(V a, M m, V b) { return add_if(a, static_cast<M>(~m), b); } \
  static I either(I a, I b) { return _mm512_or_si512(a, b); }                     \
  static I exclusive(I a, I b) { return _mm512_xor_si512(a, b); }                 \
  static I merge(I where, I a, I b) { return _mm512_ternarylogic_epi64(where, a, b, 0xCA); }
#define FRONTLUX_COMMON_AVX2                                                           \
  static I either(I a, I b) { return _mm256_or_si256(a, b); }                          \
  static I exclusive(I a, I b) { return _mm256_xor_si256(a, b); }                      \
  static I merge(I where, I a, I b) {                                                  \
    return _mm256_or_si256(_mm256_and_si256(where, a), _mm256_andnot_si256(where, b)); \
  }

FRONTLUX_BEGIN_AVX512
namespace avx512 {
#include "packet/lanes_avx512.inl"
#include "packet/packet_walk_body.inl"
}  // namespace avx512
FRONTLUX_END_TARGET

FRONTLUX_BEGIN_AVX2
namespace avx2 {
#include "packet/lanes_avx2.inl"
#include "packet/packet_walk_body.inl"
}  // namespace avx2
FRONTLUX_END_TARGET
#endif

namespace vector {
constexpr int kVectorBytes = 16;
#include "packet/lanes_vector.inl"
#include "packet/packet_walk_body.inl"
}  // namespace vector

namespace single {
constexpr int kVectorBytes = 0;
#include "packet/lanes_vector.inl"
#include "packet/packet_walk_body.inl"
}  // namespace single

constexpr PacketWalk kWalks[] = {
#ifdef FRONTLUX_X86_SETS
    {InstructionSet::kAvx512, &avx512::segments, &avx512::rays},
    {InstructionSet::kAvx2, &avx2::segments, &avx2::rays},
#endif
    {InstructionSet::kVector, &vector::segments, &vector::rays},
    {InstructionSet::kNone, &single::segments, &single::rays}};

}  // namespace

std::span<const PacketWalk> packet_walks() {
  static const auto walks = runnable(std::span<const PacketWalk>(kWalks));
  return walks;
}

}  // namespace frontlux::detail
