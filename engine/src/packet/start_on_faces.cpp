#include "packet/start_on_faces.hpp"

namespace frontlux::detail {

bool cross_at_start(const OpenVoxels& table, std::array<std::int32_t, 3>& first,
                    const std::array<std::int32_t, 3>& between, std::uint32_t& index, std::uint32_t flip,
                    std::int32_t too_close) {
  const std::array<std::uint32_t, 3>& bits = table.layout().bits;
  std::uint32_t crossed = 0;  // bits of these axes
  for (std::size_t a = 0; a < 3; ++a)
    if (first[a] <= too_close)
      crossed |= bits[a];
    else if (first[a] <= 3 * too_close)
      return false;
  std::uint32_t behind = index;
  for (std::size_t a = 0; a < 3; ++a)
    if ((crossed & bits[a]) != 0) behind = advanced(behind, bits[a], 1);
  for (std::uint32_t some = 1; some < 8; ++some) {
    std::uint32_t theirs = 0;
    for (std::size_t a = 0; a < 3; ++a) theirs |= (some >> a & 1U) != 0 ? bits[a] : 0U;
    theirs &= crossed;
    if (!table.open(((index & ~theirs) | (behind & theirs)) ^ flip)) return false;
  }
  index = behind;
  for (std::size_t a = 0; a < 3; ++a)
    if ((crossed & bits[a]) != 0) first[a] += between[a];
  return true;
}

}  // namespace frontlux::detail
