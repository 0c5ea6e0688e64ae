#pragma once

#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/scan.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

class Directions;

/// Where rays have ended: of each voxel the last point, `surface_depth` behind a surface. A voxel is solid if
/// `kLeastEnded` rays have ended in it, until later ones have passed that point by less than an eighth of a
/// voxel, and gone on: `kMostPassed` rays, of scans that have none that ends in the voxel.
///
/// Of the rays that graze a wall most pass through its voxels, so that the map has these free. But few of
/// them pass the very points at which others have ended, unless what was there is gone: a door has opened,
/// somebody has left, the robot was not where it took itself to be. Rays are counted only while the map has
/// the voxel free: else it says itself that something is there.
class HitPoints {
 public:
  static constexpr int kLeastEnded = 2;  // rays: a single one may be a stray return
  static constexpr int kMostPassed = 6;

  /// @param map  at the beginning: in its occupied voxels it counts as if rays had ended in their middles
  explicit HitPoints(const VoxelGrid& map);

  /// @param change  of the map, which has taken in the scan before
  /// @return voxels that are solid from now on, though free in the map
  std::vector<VoxelKey> insert(const Scan& scan, const Mapping& mapping, const MapChange& change);

  /// Nothing is in these voxels, whatever rays have ended there.
  void forget(std::span<const VoxelKey> voxels);

  [[nodiscard]] bool is_solid(const VoxelKey& voxel) const;

  /// Voxels that became solid, or ceased to be, while they were free in the map, since the last call.
  [[nodiscard]] std::vector<VoxelKey> take_changed();

 private:
  struct Point {
    Eigen::Vector3f at = Eigen::Vector3f::Zero();  // [m]
    std::uint32_t scan = 0;                        // number of the last one that ended here
    std::uint8_t ended = 0, passed = 0;            // rays, up to `kLeastEnded` and `kMostPassed`
    [[nodiscard]] bool is_solid() const { return ended >= kLeastEnded; }
  };
  struct Hash {
    std::size_t operator()(const VoxelKey& key) const {
      constexpr std::uint64_t kMix = 0x9E3779B97F4A7C15;  // 2^64 by the golden ratio
      return ((std::uint64_t{key.x} << 32U | std::uint64_t{key.y} << 16U | key.z) * kMix) >> 16U;
    }
  };
  using Points = std::unordered_map<VoxelKey, Point, Hash>;
  using Column = std::pair<int, int>;  // of 64 x 64 voxels: x and y of its number

  void note_passing(const Scan& scan, const Lattice& lattice);
  void note_passing(const Scan& scan, const Directions& directions, std::set<VoxelKey>& column);
  [[nodiscard]] int passing(const Scan& scan, const Directions& directions,
                            const Eigen::Vector3f& point) const;

  float near_;  // [m]
  std::uint32_t scans_ = 0;
  Points points_;
  std::map<Column, std::set<VoxelKey>> free_;  // voxels with a point that are free in the map
  std::vector<VoxelKey> changed_;
};

}  // namespace frontlux::planner::detail
