#include "mapping/hit_points.hpp"

#include "mapping/directions.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace frontlux::planner::detail {
namespace {

std::pair<int, int> column_of(const VoxelKey& key) {
  constexpr unsigned kLog2Edge = 6;
  return {key.x >> kLog2Edge, key.y >> kLog2Edge};
}

}  // namespace

HitPoints::HitPoints(const VoxelGrid& map) : near_(static_cast<float>(map.resolution() / 8)) {
  map.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    // Larger blocks are the inside of something.
    if (block.log2_edge > Brick::kLog2 || (brick == nullptr && state != Occupancy::kOccupied)) return;
    const int last = (1 << block.log2_edge) - 1;
    const VoxelKey& low = block.corner;
    for_each_key({low, make_key(low.x + last, low.y + last, low.z + last)}, [&](const VoxelKey& key) {
      if (map.at(key) == Occupancy::kOccupied) points_[key] = {map.lattice().center(key), 0, kLeastEnded, 0};
    });
  });
}

std::vector<VoxelKey> HitPoints::insert(const Scan& scan, const Mapping& mapping, const MapChange& change) {
  ++scans_;
  std::vector<VoxelKey> solid;
  const Lattice& lattice = change.grid.lattice();
  const auto is_free = [&](const VoxelKey& key) { return change.grid.at(key) == Occupancy::kFree; };
  const auto depth = static_cast<float>(mapping.surface_depth());
  std::pair<const VoxelKey, Point>* last = nullptr;  // neighbouring rays often end in the same voxel
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!std::isfinite(scan.ranges[i])) continue;
    const Eigen::Vector3f hit = scan.origin + scan.directions[i] * scan.ranges[i];
    const Eigen::Vector3f end = scan.origin + scan.directions[i] * (scan.ranges[i] + depth);
    const auto key = lattice.key(end), before = lattice.key(hit);
    if (!key || !mapping.bounds().contains(*key)) continue;
    // At the edge of what is in the voxel before, as a floor's above a pit, there is nothing behind it.
    if (before && *before != *key && (change.grid.at(*before) == Occupancy::kOccupied || is_solid(*before)))
      continue;
    if (last == nullptr || last->first != *key) last = &*points_.try_emplace(*key).first;
    Point& point = last->second;
    const bool is_first = point.scan != scans_, was_solid = point.is_solid();
    point = {end, scans_, static_cast<std::uint8_t>(was_solid ? kLeastEnded : point.ended + 1), 0};
    if ((was_solid && !is_first) || !is_free(*key)) continue;
    free_[column_of(*key)].insert(*key);
    if (point.is_solid() && !was_solid) solid.push_back(*key);
  }
  changed_.insert(changed_.end(), solid.begin(), solid.end());
  for (const VoxelKey& key : change.keys) {
    const auto found = points_.find(key);
    if (found == points_.end()) continue;
    if (!is_free(key)) {
      free_[column_of(key)].erase(key);
      continue;
    }
    free_[column_of(key)].insert(key);
    if (found->second.is_solid()) changed_.push_back(key);  // since it was occupied
  }
  note_passing(scan, lattice);
  return solid;
}

void HitPoints::note_passing(const Scan& scan, const Lattice& lattice) {
  const auto key_at = [&](float reach, std::uint16_t otherwise) {
    const auto along = [&](float at) { return lattice.key(static_cast<double>(at)).value_or(otherwise); };
    return VoxelKey{along(scan.origin.x() + reach), along(scan.origin.y() + reach), 0};
  };
  const auto reach = static_cast<float>(scan.max_range);
  const Column low = column_of(key_at(-reach, 0)), high = column_of(key_at(reach, 0xFFFF));
  const Directions directions(scan.directions);
  for (int x = low.first; x <= high.first; ++x)
    for (auto column = free_.lower_bound({x, low.second});
         column != free_.end() && column->first <= Column{x, high.second}; ++column)
      note_passing(scan, directions, column->second);
}

void HitPoints::note_passing(const Scan& scan, const Directions& directions, std::set<VoxelKey>& column) {
  for (auto voxel = column.begin(); voxel != column.end();) {
    const auto found = points_.find(*voxel);
    Point& point = found->second;
    const int passed = point.scan == scans_ ? 0 : point.passed + passing(scan, directions, point.at);
    point.passed = static_cast<std::uint8_t>(std::min(passed, kMostPassed));
    if (passed < kMostPassed) {
      ++voxel;
      continue;
    }
    if (point.is_solid()) changed_.push_back(*voxel);
    points_.erase(found);
    voxel = column.erase(voxel);
  }
}

// Rays that pass a point; enough of them where the sensor itself is.
int HitPoints::passing(const Scan& scan, const Directions& directions, const Eigen::Vector3f& point) const {
  const auto reach = static_cast<float>(scan.max_range);
  const Eigen::Vector3f offset = point - scan.origin;
  const float distance = offset.norm(), near = std::min(near_, Directions::kFound * distance);
  if (distance <= near_) return kMostPassed;
  if (distance >= reach) return 0;
  int count = 0;
  directions.for_each_near(offset / distance, [&](std::uint32_t ray) {
    const Eigen::Vector3f& direction = scan.directions[ray];
    // None that measures nothing, whose range is NaN.
    const bool goes_on = std::min(scan.ranges[ray], reach) > offset.dot(direction) + near_;
    count += static_cast<int>(goes_on && offset.cross(direction).norm() < near);
  });
  return count;
}

void HitPoints::forget(std::span<const VoxelKey> voxels) {
  for (const VoxelKey& voxel : voxels) {
    if (is_solid(voxel)) changed_.push_back(voxel);
    points_.erase(voxel);
    if (const auto column = free_.find(column_of(voxel)); column != free_.end()) column->second.erase(voxel);
  }
}

bool HitPoints::is_solid(const VoxelKey& voxel) const {
  const auto found = points_.find(voxel);
  return found != points_.end() && found->second.is_solid();
}

std::vector<VoxelKey> HitPoints::take_changed() { return std::exchange(changed_, {}); }

}  // namespace frontlux::planner::detail
