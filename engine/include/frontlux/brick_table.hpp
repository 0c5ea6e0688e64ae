#pragma once

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Sets of voxels by brick. Not part of the public interface.
namespace frontlux::detail {

/// A set of the 512 voxels of a brick, layer by layer: word z, bit 8 y + x, as in `Brick`.
using Layers = std::array<std::uint64_t, 8>;

/// The voxels of a brick that lie in a box.
[[nodiscard]] inline Layers part_inside(const VoxelKey& corner, const KeyBox& box) {
  const auto bits = [](int first, int last) {  // of a byte, clipped to it
    return (0xFFU << std::clamp(first, 0, 8)) & (0xFFU >> std::clamp(7 - last, 0, 8)) & 0xFFU;
  };
  const std::uint64_t row = bits(box.min.x - corner.x, box.max.x - corner.x);
  const unsigned rows = bits(box.min.y - corner.y, box.max.y - corner.y);
  const unsigned layers = bits(box.min.z - corner.z, box.max.z - corner.z);
  std::uint64_t square = 0;
  for (unsigned y = 0; y < 8; ++y)
    if (((rows >> y) & 1U) != 0) square |= row << (8 * y);
  Layers inside{};
  for (unsigned z = 0; z < 8; ++z)
    if (((layers >> z) & 1U) != 0) inside[z] = square;
  return inside;
}

/// Values for bricks, by the number of the brick: a hash table with the values side by side, in the order in
/// which they came. Numbers are any that tell bricks apart.
template <class Value>
class BrickTable {
 public:
  struct Entry {
    std::uint64_t number;
    Value value;
  };

  /// The place of a brick's value, which is a new one if there was none. It never changes.
  std::size_t index(std::uint64_t number) {
    if (2 * (entries_.size() + 1) > slots_.size()) grow();
    std::uint32_t& slot = slots_[find_slot(number)];
    if (slot == 0) {
      entries_.push_back({number, Value{}});
      slot = static_cast<std::uint32_t>(entries_.size());
    }
    return slot - 1;
  }
  Value& value(std::size_t index) { return entries_[index].value; }
  Value& operator[](std::uint64_t number) { return value(index(number)); }

  /// Null if there is none.
  [[nodiscard]] const Value* find(std::uint64_t number) const {
    if (slots_.empty()) return nullptr;
    const std::uint32_t slot = slots_[find_slot(number)];
    return slot == 0 ? nullptr : &entries_[slot - 1].value;
  }

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

 private:
  [[nodiscard]] std::size_t find_slot(std::uint64_t number) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (number * 0x9E37'79B9'7F4A'7C15) >> 32 & mask;
    while (slots_[at] != 0 && entries_[slots_[at] - 1].number != number) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    slots_.assign(slots_.empty() ? 64 : 2 * slots_.size(), 0);
    for (std::size_t i = 0; i < entries_.size(); ++i)
      slots_[find_slot(entries_[i].number)] = static_cast<std::uint32_t>(i + 1);
  }

  std::vector<std::uint32_t>
      slots_;  // place of the entry plus one; a power of two of them, half of them empty
  std::vector<Entry> entries_;
};

}  // namespace frontlux::detail
