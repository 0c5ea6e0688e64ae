#pragma once

#include "isa/instruction_set.hpp"
#include "view/exact/ray_trie.hpp"
#include "view/exact/window_layout.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// The walk over a `RayTrie` for all places of a `ViewTile` at a time: a bit for each.
namespace frontlux::detail {

/// A bit for each of some places.
template <std::size_t kBytes>
struct alignas(64) PlaceBits {
  std::array<std::uint64_t, kBytes / 8> words;

  [[nodiscard]] bool at(std::uint32_t place) const { return (words[place / 64] >> place % 64 & 1U) != 0; }
  void set(std::uint32_t place) { words[place / 64] |= std::uint64_t{1} << place % 64; }
};

/// The bits of the places of a tile.
using TileBits = PlaceBits<ViewTile::kBytes>;

/// Parts of tiles of one column that are walked together: whole tiles, or halves of them.
struct TileParts {
  static constexpr std::size_t kBytes = 256;  ///< of all their places' bits, at most
  static constexpr std::size_t kMost = kBytes / (ViewTile::kBytes / 2);

  bool half = false;
  std::size_t size = 0;
  std::array<std::size_t, kMost> begins{};  ///< of each, in windows [bytes]

  [[nodiscard]] std::size_t part_bytes() const { return half ? ViewTile::kBytes / 2 : ViewTile::kBytes; }
  [[nodiscard]] std::size_t bytes() const { return size * part_bytes(); }
  [[nodiscard]] bool full() const { return bytes() == kBytes; }
};

/// The bits of the places of such parts, one part after the other.
using PartBits = PlaceBits<TileParts::kBytes>;

/// A number for each place, its bits in planes.
template <class Bits>
struct PlaceCounts {
  static constexpr std::size_t kPlanes = 32;
  std::array<Bits, kPlanes> planes{};
  std::size_t used = 0;  ///< planes that may not be zero

  void clear() {
    std::fill_n(planes.begin(), used, Bits{});
    used = 0;
  }
  [[nodiscard]] std::uint32_t at(std::uint32_t place) const {
    std::uint32_t count = 0;
    for (std::size_t p = 0; p < used; ++p) count |= static_cast<std::uint32_t>(planes[p].at(place)) << p;
    return count;
  }
};
using TileCounts = PlaceCounts<TileBits>;
using PartCounts = PlaceCounts<PartBits>;

/// Rows of bits, eight columns to a byte: the bytes of all rows, then those of the next eight columns.
struct SpreadFrom {
  const std::uint8_t* bytes;
  std::size_t pitch;      ///< rows that there are
  std::size_t first_bit;  ///< column to begin with; at least 24 follow the last
};

/// The walk of one instruction set. `free` and `targets` point into windows of the trie's layout, where
/// `TileParts::begins` are counted from.
struct TrieWalk {
  InstructionSet needs;

  /// Adds to `counts`, for each of the places in a table, the viewpoints whose bits are set there.
  void (*add_up)(const std::byte* table, std::span<const std::int32_t> places, const TileBits& viewpoints,
                 TileCounts& counts);

  /// The viewpoints that have targets of a sector in view, visible or not, go to `groups`, for each group of
  /// the sector from its first one on. False if there are none.
  bool (*find_groups)(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* targets,
                      const TileParts& parts, const PartBits& viewpoints, std::span<PartBits> groups);

  /// Adds to `counts` how many targets of a sector each viewpoint sees. The targets of a group are visited
  /// only for the viewpoints in `groups`.
  /// @param groups   from `find_groups`
  /// @param reached  room, of `reached_size`
  void (*count)(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
                const std::byte* targets, const TileParts& parts, std::span<const PartBits> groups,
                const PartBits& viewpoints, std::span<PartBits> reached, PartCounts& counts);

  [[nodiscard]] static std::size_t reached_size(const RayTrie& trie) { return 2 * (trie.depth() + 1); }

  /// For each column from `first_bit` on, and for each row, writes the 16 bits that begin at the column.
  void (*spread)(const SpreadFrom& from, std::size_t rows, std::size_t columns, std::size_t column_stride,
                 std::uint16_t* out);
};

/// Those that may run, the widest first; the last is for any processor.
[[nodiscard]] std::span<const TrieWalk> trie_walks();

}  // namespace frontlux::detail
