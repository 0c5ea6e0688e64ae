#pragma once

#include "planner/goal/goal_room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace frontlux::test {

using planner::Goal;
using planner::goal_options;
using planner::GoalOptions;
using planner::GoalRule;
using planner::GoalSelection;
using planner::GoalState;
using planner::Method;
using planner::PathMetric;
using planner::Pose;
using planner::Robot;
using planner::TeamGoals;
using planner::TeamMember;
using planner::TravelDistance;

inline constexpr double kResolution = 0.3;
inline constexpr int kAllCells = 1 << 30;

inline TeamMember ground_robot() {
  TeamMember member{planner::ugv(), {}};
  member.robot.travel.metric = PathMetric::kSteps;
  member.robot.view.max_range = 3.0;
  member.options = goal_options(member.robot);
  return member;
}

inline TeamMember aerial_robot(Method method = Method::kDefault) {
  TeamMember member{planner::uav(method), {}};
  member.robot.travel.metric = PathMetric::kSteps;
  member.robot.travel.min_height = 0.0;
  member.robot.view.max_range = 3.0;
  member.options = goal_options(member.robot, method);
  return member;
}

/// Eq. 1, with the default's preference for cells that are 4 m away or farther.
inline double worth(double gain, double distance) {
  return gain * std::exp(-0.1386 * distance) * std::min(1.0, distance / 4.0);
}

struct Found {
  VoxelKey cell;
  double gain = 0.0, quality = -1.0, yaw = 0.0;
};

/// As the best windows of bins are defined: whole bins, the first of the best ones.
inline Found best_yaw(const VoxelKey& cell, const std::vector<VoxelKey>& seen, double horizontal,
                      const VoxelKey* containing) {
  constexpr int kBins = 36;
  const auto bin = [&](const VoxelKey& target) {
    const Eigen::Vector3d to = offset_between(cell, target, 1.0);
    double degrees = std::atan2(to.y(), to.x()) * 180 / std::numbers::pi;
    if (degrees < 0) degrees += 360;
    return static_cast<int>(degrees / 10 + 1e-9) % kBins;
  };
  const int width = static_cast<int>(horizontal * 180 / std::numbers::pi / 10 + 1e-9);
  Found best{cell, -1.0, -1.0, 0.0};
  for (int first = 0; first < kBins; ++first) {
    const auto inside = [&](const VoxelKey& target) { return (bin(target) - first + kBins) % kBins < width; };
    if (containing != nullptr && !inside(*containing)) continue;
    const auto gain = static_cast<double>(std::count_if(seen.begin(), seen.end(), inside));
    if (gain > best.gain) {
      best.gain = gain;
      best.yaw = std::remainder((first + width / 2.0) * 10 * std::numbers::pi / 180, 2 * std::numbers::pi);
    }
  }
  return best;
}

inline void expect_goal(const Goal& goal, const std::optional<Found>& truth) {
  ASSERT_EQ(goal.pose.has_value(), truth.has_value()) << goal.reason;
  if (!truth) return;
  EXPECT_EQ(goal.cell, truth->cell);
  EXPECT_EQ(goal.gain, truth->gain);
  EXPECT_EQ(goal.standard_error, 0.0);
  EXPECT_NEAR(goal.quality, truth->quality, 1e-9 * truth->quality);
}

}  // namespace frontlux::test
