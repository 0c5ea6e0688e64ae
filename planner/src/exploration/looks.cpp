#include "casting/counting_ray_caster.hpp"
#include "exploration/continuous_state.hpp"
#include "exploration/frontiers_near_path.hpp"
#include "exploration/phase_clock.hpp"
#include "mapping/directions.hpp"
#include "mapping/sort_once.hpp"
#include "motion/yaw.hpp"

#include <cmath>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::sort_once;

using Keys = std::vector<VoxelKey>;

bool is_near(const Pose& pose, const Pose& other, double length, double angle) {
  return (pose.position - other.position).norm() < length &&
         std::abs(detail::turn(other.yaw, pose.yaw)) < angle;
}

}  // namespace

// Whether a pose is about where a robot's trajectory ends.
bool ContinuousExploration::State::is_at_end(const Member& member, const Pose& pose) const {
  constexpr double kAligned = 0.1;  // [rad]
  return is_near(pose, member.motion.last().end_pose(), team.lattice().resolution() / 2, kAligned);
}

// Whether a robot has taken a scan at its goal, or rests and takes scans all of which are from beside it. One
// that is told that it is a little beside its trajectory's end will not get nearer; scans may be rare, or
// late.
bool ContinuousExploration::State::has_looked(const Member& member, double time) const {
  constexpr double kNear = 0.01, kAligned = 0.01, kSoon = 0.5;  // [m], [rad], [s]
  constexpr int kMostMissed = 3;
  const Trajectory& trajectory = member.motion.last();
  if (!member.looked) return false;
  if (is_near(*member.last_look, trajectory.end_pose(), kNear, kAligned)) return true;
  return member.missed_looks >= kMostMissed ||
         (time >= trajectory.end() + kSoon && is_at_end(member, *member.last_look));
}

// Frontiers in view of the robot's last scan, in directions in which it measured, that have stayed unknown
// all the same. Where it has arrived these are also the ones for which it came: planning, between the middles
// of voxels, may see past an edge that hides them from where it is. So are they if all scans come from beside
// it, or if none shows anything for so long that it would choose its goal anew.
void ContinuousExploration::State::note_look(std::size_t robot, PlanReason reason, ExplorationStep& step) {
  const detail::PhaseClock clock(step, Phase::kGoals);
  constexpr double kNear = 0.05, kAligned = 0.05;  // [m], [rad] of two scans of a robot at rest
  RobotStep& now = step.robots[robot];
  Member& member = members[robot];
  const auto give_up_goal = [&] {
    for (const VoxelKey& key : member.goal_frontiers)
      if (team.frontiers.contains(key)) now.still_unknown.push_back(key);
    sort_once(now.still_unknown);
  };
  if (!std::exchange(member.looked, false)) {
    const bool arrived = step.time >= member.motion.last().end() && is_at_end(member, member.sensed.back());
    if (member.sees_nothing && arrived && step.time - member.chosen >= team.options.commitment) {
      give_up_goal();
      team.abandoned.visited(now.still_unknown);
    }
    return;
  }
  const Pose& pose = *member.last_look;
  const FieldOfView& view = team.options.team[robot].robot.view;
  const Keys frontiers =
      detail::frontiers_near_path(team.lattice(), team.frontiers.keys(), {&pose, 1}, view.max_range);
  const detail::CountingRayCaster counting(*team.caster, team.lattice());
  const VisiblePairs seen = visible_pairs(counting, team.mapping.grid(), {&pose, 1}, frontiers, view);
  const detail::Directions directions(member.measured);
  const auto is_measured = [&](const Eigen::Vector3f& direction) {
    constexpr float kFound = detail::Directions::kFound;
    bool found = false;
    directions.for_each_near(direction, [&](std::uint32_t i) {
      found = found || (member.measured[i] - direction).squaredNorm() < kFound * kFound;
    });
    return found;
  };
  for (const std::uint32_t i : seen.frontiers_of(0)) {
    const Eigen::Vector3d offset = team.lattice().exact_center(frontiers[i]) - pose.position;
    if (view.contains(offset, pose.yaw) && is_measured(offset.normalized().cast<float>()))
      now.still_unknown.push_back(frontiers[i]);
  }
  const Trajectory& last = member.motion.last();
  const bool goes_there = member.goal.pose && team.lattice().key(member.goal.pose->position) ==
                                                  team.lattice().key(last.end_pose().position);
  const bool has_not_moved = member.look_before && is_near(pose, *member.look_before, kNear, kAligned);
  member.look_before = pose;
  const bool missed =
      goes_there && has_not_moved && reason != PlanReason::kArrival && step.time >= last.end();
  member.missed_looks = missed ? member.missed_looks + 1 : 0;
  if (goes_there && reason == PlanReason::kArrival) give_up_goal();
  step.rays += counting.rays();
  team.abandoned.visited(now.still_unknown);
}

}  // namespace frontlux::planner
