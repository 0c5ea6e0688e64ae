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

/// A bit for each place of a tile.
struct alignas(64) TileBits {
  std::array<std::uint64_t, ViewTile::kBytes / 8> words;

  [[nodiscard]] static constexpr std::uint32_t place(int column, int row) {
    return static_cast<std::uint32_t>(row * ViewTile::kColumns + column);
  }
  [[nodiscard]] bool at(std::uint32_t place) const { return (words[place / 64] >> place % 64 & 1U) != 0; }
  void set(std::uint32_t place) { words[place / 64] |= std::uint64_t{1} << place % 64; }
  TileBits& operator&=(const TileBits& other) {
    for (std::size_t w = 0; w < words.size(); ++w) words[w] &= other.words[w];
    return *this;
  }
  [[nodiscard]] bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t word : words) all |= word;
    return all != 0;
  }
};

/// The rows of a tile that a walk looks at: all, or half of them from `first` on.
struct TileRows {
  std::uint32_t first = 0;
  bool half = false;

  /// Those with all of these places. @pre there is one
  [[nodiscard]] static TileRows with(const TileBits& places);
};

/// A number for each place of a tile, its bits in planes.
struct TileCounts {
  static constexpr std::size_t kPlanes = 32;
  std::array<TileBits, kPlanes> planes{};
  std::size_t used = 0;  ///< planes that may not be zero

  void clear() {
    std::fill_n(planes.begin(), used, TileBits{});
    used = 0;
  }
  [[nodiscard]] std::uint32_t at(std::uint32_t place) const {
    std::uint32_t count = 0;
    for (std::size_t p = 0; p < used; ++p) count |= static_cast<std::uint32_t>(planes[p].at(place)) << p;
    return count;
  }
};

/// Rows of bits, eight columns to a byte: the bytes of all rows, then those of the next eight columns.
struct SpreadFrom {
  const std::uint8_t* bytes;
  std::size_t pitch;      ///< rows that there are
  std::size_t first_bit;  ///< column to begin with; at least 24 follow the last
};

/// The walk of one instruction set. `free` and `targets` point to the lowest places in reach of a tile, in
/// windows of the trie's layout.
struct TrieWalk {
  InstructionSet needs;

  /// Adds to `counts`, for each of the places in a table, the viewpoints whose bits are set there.
  void (*add_up)(const std::byte* table, std::span<const std::int32_t> places, const TileBits& viewpoints,
                 TileCounts& counts);

  /// The viewpoints that have targets of a sector in view, visible or not, go to `groups`, for each group.
  /// False if there are none.
  /// @param rows  with all of the viewpoints; in other rows nothing is written
  bool (*find_groups)(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* targets,
                      const TileBits& viewpoints, const TileRows& rows, std::span<TileBits> groups);

  /// Adds to `counts` how many targets of a sector each viewpoint sees. The targets of a group are visited
  /// only for the viewpoints in `groups`.
  /// @param rows     as for `find_groups`
  /// @param reached  room for a set of viewpoints at each depth, and one more
  void (*count)(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
                const std::byte* targets, std::span<const TileBits> groups, const TileBits& viewpoints,
                const TileRows& rows, std::span<TileBits> reached, TileCounts& counts);

  /// For each column from `first_bit` on, and for each row, writes the 16 bits that begin at the column.
  void (*spread)(const SpreadFrom& from, std::size_t rows, std::size_t columns, std::size_t column_stride,
                 std::uint16_t* out);
};

/// Those that may run, the widest first; the last is for any processor.
[[nodiscard]] std::span<const TrieWalk> trie_walks();

}  // namespace frontlux::detail
