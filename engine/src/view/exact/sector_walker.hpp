#pragma once

#include "view/exact/tiling.hpp"
#include "view/exact/trie_walk.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::detail {

/// From how many viewpoints on a walk over a trie takes less time than rays.
struct WalkThresholds {
  std::size_t walk = 24;    ///< in a walk, and in a column of tiles
  std::size_t part = 6;     ///< in each part of a tile that is walked
  std::size_t whole = 128;  ///< in a tile that is walked as a whole and not as halves
  std::size_t trie = 2000;  ///< in all columns, if the trie is still to be made
};

/// Viewpoints of tiles above each other, what lies around them, and what they see by sector.
struct ViewColumn {
  std::span<const Placed> viewpoints;
  std::vector<std::size_t> tiles;   ///< where each begins, and the end of the last
  const std::byte *free, *targets;  ///< windows, at the lowest tile
  std::span<std::uint32_t> seen;    ///< one for each sector, by viewpoint
  int sectors;
  bool by_index;  ///< `seen` has all viewpoints, by their index, and not only those of the column

  [[nodiscard]] std::size_t size() const { return tiles.size() - 1; }
  [[nodiscard]] std::span<const Placed> tile(std::size_t t) const {
    return viewpoints.subspan(tiles[t], tiles[t + 1] - tiles[t]);
  }
  [[nodiscard]] std::span<std::uint32_t> seen_from(const Placed& placed) const {
    const auto row =
        by_index ? std::size_t{placed.index} : static_cast<std::size_t>(&placed - viewpoints.data());
    const auto size = static_cast<std::size_t>(sectors);
    return seen.subspan(row * size, size);
  }
};

/// Counts what the viewpoints of columns see in a sector. A walk takes several tiles of a column at once: it
/// finds its path through the trie only once for all of them, and need not wait for one before it goes on
/// with the next. Has the memory that a task needs.
class SectorWalker {
 public:
  SectorWalker(const TrieWalk& walk, const RayTrie& trie, const WalkThresholds& thresholds);

  /// Of viewpoints for which the sector is stale.
  /// @param left  gets those that are so few in their tiles that they are left to rays
  void count(const ViewColumn& column, const RayTrie::Sector& sector, std::vector<const Placed*>& left);

 private:
  using Viewpoints = std::vector<const Placed*>;

  // What is to be walked at once.
  struct Batch {
    TileParts parts;
    PartBits bits{};  // of the viewpoints
    Viewpoints viewpoints;
    std::vector<std::uint32_t> places;  // of each

    void add(std::span<const Placed* const> some, std::uint32_t first_row, std::size_t begin);
    void clear();
  };

  void add(const ViewColumn& column, const RayTrie::Sector& sector, std::span<const Placed* const> some,
           std::uint32_t first_row, Batch& batch, Viewpoints& left);
  void walk(const ViewColumn& column, const RayTrie::Sector& sector, Batch& batch, Viewpoints& left);

  const TrieWalk& walk_;
  const RayTrie& trie_;
  WalkThresholds thresholds_;
  Batch wholes_, halves_;
  Viewpoints stale_;
  std::vector<PartBits> groups_, reached_;
  PartCounts seen_;
};

}  // namespace frontlux::detail
