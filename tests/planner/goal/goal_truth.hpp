#pragma once

#include "planner/goal/goal_room.hpp"

namespace frontlux::test {

using namespace planner;

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

/// What one robot decides in a room, and by what.
struct Decision {
  const GoalRoom& room;
  TeamMember member;
  VoxelKey start;
  std::vector<VoxelKey> frontiers;
  std::unique_ptr<RayCaster> caster = make_grid_ray_caster(room.grid);
  GoalSelection selection{{member}, room.grid.lattice(), room.bounds()};
  TeamGoals team;

  Decision(const GoalRoom& in, const TeamMember& robot, const VoxelKey& at, std::vector<VoxelKey> known)
      : room(in), member(robot), start(at), frontiers(std::move(known)) {
    const Pose pose{room.grid.lattice().exact_center(start), 0.0};
    team = selection.select(*caster, {room.grid}, frontiers, {&pose, 1});
  }
  [[nodiscard]] const Goal& goal() const { return team.goals[0]; }
  [[nodiscard]] std::span<const VoxelKey> cells() const { return selection.corridor(0).cells(); }
  [[nodiscard]] std::vector<VoxelKey> assigned() const {
    return naive_assigned(*caster, kResolution, frontiers, cells(), member.robot.view);
  }
  [[nodiscard]] std::vector<VoxelKey> seen_from(const VoxelKey& cell,
                                                const std::vector<VoxelKey>& targets) const {
    return naive_seen(*caster, kResolution, cell, targets, member.robot.view);
  }
};

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

/// With the gain that its yaw truly shows: at the edges of one yaw's view less height is in view than in a
/// window of azimuths.
inline Found in_true_view(Found found, const std::vector<VoxelKey>& seen, const FieldOfView& view) {
  found.gain = static_cast<double>(std::ranges::count_if(seen, [&](const VoxelKey& target) {
    return view.contains(offset_between(found.cell, target, kResolution), found.yaw);
  }));
  return found;
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
