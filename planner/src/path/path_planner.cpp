#include "path/polyline.hpp"
#include "path/sampling_search.hpp"

#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/segment_voxels.hpp>
#include <frontlux/split_mix.hpp>

#include <algorithm>
#include <array>
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

// The finalizer of MurmurHash3.
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 33)) * 0xFF51AFD7ED558CCD;
  bits = (bits ^ (bits >> 33)) * 0xC4CEB9FE1A85EC53;
  return bits ^ (bits >> 33);
}

std::uint64_t seed_of(const PathKey& key) {
  constexpr std::uint64_t kOdd = SplitMix64::kStep;
  return mixed(mixed(mixed(key.seed + kOdd) + key.step + kOdd) + key.robot + kOdd);
}

// Along the paths from the robot's cell: from the start back to where those to both part, and on to the goal.
// None if there are no such paths.
std::vector<VoxelKey> cells_between(const TravelCorridor& corridor, const VoxelKey& start,
                                    const VoxelKey& goal) {
  std::vector<VoxelKey> back = corridor.path_to(start);
  const std::vector<VoxelKey> on = corridor.path_to(goal);
  if (back.empty() || on.empty()) return {};
  std::size_t common = 0;
  while (common < back.size() && common < on.size() && back[common] == on[common]) ++common;
  std::reverse(back.begin(), back.end());
  std::vector<VoxelKey> cells(back.begin(), back.end() - static_cast<std::ptrdiff_t>(common - 1));
  cells.insert(cells.end(), on.begin() + static_cast<std::ptrdiff_t>(common), on.end());
  return cells;
}

// The nearest place where a robot certainly fits if its cell is passable: its place in there, along the axes on
// which the body reaches beyond the collision box.
Eigen::Vector3d nearest_fit(const TravelCorridor& corridor, const Lattice& lattice,
                            const Eigen::Vector3d& point) {
  return (corridor.reach().array() > 0.0).select(corridor.place_in(*lattice.key(point)), point);
}

// This path needs no check. From cell to cell the corridor cuts no corner, so two successive cells, and what
// lies between them, are free in every point. A box that is smaller than a voxel stays in them between their
// middles, and it enters no other voxels when it moves to the middle of one.
Polyline corridor_path(const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& goal) {
  const auto cells = cells_between(corridor, *lattice.key(start), *lattice.key(goal));
  if (cells.empty()) return {};
  Polyline path = {start};
  const auto add = [&](const Eigen::Vector3d& point) {
    if (point != path.back()) path.push_back(point);
  };
  add(nearest_fit(corridor, lattice, start));
  for (std::size_t i = 1; i + 1 < cells.size(); ++i) add(corridor.place_in(cells[i]));
  add(nearest_fit(corridor, lattice, goal));
  add(goal);
  return path;
}

bool on_one_layer(std::span<const VoxelKey> cells) {
  return std::all_of(cells.begin(), cells.end(), [&](const VoxelKey& c) { return c.z == cells.front().z; });
}

// Heights that change evenly from start to goal.
void set_heights(Polyline& path, double start, double goal) {
  const double length = detail::length_of(path);
  double travelled = 0.0;
  Eigen::Vector3d before = path.front();
  for (Eigen::Vector3d& point : path) {
    travelled += (point - before).norm();
    before = point;
    const double part = length > 0.0 ? std::min(travelled / length, 1.0) : 0.0;
    point.z() = std::clamp(start + part * (goal - start), std::min(start, goal), std::max(start, goal));
  }
}

std::vector<Pose> with_yaws(const Polyline& path, const Pose& start, const Pose& goal) {
  std::vector<Pose> viewpoints;
  double yaw = start.yaw;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && i + 1 < path.size()) yaw = yaw_along(path[i + 1] - path[i], yaw);
    viewpoints.push_back({path[i], yaw});
  }
  viewpoints.front() = start;
  viewpoints.back() = goal;
  return viewpoints;
}

std::optional<PathOutcome> reason_for_none(const TravelCorridor& corridor, const Lattice& lattice,
                                           const Pose& start, const Pose& goal) {
  if (corridor.state() != CorridorState::kReady) return PathOutcome::kNoCorridor;
  const auto from = lattice.key(start.position), to = lattice.key(goal.position);
  if (!from || !corridor.passable(*from)) return PathOutcome::kStartNotFree;
  if (!to || !corridor.passable(*to)) return PathOutcome::kGoalNotFree;
  // A robot may turn in place, whether it fits or not.
  if (start.position != goal.position && !segment_is_free(corridor, lattice, goal.position, goal.position))
    return PathOutcome::kGoalNotFree;
  if (corridor.extent() == CorridorExtent::kAllCells &&
      (!corridor.contains(*from) || !corridor.contains(*to)))
    return PathOutcome::kOutOfReach;
  return std::nullopt;
}

// What lies between a start that is free and a goal. Of a robot on one layer both are at the start's height.
detail::SamplingQuery sampling_query(const TravelCorridor& corridor, const Eigen::Vector3d& start,
                                     const Eigen::Vector3d& goal, const PathKey& key) {
  detail::SamplingQuery query;
  query.start = start;
  query.goal = goal;
  query.reach = corridor.reach();
  query.cells = corridor.cells();
  query.plane = !query.cells.empty() && on_one_layer(query.cells);
  query.seed = seed_of(key);
  if (query.plane) query.goal.z() = query.start.z();
  return query;
}

// Straight if that is free, or by the search, if the corridor knows its cells, or else through the corridor.
// Empty if there is none.
// @param plan  learns how it was found
Polyline find_path(const TravelCorridor& corridor, const Lattice& lattice, const detail::SamplingQuery& query,
                   const PathOptions& options, const detail::SegmentCheck& is_free, PathPlan& plan) {
  Polyline path;
  plan.outcome = PathOutcome::kFound;
  if (is_free(query.start, query.goal)) {
    path = {query.start, query.goal};  // as shortening would make it of any path
  } else if (options.search != PathSearch::kCorridor) {
    if (!query.cells.empty()) {
      auto [found, iterations] = detail::sampling_search(lattice, query, options, is_free);
      path = std::move(found);
      plan.iterations = iterations;
    }
    if (path.empty()) plan.outcome = PathOutcome::kFellBack;
  }
  if (path.empty()) path = corridor_path(corridor, lattice, query.start, query.goal);
  if (path.empty()) return path;
  path.front() = query.start;
  path.back() = query.goal;
  if (path.size() == 2 && path.front() == path.back()) path.pop_back();
  return path;
}

}  // namespace

void PathOptions::check() const {
  const auto at_least = [](const char* name, double value) {
    if (!(value >= kShortest && std::isfinite(value)))
      refuse(std::string(name) + " is " + std::to_string(value) + " m, but has to be at least " +
             std::to_string(kShortest) + " m and finite");
  };
  at_least("range", range);
  at_least("spacing", spacing);
  if (search > PathSearch::kCorridor) refuse("search is none of the values of PathSearch");
  if (iterations < 1 || iterations > kMaxIterations)
    refuse("iterations is " + std::to_string(iterations) + ", but has to be 1 to " +
           std::to_string(kMaxIterations));
  if (!(goal_bias >= 0.0 && goal_bias <= 1.0))
    refuse("goal_bias is " + std::to_string(goal_bias) + ", but has to be 0 to 1");
  if (shortcut_rounds < 0)
    refuse("shortcut_rounds is " + std::to_string(shortcut_rounds) + ", but has to be 0 or more");
}

PathOptions path_options(PathSearch search) {
  constexpr int kOfRrtStar = 2000;
  PathOptions options;
  options.search = search;
  if (search == PathSearch::kRrtStar) options.iterations = kOfRrtStar;
  return options;
}

std::string_view name_of(PathOutcome outcome) {
  constexpr std::array<std::string_view, 7> kNames = {
      "found", "fell_back", "in_place", "no_corridor", "start_not_free", "goal_not_free", "out_of_reach"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

std::string_view describe(PathOutcome outcome) {
  constexpr std::array<std::string_view, 7> kTexts = {
      "was found by the search",
      "is the shortest through the corridor, since the search found none within its iterations",
      "has no length: start and goal are the same point",
      "does not exist: the robot has no corridor",
      "does not exist: the space that the robot needs at the start is not known to be free",
      "does not exist: the space that the robot needs at the goal is not known to be free",
      "does not exist: the robot's corridor does not connect start and goal"};
  return kTexts.at(static_cast<std::size_t>(outcome));
}

bool segment_is_free(const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& to, const Eigen::Vector3d& deviation) {
  return SegmentVoxels(lattice, from, to, corridor.reach() + deviation).all_of([&](const VoxelKey& key) {
    return corridor.passable(key);
  });
}

PathPlan plan_path(const TravelCorridor& corridor, const Lattice& lattice, const Pose& start,
                   const Pose& goal, const PathKey& key, const PathOptions& options) {
  check("start", start);
  check("goal", goal);
  options.check();
  if (corridor.cell_of({0, 0, 0}) != VoxelKey{0, 0, 0})
    refuse(
        "the corridor is made of nodes; plan in one of voxels, which has a cell at the centre of each node");

  PathPlan plan;
  if (const auto reason = reason_for_none(corridor, lattice, start, goal)) {
    plan.outcome = *reason;
    return plan;
  }
  if (start.position == goal.position) {
    plan.outcome = PathOutcome::kInPlace;
    plan.viewpoints = {start, goal};
    return plan;
  }

  const bool start_is_free = segment_is_free(corridor, lattice, start.position, start.position);
  const Eigen::Vector3d from =
      start_is_free ? start.position : nearest_fit(corridor, lattice, start.position);
  const detail::SamplingQuery query = sampling_query(corridor, from, goal.position, key);
  const detail::SegmentCheck is_free = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return segment_is_free(corridor, lattice, a, b);
  };
  Polyline path = find_path(corridor, lattice, query, options, is_free, plan);
  if (path.empty()) {
    plan.outcome = PathOutcome::kOutOfReach;
    return plan;
  }
  const double step = std::max(options.spacing / 2, lattice.resolution());  // smaller ones gain nothing
  path = detail::shortened(std::move(path), step, options.shortcut_rounds, is_free);
  if (query.plane) set_heights(path, query.start.z(), goal.position.z());
  if (!start_is_free) path.insert(path.begin(), start.position);
  path = detail::divided(path, options.spacing);
  plan.viewpoints = with_yaws(path, start, goal);
  plan.length = path_length(plan.viewpoints);
  return plan;
}

}  // namespace frontlux::planner
