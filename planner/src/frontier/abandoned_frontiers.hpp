#pragma once

#include <frontlux/ray.hpp>

#include <map>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Frontiers that stay unknown although they were looked at, until they are given up.
class AbandonedFrontiers {
 public:
  /// @param max_visits  a frontier is given up after so many visits
  explicit AbandonedFrontiers(int max_visits) : max_visits_(max_visits) {}

  /// These were in view, and have stayed unknown.
  void visited(std::span<const VoxelKey> frontiers) {
    for (const VoxelKey& key : frontiers) ++visits_[key];
  }

  [[nodiscard]] bool abandoned(const VoxelKey& key) const {
    const auto found = visits_.find(key);
    return found != visits_.end() && found->second >= max_visits_;
  }

  /// Those not given up, in their order.
  [[nodiscard]] std::vector<VoxelKey> without_abandoned(std::span<const VoxelKey> frontiers) const {
    std::vector<VoxelKey> rest;
    rest.reserve(frontiers.size());
    for (const VoxelKey& key : frontiers)
      if (!abandoned(key)) rest.push_back(key);
    return rest;
  }

 private:
  int max_visits_;
  std::map<VoxelKey, int> visits_;
};

}  // namespace frontlux::planner::detail
