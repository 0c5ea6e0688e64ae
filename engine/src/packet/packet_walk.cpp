#include "packet/packet_walk.hpp"

#include "isa/targets.hpp"
#include "packet/start_on_faces.hpp"
#include "walk/free_end.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace frontlux::detail {
namespace {

#ifdef FRONTLUX_X86_SETS
// For AVX2, which cannot expand: which of the next lines' values goes to which lane, by the lanes to fill.
constexpr auto make_expansion() {
  std::array<std::array<std::uint32_t, 8>, 256> table{};
  for (unsigned fill = 0; fill < table.size(); ++fill) {
    unsigned from = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      table[fill][lane] = from;
      from = (from + (fill >> lane & 1U)) % 8;
    }
  }
  return table;
}
alignas(64) constexpr auto kExpand = make_expansion();

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
constexpr int kVectorBytes = 4;
#include "packet/lanes_vector.inl"
#include "packet/packet_walk_body.inl"
}  // namespace single

constexpr PacketWalk kWalks[] = {
#ifdef FRONTLUX_X86_SETS
    {InstructionSet::kAvx512, &avx512::segments, &avx512::rays, &walk_alone_by_avx512},
    {InstructionSet::kAvx2, &avx2::segments, &avx2::rays, &walk_alone_by_avx2},
#endif
    {InstructionSet::kVector, &vector::segments, &vector::rays, &walk_alone},
    {InstructionSet::kNone, &single::segments, &single::rays, &walk_alone}};

}  // namespace

std::span<const PacketWalk> packet_walks() {
  static const auto walks = runnable(std::span<const PacketWalk>(kWalks));
  return walks;
}

}  // namespace frontlux::detail
