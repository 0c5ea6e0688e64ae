#include "exploration/driven_path.hpp"

#include "planner/exploration/team_in_world.hpp"

#include <frontlux/planner/path_planner.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace frontlux::planner::detail {
namespace {

const MotionLimits kLimits;
constexpr double kFarApart = 0.3;  // [m]

Pose at(double x, double y) { return {{x, y, 1.0}, 0.0}; }

Trajectory along(std::span<const Pose> viewpoints, double time) {
  MotionState start;
  start.pose = viewpoints.front();
  return Trajectory::through(start, time, viewpoints, kLimits, [](auto&&...) { return true; }).value();
}

// 6 m along x, 4 m along y, and back along x.
const std::array<Pose, 4> kAround = {at(0, 0), at(6, 0), at(6, 4), at(0, 4)};

// [m] How far a path leads at most from where trajectories do.
double farthest_off(std::span<const Pose> path, std::span<const Trajectory> trajectories) {
  double farthest = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i)
    for (double part = 0.0; part <= 1.0; part += 0.05) {
      const Eigen::Vector3d point = path[i - 1].position + part * (path[i].position - path[i - 1].position);
      double off = std::numeric_limits<double>::infinity();
      for (const Trajectory& trajectory : trajectories)
        for (double time = trajectory.begin(); time <= trajectory.end(); time += 0.01)
          off = std::min(off, (trajectory.at(time).pose.position - point).norm());
      farthest = std::max(farthest, off);
    }
  return farthest;
}

TEST(DrivenPath, IsThatOfScansThatAreNear) {
  DrivenPath driven;
  const Trajectory trajectory = along(kAround, 0.0);
  driven.follow(trajectory, 2.0);
  std::vector<Pose> scans;
  for (double time = 0.0; time <= 2.0; time += 0.1) {
    Pose scanned = trajectory.at(time).pose;
    scanned.position.y() += 0.1;  // localization is never exact
    scans.push_back(scanned);
  }
  EXPECT_TRUE(test::same(driven.through(scans, kFarApart), scans));
}

TEST(DrivenPath, LeadsAroundCornersWhereScansAreLost) {
  DrivenPath driven;
  const Trajectory trajectory = along(kAround, 5.0);
  const std::array<Pose, 2> ends = {kAround.front(), kAround.back()};
  for (double time = 5.0; time < trajectory.end() + 1.0; time += 0.7) driven.follow(trajectory, time);
  const std::vector<Pose> path = driven.through(ends, kFarApart);
  EXPECT_TRUE(test::same(path.front(), ends[0]));
  EXPECT_TRUE(test::same(path.back(), ends[1]));
  EXPECT_LT(farthest_off(path, {&trajectory, 1}), 0.05);
  EXPECT_NEAR(path_length(path), trajectory.length(), 0.1);
  EXPECT_LT(path.size(), 40U) << "straight where it was";
}

// Scans are known at some plannings, and the path to the next one lies in several of them.
TEST(DrivenPath, IsKeptUntilTheNextScan) {
  DrivenPath driven;
  const Trajectory trajectory = along(kAround, 0.0);
  driven.follow(trajectory, 1.0);
  const std::array<Pose, 2> first = {kAround.front(), trajectory.at(0.8).pose};
  const std::vector<Pose> begin = driven.through(first, kFarApart);
  EXPECT_EQ(begin.size(), 2U);
  driven.follow(trajectory, trajectory.end() / 2);
  EXPECT_EQ(driven.through({&first[1], 1}, kFarApart).size(), 1U) << "no scan";
  driven.follow(trajectory, trajectory.end());
  const std::array<Pose, 2> last = {first[1], kAround.back()};
  EXPECT_LT(farthest_off(driven.through(last, kFarApart), {&trajectory, 1}), 0.05);
}

// A robot that has stopped has followed its trajectory up to there, and another one from then on.
TEST(DrivenPath, LeadsAlongSeveralTrajectories) {
  DrivenPath driven;
  const Trajectory first = along(kAround, 0.0);
  const Pose rests = first.at(5.0).pose;
  driven.follow(first, 5.0);
  const std::array<Pose, 3> back = {rests, at(rests.position.x(), -3), at(0, -3)};
  const Trajectory second = along(back, 5.0);
  driven.follow(second, 30.0);
  const std::array<Pose, 2> ends = {kAround.front(), back.back()};
  const std::vector<Pose> path = driven.through(ends, kFarApart);
  EXPECT_LT(farthest_off(path, std::array{first, second}), 0.05);
  EXPECT_NEAR(path_length(path), rests.position.x() + second.length(), 0.1) << "it stopped before the corner";
}

TEST(DrivenPath, NeedsNoTrajectory) {
  DrivenPath driven;
  const std::array<Pose, 2> ends = {kAround.front(), kAround.back()};
  EXPECT_TRUE(test::same(driven.through(ends, kFarApart), ends));
  EXPECT_TRUE(driven.through({}, kFarApart).empty());
}

}  // namespace
}  // namespace frontlux::planner::detail
