#include "path/polyline.hpp"
#include <frontlux/planner/segment_voxels.hpp>
#include "path/sampling_search.hpp"

#include <frontlux/planner/path_planner.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::Polyline;

constexpr double kShortest = 0.01;  // [m] of range and spacing
constexpr int kMaxIterations = 1'000'000;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("path: " + what); }

void check(const char* name, const Pose& pose) {
  const auto number = [name](const char* part, double value) {
    if (!std::isfinite(value))
      refuse(std::string(name) + "." + part + " is " + std::to_string(value) + ", but has to be finite");
  };
  number("x", pose.position.x());
  number("y", pose.position.y());
  number("z", pose.position.z());
  number("yaw", pose.yaw);
}

void check(const PathOptions& options) {
  const auto at_least = [](const char* name, double value) {
    if (!(value >= kShortest && std::isfinite(value)))
      refuse(std::string(name) + " is " + std::to_string(value) + " m, but has to be at least " +
             std::to_string(kShortest) + " m and finite");
  };
  at_least("range", options.range);
  at_least("spacing", options.spacing);
  if (options.iterations < 1 || options.iterations > kMaxIterations)
    refuse("iterations is " + std::to_string(options.iterations) + ", but has to be 1 to " +
           std::to_string(kMaxIterations));
  if (!(options.goal_bias >= 0.0 && options.goal_bias <= 1.0))
    refuse("goal_bias is " + std::to_string(options.goal_bias) + ", but has to be 0 to 1");
  if (options.shortcut_rounds < 0)
    refuse("shortcut_rounds is " + std::to_string(options.shortcut_rounds) + ", but has to be 0 or more");
}

std::optional<VoxelKey> voxel_of(const Lattice& lattice, const Eigen::Vector3d& point) {
  const auto x = lattice.key(point.x()), y = lattice.key(point.y()), z = lattice.key(point.z());
  if (!x || !y || !z) return std::nullopt;
  return VoxelKey{*x, *y, *z};
}

std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 33)) * 0xFF51AFD7ED558CCD;
  bits = (bits ^ (bits >> 33)) * 0xC4CEB9FE1A85EC53;
  return bits ^ (bits >> 33);
}

std::uint64_t seed_of(const PathKey& key) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  return mixed(mixed(mixed(key.seed + kOdd) + key.step + kOdd) + key.robot + kOdd);
}

// Ways from the robot's cell are a tree: down to where those of start and goal part, and up again.
std::vector<VoxelKey> cells_between(const TravelCorridor& corridor, const VoxelKey& start,
                                    const VoxelKey& goal) {
  std::vector<VoxelKey> down = corridor.path_to(start);
  const std::vector<VoxelKey> up = corridor.path_to(goal);
  std::size_t common = 0;
  while (common < down.size() && common < up.size() && down[common] == up[common]) ++common;
  std::reverse(down.begin(), down.end());
  std::vector<VoxelKey> cells(down.begin(), down.end() - static_cast<std::ptrdiff_t>(common - 1));
  cells.insert(cells.end(), up.begin() + static_cast<std::ptrdiff_t>(common), up.end());
  return cells;
}

Eigen::Vector3d center_of(const Lattice& lattice, const VoxelKey& key) {
  return {lattice.center(key.x), lattice.center(key.y), lattice.center(key.z)};
}

// The nearest place where a robot is sure to be free if its cell is passable: the middle of the voxel, along
// the axes on which that matters.
Eigen::Vector3d steady(const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& point) {
  return (corridor.reach().array() > 0.0).select(center_of(lattice, *voxel_of(lattice, point)), point);
}

// Free without a look: from cell to cell the corridor cuts no corner, so two of them that follow each other,
// and what lies between, are free in every point. A box that is smaller than a voxel does not leave them
// between their middles; nor does it, on its way to the middle of a voxel, come to voxels that it was not in.
Polyline corridor_way(const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& start,
                      const Eigen::Vector3d& goal) {
  const auto cells = cells_between(corridor, *voxel_of(lattice, start), *voxel_of(lattice, goal));
  Polyline way = {start};
  const auto add = [&](const Eigen::Vector3d& point) {
    if (point != way.back()) way.push_back(point);
  };
  add(steady(corridor, lattice, start));
  for (std::size_t i = 1; i + 1 < cells.size(); ++i) add(center_of(lattice, cells[i]));
  add(steady(corridor, lattice, goal));
  add(goal);
  return way;
}

bool on_one_layer(std::span<const VoxelKey> cells) {
  return std::all_of(cells.begin(), cells.end(), [&](const VoxelKey& c) { return c.z == cells.front().z; });
}

// All on the layer that holds both ends.
void set_heights(Polyline& way, double start, double goal) {
  const double length = detail::length_of(way);
  double gone = 0.0;
  Eigen::Vector3d before = way.front();
  for (Eigen::Vector3d& point : way) {
    gone += (point - before).norm();
    before = point;
    const double part = length > 0.0 ? std::min(gone / length, 1.0) : 0.0;
    point.z() = std::clamp(start + part * (goal - start), std::min(start, goal), std::max(start, goal));
  }
}

std::vector<Pose> with_yaws(const Polyline& way, const Pose& start, const Pose& goal) {
  std::vector<Pose> viewpoints;
  double yaw = start.yaw;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (i > 0 && i + 1 < way.size()) {
      const Eigen::Vector3d on = way[i + 1] - way[i];
      if (on.x() != 0.0 || on.y() != 0.0) yaw = std::atan2(on.y(), on.x());
    }
    viewpoints.push_back({way[i], yaw});
  }
  viewpoints.front() = start;
  viewpoints.back() = goal;
  return viewpoints;
}

std::optional<PathOutcome> obstacle(const TravelCorridor& corridor, const Lattice& lattice, const Pose& start,
                                    const Pose& goal) {
  if (corridor.state() != CorridorState::kReady) return PathOutcome::kNoCorridor;
  const auto from = voxel_of(lattice, start.position), to = voxel_of(lattice, goal.position);
  if (!from || !corridor.passable(*from)) return PathOutcome::kStartNotFree;
  if (!to || !corridor.passable(*to)) return PathOutcome::kGoalNotFree;
  // A robot may turn where it is, free or not.
  if (start.position != goal.position && !way_is_free(corridor, lattice, goal.position, goal.position))
    return PathOutcome::kGoalNotFree;
  if (corridor.cells().empty()) return PathOutcome::kNoCorridor;
  if (!corridor.contains(*from) || !corridor.contains(*to)) return PathOutcome::kOutOfReach;
  return std::nullopt;
}

}  // namespace

std::string_view name_of(PathSearch search) {
  switch (search) {
    case PathSearch::kRrt:
      return "rrt";
    case PathSearch::kRrtConnect:
      return "rrt-connect";
    case PathSearch::kRrtStar:
      return "rrt-star";
    case PathSearch::kCorridor:
      return "corridor";
  }
  return "unknown";
}

std::string_view name_of(PathOutcome outcome) {
  switch (outcome) {
    case PathOutcome::kFound:
      return "found";
    case PathOutcome::kFellBack:
      return "fell_back";
    case PathOutcome::kInPlace:
      return "in_place";
    case PathOutcome::kNoCorridor:
      return "no_corridor";
    case PathOutcome::kStartNotFree:
      return "start_not_free";
    case PathOutcome::kGoalNotFree:
      return "goal_not_free";
    case PathOutcome::kOutOfReach:
      return "out_of_reach";
  }
  return "unknown";
}

std::string_view describe(PathOutcome outcome) {
  switch (outcome) {
    case PathOutcome::kFound:
      return "was found by the search";
    case PathOutcome::kFellBack:
      return "is the corridor's own, since the search found none within its iterations";
    case PathOutcome::kInPlace:
      return "has no length: start and goal are the same point";
    case PathOutcome::kNoCorridor:
      return "is not there: the robot has no corridor";
    case PathOutcome::kStartNotFree:
      return "is not there: the space that the robot needs at the start is not known to be free";
    case PathOutcome::kGoalNotFree:
      return "is not there: the space that the robot needs at the goal is not known to be free";
    case PathOutcome::kOutOfReach:
      return "is not there: the robot's corridor does not connect start and goal";
  }
  return "ended in no known way";
}

bool way_is_free(const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  return SegmentVoxels(lattice, from, to, corridor.reach()).all_of([&](const VoxelKey& key) {
    return corridor.passable(key);
  });
}

double path_length(std::span<const Pose> viewpoints) {
  double length = 0.0;
  for (std::size_t i = 1; i < viewpoints.size(); ++i)
    length += (viewpoints[i].position - viewpoints[i - 1].position).norm();
  return length;
}

PathPlan plan_path(const TravelCorridor& corridor, const Lattice& lattice, const Pose& start,
                   const Pose& goal, const PathKey& key, const PathOptions& options) {
  check("start", start);
  check("goal", goal);
  check(options);
  if (corridor.cell_of({0, 0, 0}) != VoxelKey{0, 0, 0})
    refuse(
        "the corridor is one of nodes; plan in one of voxels, which has a cell at the centre of each node");

  PathPlan plan;
  if (const auto reason = obstacle(corridor, lattice, start, goal)) {
    plan.outcome = *reason;
    return plan;
  }
  if (start.position == goal.position) {
    plan.outcome = PathOutcome::kInPlace;
    plan.viewpoints = {start, goal};
    return plan;
  }

  detail::TreeQuery query;
  const bool begins_free = way_is_free(corridor, lattice, start.position, start.position);
  query.start = begins_free ? start.position : steady(corridor, lattice, start.position);
  query.goal = goal.position;
  query.reach = corridor.reach();
  query.cells = corridor.cells();
  query.plane = on_one_layer(query.cells);
  query.seed = seed_of(key);
  if (query.plane) query.goal.z() = query.start.z();
  const auto is_free = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return way_is_free(corridor, lattice, from, to);
  };

  Polyline way;
  plan.outcome = PathOutcome::kFound;
  if (is_free(query.start, query.goal)) {
    way = {query.start, query.goal};  // what shortening would make of any path
  } else if (options.search != PathSearch::kCorridor) {
    auto [found, iterations] = detail::search_tree(lattice, query, options, is_free);
    way = std::move(found);
    plan.iterations = iterations;
    if (way.empty()) plan.outcome = PathOutcome::kFellBack;
  }
  if (way.empty()) way = corridor_way(corridor, lattice, query.start, query.goal);
  way.front() = query.start;
  way.back() = query.goal;
  if (way.size() == 2 && way.front() == way.back()) way.pop_back();

  const double step = std::max(options.spacing / 2, lattice.resolution());  // a smaller one gains nothing
  way = detail::shortened(std::move(way), step, options.shortcut_rounds, is_free);
  if (query.plane) set_heights(way, query.start.z(), goal.position.z());
  if (!begins_free) way.insert(way.begin(), start.position);
  way = detail::divided(way, options.spacing);
  plan.viewpoints = with_yaws(way, start, goal);
  plan.length = path_length(plan.viewpoints);
  return plan;
}

}  // namespace frontlux::planner
