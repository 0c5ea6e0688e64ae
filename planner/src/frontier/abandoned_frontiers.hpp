#pragma once

#include <frontlux/ray.hpp>

#include <map>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Counts how often frontiers were in view and stayed unknown. After some visits they are abandoned.
class AbandonedFrontiers {
 public:
  /// @param max_visits  after which a frontier is abandoned
  explicit AbandonedFrontiers(int max_visits) : max_visits_(max_visits) {}

  /// These were in view and stayed unknown.
  void visited(std::span<const VoxelKey> frontiers) {
    for (const VoxelKey& key : frontiers) ++visits_[key];
  }

  [[nodiscard]] bool abandoned(const VoxelKey& key) const {
    const auto found = visits_.find(key);
    return found != visits_.end() && found->second >= max_visits_;
  }

  /// Those that are not abandoned, in their order.
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
