#pragma once

#include "mapping/scan_voxels.hpp"

#include <frontlux/planner/mapping.hpp>

#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// The part of a set of voxels that lies in one octant: of a brick's eight words a word, of a word a byte, of
/// a byte a bit.
inline std::uint64_t part(const Octants& set, unsigned octant) { return set[octant]; }
inline std::uint8_t part(std::uint64_t set, unsigned octant) {
  return static_cast<std::uint8_t>(set >> (8 * octant));
}
inline bool part(std::uint8_t set, unsigned octant) { return ((set >> octant) & 1U) != 0; }

inline bool empty(const Octants& set) {
  return std::all_of(set.begin(), set.end(), [](std::uint64_t word) { return word == 0; });
}
inline bool full(const Octants& set) {
  return std::all_of(set.begin(), set.end(), [](std::uint64_t word) { return ~word == 0; });
}
inline bool empty(std::uint64_t set) { return set == 0; }
inline bool full(std::uint64_t set) { return ~set == 0; }
inline bool empty(std::uint8_t set) { return set == 0; }
inline bool full(std::uint8_t set) { return set == 0xFF; }
inline bool empty(bool set) { return !set; }

template <class Set>
inline constexpr unsigned kVoxels = std::is_same_v<Set, bool> ? 1 : 8 * sizeof(Set);

/// A voxel that became free or occupied and was not so before.
struct StateChange {
  VoxelKey key;
  Occupancy state;
};

/// An OcTree that takes all updates of a scan in one descent, which passes inner nodes once instead of once
/// for each voxel below. What it leaves behind is what `updateNode` for each voxel would, pruning included.
class ScanTree : public octomap::OcTree {
 public:
  ScanTree(double in_resolution, const SensorModel& sensor) : octomap::OcTree(in_resolution) { use(sensor); }
  /// Begins with the nodes of a tree.
  ScanTree(const octomap::OcTree& known, const SensorModel& sensor) : octomap::OcTree(known) {
    setOccupancyThres(0.5);
    enableChangeDetection(false);
    resetChangeDetection();
    use(sensor);
    // Within the sensor model's bounds, or it would take more scans to change them than it says.
    for (auto leaf = begin_leafs(); leaf != end_leafs(); ++leaf)
      leaf->setLogOdds(std::clamp(leaf->getLogOdds(), clamping_thres_min, clamping_thres_max));
    updateInnerOccupancy();
    prune();
  }

  /// @param bricks   in octree order
  /// @param changes  to which changes are appended; each voxel once
  void update(std::span<const BrickUpdate> bricks, std::vector<StateChange>& changes) {
    if (bricks.empty()) return;
    changes_ = &changes;
    const bool created = root == nullptr;
    if (created) {
      root = new octomap::OcTreeNode();
      tree_size++;
    }
    update_above_bricks(*root, created, kLevelsAboveBricks, bricks);
  }

  /// Makes a voxel as free as one miss makes an unknown one, unless it is freer already.
  void set_free(const VoxelKey& key, std::vector<StateChange>& changes) {
    const octomap::OcTreeKey octomap_key(key.x, key.y, key.z);
    const octomap::OcTreeNode* node = search(octomap_key);
    if (node != nullptr && node->getLogOdds() <= prob_miss_log) return;
    if (node == nullptr || isNodeOccupied(node)) changes.push_back({key, Occupancy::kFree});
    setNodeValue(octomap_key, prob_miss_log);
  }

 private:
  static constexpr int kLevelsAboveBricks = 13;

  void use(const SensorModel& sensor) {
    setProbHit(sensor.hit);
    setProbMiss(sensor.miss);
    setClampingThresMin(sensor.least);
    setClampingThresMax(sensor.most);
  }

  [[nodiscard]] float updated(float log_odds, bool hit) const {
    return std::clamp(log_odds + (hit ? prob_hit_log : prob_miss_log), clamping_thres_min,
                      clamping_thres_max);
  }

  [[nodiscard]] bool changes_nothing(const octomap::OcTreeNode& leaf, bool misses, bool hits) const {
    return (!misses || leaf.getLogOdds() <= clamping_thres_min) &&
           (!hits || leaf.getLogOdds() >= clamping_thres_max);
  }

  // The child with this number, and whether it is new.
  std::pair<octomap::OcTreeNode*, bool> child_to_update(octomap::OcTreeNode& node, bool created,
                                                        unsigned number) {
    if (nodeChildExists(&node, number)) return {getNodeChild(&node, number), false};
    if (!created && !nodeHasChildren(&node)) {  // pruned
      expandNode(&node);
      return {getNodeChild(&node, number), false};
    }
    return {createNodeChild(&node, number), true};
  }

  void update_from_children(octomap::OcTreeNode& node) {
    if (!pruneNode(&node)) node.updateOccupancyChildren();
  }

  // All three return whether the node, or one below it, changed.

  bool update_above_bricks(octomap::OcTreeNode& node, bool created, int levels,
                           std::span<const BrickUpdate> bricks) {
    if (levels == 0) {
      corner_ = bricks.front().corner;
      return update_set(node, created, 0, bricks.front().misses, bricks.front().hits);
    }
    if (!created && !nodeHasChildren(&node) &&
        std::all_of(bricks.begin(), bricks.end(), [&](const BrickUpdate& brick) {
          return changes_nothing(node, !empty(brick.misses), !empty(brick.hits));
        }))
      return false;
    const int shift = 3 * (levels - 1);
    bool changed = false;
    while (!bricks.empty()) {
      const std::uint64_t prefix = bricks.front().number >> shift;
      const auto end = std::find_if(bricks.begin(), bricks.end(), [&](const BrickUpdate& brick) {
        return brick.number >> shift != prefix;
      });
      const auto count = static_cast<std::size_t>(end - bricks.begin());
      const auto [child, is_new] = child_to_update(node, created, static_cast<unsigned>(prefix & 7U));
      changed = update_above_bricks(*child, is_new, levels - 1, bricks.first(count)) || is_new || changed;
      bricks = bricks.subspan(count);
    }
    if (changed) update_from_children(node);
    return changed;
  }

  // `first`: the number in octree order of the node's first voxel in its brick.
  template <class Set>
  bool update_set(octomap::OcTreeNode& node, bool created, unsigned first, const Set& misses,
                  const Set& hits) {
    if (!nodeHasChildren(&node)) {
      if (!created && changes_nothing(node, !empty(misses), !empty(hits))) return false;
      if (full(misses) || full(hits)) return update_leaf(node, created, first, kVoxels<Set>, full(hits));
    }
    bool changed = false;
    for (unsigned i = 0; i < 8; ++i) {
      using Part = decltype(part(misses, i));
      const Part child_misses = part(misses, i), child_hits = part(hits, i);
      if (empty(child_misses) && empty(child_hits)) continue;
      const auto [child, is_new] = child_to_update(node, created, i);
      const unsigned child_first = first + i * kVoxels<Part>;
      bool child_changed = false;
      if constexpr (std::is_same_v<Part, bool>)
        child_changed = update_leaf(*child, is_new, child_first, 1, child_hits);
      else
        child_changed = update_set(*child, is_new, child_first, child_misses, child_hits);
      changed = changed || child_changed || is_new;
    }
    if (changed) update_from_children(node);
    return changed;
  }

  bool update_leaf(octomap::OcTreeNode& node, bool created, unsigned first, unsigned voxels, bool hit) {
    const float before = node.getLogOdds(), after = updated(before, hit);
    const bool was_occupied = isNodeOccupied(node);
    node.setLogOdds(after);
    if (created || was_occupied != isNodeOccupied(node))
      for (unsigned i = first; i < first + voxels; ++i) {
        const VoxelKey at = in_brick(i);
        changes_->push_back({make_key(corner_.x + at.x, corner_.y + at.y, corner_.z + at.z),
                             isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree});
      }
    return created || after != before;
  }

  VoxelKey corner_;                              // of the brick at work
  std::vector<StateChange>* changes_ = nullptr;  // of the update at work
};

}  // namespace frontlux::planner::detail
