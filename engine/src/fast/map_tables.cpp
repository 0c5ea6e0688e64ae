#include "fast/map_tables.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace frontlux::detail {
namespace {

// Queries that have started in a sector. To make its table takes as long as to walk four times as many
// through the grid; one that is asked often will be asked again.
constexpr std::uint64_t kWorthATable = 1U << 15U;
// For all sectors under one policy. What starts in others goes to Embree.
constexpr std::size_t kMostBytes = std::size_t{2} << 30U;

std::size_t memory_of(const Spare<MapTable>& spare) {
  return spare.measured([](const MapTable& map_table) { return map_table.table.memory_bytes(); });
}

}  // namespace

TableSnapshot::TableSnapshot(const VoxelGrid& grid, std::shared_ptr<Spare<MapTable>> spare,
                             const std::function<OpenVoxels()>& make)
    : spare_(std::move(spare)), map_table_(spare_->take()) {
  if (map_table_ && map_table_->table.update(map_table_->grid, grid))
    map_table_->grid = grid;
  else
    map_table_ = std::make_unique<MapTable>(MapTable{make(), grid});
}

std::size_t TableSnapshot::memory_bytes() const { return table().memory_bytes() + memory_of(*spare_); }

// Tables of 2^30 bits with their borders, as wide as the height allows.
std::optional<SectorPlan> SectorPlan::of(const KeyBox& known) {
  constexpr int kBorders = 2;  // bricks
  const int height = (known.max.z >> 3) - (known.min.z >> 3) + 1 + kBorders;
  const int across = height <= 32 ? 256 : height <= 128 ? 128 : 0;
  if (across == 0) return std::nullopt;
  return SectorPlan{8 * (across - kBorders) - 2 * kBeyond};
}

KeyBox SectorPlan::window(std::uint32_t sector) const {
  const auto along = [this](std::uint32_t number) {
    const int low = static_cast<int>(number) * edge - kBeyond, high = low + edge + 2 * kBeyond - 1;
    return std::array{std::max(low, 0), std::min(high, Lattice::kKeysPerAxis - 1)};
  };
  const auto x = along(sector & 0xFFFFU), y = along(sector >> 16U);
  return {make_key(x[0], y[0], 0), make_key(x[1], y[1], Lattice::kKeysPerAxis - 1)};
}

MapTables::MapTables(const VoxelGrid& grid, UnknownPolicy unknown) : grid_(grid), unknown_(unknown) {
  use_whole(std::make_shared<Spare<MapTable>>());
}

MapTables::MapTables(const VoxelGrid& grid, const MapTables& before)
    : grid_(grid), unknown_(before.unknown_) {
  if (before.whole_) {
    use_whole(before.whole_->spare());
    return;
  }
  known_ = before.known_;
  for_each_change(before.grid_, grid, [&](const Block& block) {
    if (!is_forgotten(block, grid)) known_ = hull(known_, cube(block.corner, 1 << block.log2_edge));
  });
  plan_ = SectorPlan::of(known_);
  if (!plan_) {
    use_whole(std::make_shared<Spare<MapTable>>());
  } else if (plan_ == before.plan_) {
    const std::lock_guard lock(before.mutex_);
    for (const bool asked : {true, false})
      for (const auto& [number, sector] : before.sectors_) {
        // Those that nobody has asked since the update before make room.
        if ((sector.table != nullptr) != asked || (!asked && bytes_ > kMostBytes)) continue;
        bytes_ += sectors_[number].counted = bytes_of(sector);
        sectors_[number].history = sector.history;
      }
  }
}

// One table; or sectors, if that is too large and they are not.
void MapTables::use_whole(std::shared_ptr<Spare<MapTable>> spare) {
  std::optional<KeyBox> known;
  whole_ = std::make_unique<TableSnapshot>(grid_, std::move(spare), [&] {
    known = grid_.known_bounds();
    return OpenVoxels(grid_, unknown_, known, kAllVoxels);
  });
  if (!known || !whole_->table().empty()) return;
  plan_ = SectorPlan::of(*known);
  if (!plan_) return;
  known_ = *known;
  whole_.reset();
}

bool MapTables::is_worth_a_table(std::uint32_t number, std::size_t queries) const {
  const std::lock_guard lock(mutex_);
  Sector& sector = sectors_[number];
  if (!sector.history) sector.history = std::make_shared<SectorHistory>();
  return sector.history->queries.fetch_add(queries, std::memory_order_relaxed) + queries >= kWorthATable;
}

const OpenVoxels* MapTables::sector(std::uint32_t number) const {
  const std::lock_guard lock(mutex_);
  Sector& sector = sectors_.at(number);
  if (!sector.table) {
    if (bytes_ > kMostBytes && bytes_of(sector) == 0) return nullptr;
    // Isolated: a thread that waits here for its loops must not take up a query that waits for this lock.
    run_isolated([&] {
      sector.table = std::make_unique<TableSnapshot>(grid_, sector.history->spare, [&] {
        return OpenVoxels(grid_, unknown_, known_, plan_->window(number));
      });
    });
    bytes_ += bytes_of(sector) - sector.counted;
    sector.counted = bytes_of(sector);
  }
  return sector.table->table().empty() ? nullptr : &sector.table->table();
}

// With its spare one, also where that has not become a table of this moment yet.
std::size_t MapTables::bytes_of(const Sector& sector) {
  if (sector.table) return sector.table->memory_bytes();
  return sector.history ? memory_of(*sector.history->spare) : 0;
}

std::size_t MapTables::memory_bytes() const {
  if (whole_) return whole_->memory_bytes();
  const std::lock_guard lock(mutex_);
  std::size_t bytes = 0;
  for (const auto& [number, sector] : sectors_) bytes += bytes_of(sector);
  return bytes;
}

}  // namespace frontlux::detail
