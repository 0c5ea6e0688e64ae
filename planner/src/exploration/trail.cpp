#include "exploration/trail.hpp"

#include "exploration/continuous_state.hpp"

#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace frontlux::planner {
namespace {

// [m] From a place to a line, and not to what lies beyond its ends: a robot may brake and turn back.
double off_line(const Eigen::Vector3d& place, const Eigen::Vector3d& begin, const Eigen::Vector3d& end) {
  const Eigen::Vector3d line = end - begin, along = line.stableNormalized(), to = place - begin;
  return (to - std::clamp(to.dot(along), 0.0, line.norm()) * along).norm();
}

constexpr double kOff = 0.03;  // [m] of a robot's places from the lines that stand for its path

}  // namespace

std::vector<Pose> detail::poses_along(const Trajectory& trajectory, double from) {
  constexpr double kStep = 0.1, kMost = 10'000.0;  // [s], poses
  constexpr std::size_t kMostLeftOut = 200;        // in a row: each is looked at for each that follows
  const double begin = std::max(from, trajectory.begin()), time = std::max(0.0, trajectory.end() - begin);
  const double steps = std::clamp(std::ceil(time / kStep), 1.0, kMost);
  std::vector<Pose> all, some;
  for (double i = 0.0; i <= steps; ++i) all.push_back(trajectory.at(begin + i / steps * time).pose);
  const auto straight = [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a + 1; i < b; ++i)
      if (off_line(all[i].position, all[a].position, all[b].position) > kOff) return false;
    return true;
  };
  for (std::size_t kept = 0, i = 0; i < all.size(); ++i) {
    if (i > 0 && i + 1 < all.size() && i - kept < kMostLeftOut && straight(kept, i + 1)) continue;
    some.push_back(all[i]);
    kept = i;
  }
  return some;
}

// A robot has followed its trajectory up to a time. Scans may be lost. Places of the trail are at most about
// a voxel apart, and the lines between them are where the robot was.
void ContinuousExploration::State::extend_trail(std::size_t robot, double until) {
  constexpr double kStep = 0.1;  // [s]
  Member& member = members[robot];
  const Trajectory& trajectory = member.motion.now;
  std::vector<Pose>& trail = team.trails[robot];
  const auto add = [&](const Pose& place, double apart) {
    const auto key = team.lattice().key(place.position);
    if (!key || !team.mapping.bounds().contains(*key)) return;
    if (!trail.empty() && place.position == (member.passed.empty() ? trail : member.passed).back().position)
      return;  // it rests
    const auto is_off = [&](const Pose& passed) {
      return off_line(passed.position, trail.back().position, place.position) > kOff;
    };
    if (!trail.empty() && std::ranges::any_of(member.passed, is_off)) {
      trail.push_back(member.passed.back());
      member.passed.clear();
    }
    if (trail.empty() || (place.position - trail.back().position).norm() > apart) {
      trail.push_back(place);
      member.passed.clear();
    } else {
      member.passed.push_back(place);
    }
  };
  const auto next = [&] { return trajectory.begin() + kStep * static_cast<double>(member.samples); };
  for (; next() < std::min(until, trajectory.end()); ++member.samples)
    add(trajectory.at(next()).pose, team.lattice().resolution());
  if (until >= trajectory.end()) add(trajectory.end_pose(), 0.0);
}

// A robot has come to rest before the end of its trajectory, some time ago perhaps: it has been nowhere
// beyond.
void ContinuousExploration::State::cut_trail(std::size_t robot, const Eigen::Vector3d& rests) {
  constexpr double kLate = 10.0;  // [s] after which a stop is told at most
  std::vector<Pose>& trail = team.trails[robot];
  // It may have gone around a corner that the trail has not yet.
  for (const Pose& pose : std::exchange(members[robot].passed, {})) trail.push_back(pose);
  double rest = kLate * team.options.team[robot].robot.limits.speed;  // [m]
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t last = trail.size();
  for (std::size_t i = trail.size(); i-- > 0 && rest >= 0.0;) {
    const double off = (trail[i].position - rests).norm();
    if (off <= nearest) last = i;
    nearest = std::min(nearest, off);
    if (i > 0) rest -= (trail[i].position - trail[i - 1].position).norm();
  }
  if (last < trail.size()) trail.resize(last + 1);
}

// A robot that is farther from its trail than `tolerance` [m] goes back over it only if it can get there.
void ContinuousExploration::State::leave_trail(std::size_t robot, double tolerance) {
  std::vector<Pose>& trail = team.trails[robot];
  if (trail.empty()) return;
  const Eigen::Vector3d here = members[robot].motion.last().end_pose().position;
  if ((trail.back().position - here).norm() <= tolerance) return;
  const auto is_free = [&](const VoxelKey& key) { return team.mapping.grid().at(key) == Occupancy::kFree; };
  members[robot].passed.clear();
  if (!SegmentVoxels(team.lattice(), trail.back().position, here).all_of(is_free)) trail.clear();
}

}  // namespace frontlux::planner
