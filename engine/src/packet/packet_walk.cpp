#include "packet/packet_walk.hpp"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FRONTLUX_PACKETS
#include <immintrin.h>
// GCC 12 takes the intrinsics' own undefined registers for ours (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace frontlux::detail {

#ifdef FRONTLUX_PACKETS
namespace {

constexpr std::uint32_t kWentThrough = PacketWalk::kWentThrough;

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

// A body for each instruction set. The target holds for everything up to the pop, lambdas and templates
// included, which an attribute on a function does not.
#pragma GCC push_options
#pragma GCC target("avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512")
namespace avx512 {
#include "packet/packet_walk_avx512.inl"
#include "packet/packet_walk_body.inl"
}  // namespace avx512
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "packet/packet_walk_avx2.inl"
#include "packet/packet_walk_body.inl"
}  // namespace avx2
#pragma GCC pop_options

std::span<const PacketWalk> choose() {
  static constexpr std::array<PacketWalk, 2> kWalks{
      {{"AVX-512", &avx512::segments, &avx512::rays}, {"AVX2", &avx2::segments, &avx2::rays}}};
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  const bool has_avx2 = __builtin_cpu_supports("avx2");
  return std::span(kWalks).subspan(has_avx512 ? 0 : 1, (has_avx512 ? 1 : 0) + (has_avx2 ? 1 : 0));
}

}  // namespace

std::span<const PacketWalk> packet_walks() {
  static const std::span<const PacketWalk> walks = choose();
  return walks;
}
#else
std::span<const PacketWalk> packet_walks() { return {}; }
#endif

}  // namespace frontlux::detail
