#include "view/exact/sector_walker.hpp"

#include <algorithm>

namespace frontlux::detail {

SectorWalker::SectorWalker(const TrieWalk& walk, const RayTrie& trie, const WalkThresholds& thresholds)
    : walk_(walk),
      trie_(trie),
      thresholds_(thresholds),
      groups_(trie.most_groups()),
      reached_(TrieWalk::reached_size(trie)) {
  halves_.parts.half = true;
}

void SectorWalker::count(const ViewColumn& column, const RayTrie::Sector& sector, Viewpoints& left) {
  constexpr std::uint32_t kHalf = ViewTile::kRows / 2;
  const SectorSet set = SectorSet::of(sector.bin, column.sectors);
  for (std::size_t t = 0; t < column.size(); ++t) {
    stale_.clear();
    for (const Placed& placed : column.tile(t))
      if (placed.sectors.contains(set)) stale_.push_back(&placed);
    if (stale_.empty()) continue;
    if (stale_.size() >= thresholds_.whole) {
      add(column, sector, stale_, 0, wholes_, left);
      continue;
    }
    // From the first of their rows on, and if there are others from the middle on. They are in order of rows.
    const std::uint32_t first_row = std::min(stale_.front()->row(), kHalf);
    const auto rest = std::ranges::find_if(
        stale_, [&](const Placed* placed) { return placed->row() >= first_row + kHalf; });
    add(column, sector, {stale_.begin(), rest}, first_row, halves_, left);
    if (rest != stale_.end()) add(column, sector, {rest, stale_.end()}, kHalf, halves_, left);
  }
  walk(column, sector, halves_, left);
  walk(column, sector, wholes_, left);
}

void SectorWalker::add(const ViewColumn& column, const RayTrie::Sector& sector,
                       std::span<const Placed* const> some, std::uint32_t first_row, Batch& batch,
                       Viewpoints& left) {
  if (some.size() < thresholds_.part) {
    left.insert(left.end(), some.begin(), some.end());
    return;
  }
  const std::size_t levels = some.front()->level() - column.viewpoints.front().level();
  batch.add(some, first_row, levels * trie_.layout().level_bytes() + first_row * ViewTile::kRowBytes);
  if (batch.parts.full()) walk(column, sector, batch, left);
}

void SectorWalker::walk(const ViewColumn& column, const RayTrie::Sector& sector, Batch& batch,
                        Viewpoints& left) {
  if (batch.viewpoints.size() < thresholds_.walk) {
    left.insert(left.end(), batch.viewpoints.begin(), batch.viewpoints.end());
  } else if (walk_.find_groups(trie_, sector, column.targets, batch.parts, batch.bits, groups_)) {
    walk_.count(trie_, sector, column.free, column.targets, batch.parts, groups_, batch.bits, reached_,
                seen_);
    for (std::size_t i = 0; i < batch.viewpoints.size(); ++i)
      column.seen_from(*batch.viewpoints[i])[static_cast<std::size_t>(sector.bin)] =
          seen_.at(batch.places[i]);
    seen_.clear();
  }
  batch.clear();
}

void SectorWalker::Batch::add(std::span<const Placed* const> some, std::uint32_t first_row,
                              std::size_t begin) {
  const auto first_place = static_cast<std::uint32_t>(parts.bytes() * 8);
  for (const Placed* placed : some) {
    viewpoints.push_back(placed);
    places.push_back(first_place + placed->place - first_row * ViewTile::kColumns);
    bits.set(places.back());
  }
  parts.begins[parts.size++] = begin;
}

void SectorWalker::Batch::clear() {
  parts.size = 0;
  bits = {};
  viewpoints.clear();
  places.clear();
}

}  // namespace frontlux::detail
