#pragma once

#include "packet/open_voxels.hpp"
#include "parallel/spare.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace frontlux::detail {

/// A table and the map that it was made of.
struct MapTable {
  OpenVoxels table;
  VoxelGrid grid;
};

/// A table of a map as it is at one moment. It is the table of an earlier moment, brought up to date, if
/// there is a spare one.
class TableSnapshot {
 public:
  /// @param make  makes the table anew
  TableSnapshot(const VoxelGrid& grid, std::shared_ptr<Spare<MapTable>> spare,
                const std::function<OpenVoxels()>& make);
  ~TableSnapshot() { spare_->give_back(std::move(map_table_)); }
  TableSnapshot(const TableSnapshot&) = delete;
  TableSnapshot& operator=(const TableSnapshot&) = delete;

  [[nodiscard]] const OpenVoxels& table() const { return map_table_->table; }
  [[nodiscard]] const std::shared_ptr<Spare<MapTable>>& spare() const { return spare_; }
  /// With the spare one.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  std::shared_ptr<Spare<MapTable>> spare_;
  std::unique_ptr<MapTable> map_table_;
};

/// How a map that is too wide for one table is divided: into square sectors of all heights. The table of a
/// sector reaches beyond it on all sides, so that what starts in the sector and is not too long ends in it.
struct SectorPlan {
  int edge;  ///< [voxels] of a sector along x and y

  static constexpr int kBeyond = 200;  ///< [voxels] by which a table reaches beyond its sector

  /// For a map whose known voxels lie in a box; none if it is too high for tables.
  static std::optional<SectorPlan> of(const KeyBox& known);

  [[nodiscard]] std::uint32_t sector_of(const VoxelKey& key) const {
    return static_cast<std::uint32_t>(key.y / edge) << 16U | static_cast<std::uint32_t>(key.x / edge);
  }
  /// What the table of a sector holds.
  [[nodiscard]] KeyBox window(std::uint32_t sector) const;
  friend bool operator==(const SectorPlan&, const SectorPlan&) = default;
};

/// The open voxels of a map under one policy: in one table, or in one for each sector that is asked often
/// enough. Thread safety: full.
class MapTables {
 public:
  MapTables(const VoxelGrid& grid, UnknownPolicy unknown);
  MapTables(const VoxelGrid& grid, const MapTables& before);

  /// The table of the whole map; null if it is divided into sectors.
  [[nodiscard]] const OpenVoxels* whole() const { return whole_ ? &whole_->table() : nullptr; }

  /// The sector in which a query that starts at a voxel belongs. @pre the map is divided
  [[nodiscard]] std::uint32_t sector_of(const VoxelKey& key) const { return plan_->sector_of(key); }
  /// Whether a sector is asked so often that to make its table pays.
  /// @param queries  how many it will be asked now
  [[nodiscard]] bool is_worth_a_table(std::uint32_t sector, std::size_t queries) const;
  /// Its table, which the first call of the moment makes; null if there is nothing in it, or no room for it.
  [[nodiscard]] const OpenVoxels* sector(std::uint32_t sector) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // What is known of a sector from moment to moment.
  struct SectorHistory {
    std::shared_ptr<Spare<MapTable>> spare = std::make_shared<Spare<MapTable>>();
    std::atomic<std::uint64_t> queries{0};
  };
  struct Sector {
    std::shared_ptr<SectorHistory> history;
    std::unique_ptr<const TableSnapshot> table;
    std::size_t counted = 0;  // in `bytes_`
  };

  static std::size_t bytes_of(const Sector& sector);
  void use_whole(std::shared_ptr<Spare<MapTable>> spare);

  VoxelGrid grid_;
  UnknownPolicy unknown_;
  std::unique_ptr<const TableSnapshot> whole_;
  std::optional<SectorPlan> plan_;  // if it is divided
  KeyBox known_;                    // likewise: around all that is known
  mutable std::mutex mutex_;
  mutable std::map<std::uint32_t, Sector> sectors_;
  mutable std::size_t bytes_ = 0;  // of the sectors' tables, spare ones too
};

}  // namespace frontlux::detail
