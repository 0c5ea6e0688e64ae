#pragma once

#include <frontlux/export.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace frontlux::planner {

/// Which search finds the path. All but `kCorridor` are random, and repeat with the same key.
enum class PathSearch : std::uint8_t {
  kRrt,         ///< RRT, which grows from the start
  kRrtConnect,  ///< RRT-Connect, which grows from start and goal
  kRrtStar,     ///< RRT*, which shortens its paths until the iterations are used up
  kCorridor,    ///< no search: the shortest path through the corridor
};

/// As options and files call them.
inline constexpr std::array<std::pair<std::string_view, PathSearch>, 4> kPathSearchNames = {
    {{"corridor", PathSearch::kCorridor},
     {"rrt", PathSearch::kRrt},
     {"rrt-connect", PathSearch::kRrtConnect},
     {"rrt-star", PathSearch::kRrtStar}}};

[[nodiscard]] constexpr std::string_view name_of(PathSearch search) {
  for (const auto& [name, value] : kPathSearchNames)
    if (value == search) return name;
  return {};
}

/// How paths are searched.
struct FRONTLUX_EXPORT PathOptions {
  /// The method.
  PathSearch search = PathSearch::kRrt;
  /// Of the search, at most; 1 to a million. RRT* uses them all.
  int iterations = 20'000;
  double range = 4.0;       ///< [m] longest edge of the search
  double goal_bias = 0.1;   ///< fraction of the samples that are the goal itself, 0 to 1; not for RRT-Connect
  double spacing = 1.2;     ///< [m] greatest distance between successive viewpoints
  int shortcut_rounds = 6;  ///< of shortening, at most; 0: the path stays as it was found

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// What a search works well with: of RRT*, which else takes a hundred times as long as RRT, 2,000 iterations.
[[nodiscard]] FRONTLUX_EXPORT PathOptions path_options(PathSearch search);

/// The key of a random search. The same key gives the same path; another key may give another path.
struct PathKey {
  std::uint64_t seed = 0;   ///< of the run
  std::uint64_t step = 0;   ///< of the exploration
  std::uint64_t robot = 0;  ///< number in the team
};

/// How a search for a path ended.
enum class PathOutcome : std::uint8_t {
  kFound,         ///< by the search that was asked for
  kFellBack,      ///< that search found none; the path is the corridor's shortest, shortened further
  kInPlace,       ///< start and goal are the same point: the robot turns, or stays as it is
  kNoCorridor,    ///< the corridor has no cells
  kStartNotFree,  ///< the space that the robot needs at the start is not known to be free
  kGoalNotFree,   ///< the space that the robot needs at the goal is not known to be free
  kOutOfReach,    ///< the robot fits at both, but the corridor does not connect them
};

/// As it is written in logs: "found", "fell_back", ...
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(PathOutcome outcome);

/// In words, as the end of a sentence about the path.
[[nodiscard]] FRONTLUX_EXPORT std::string_view describe(PathOutcome outcome);

/// A path from pose to pose.
struct PathPlan {
  /// How the path was found, or why there is none.
  PathOutcome outcome = PathOutcome::kNoCorridor;
  /// From start to goal, with all bends; the robot goes straight from each to the next. Start and goal are
  /// exactly those given. At the others the robot looks where it goes next; before a vertical segment it
  /// keeps its yaw. Empty if there is no path.
  std::vector<Pose> viewpoints;
  double length = 0.0;  ///< [m]
  int iterations = 0;   ///< used by the search

  /// Whether there is a path.
  [[nodiscard]] bool found() const { return !viewpoints.empty(); }
};

/// Finds a path for a robot through its corridor.
///
/// A position need not be the centre of a voxel. It is free if all of the robot's body is known to be free
/// there: all cells within the corridor's `reach()` of it have to be passable. A path is free if
/// `segment_is_free` holds for each segment. If the start is not free although its cell is passable, as when
/// the map has changed around the robot, the path goes to the middle of that cell first.
///
/// If start and goal are in the corridor, there is a path: the last resort is the corridor's own. That one is
/// the shortest if the corridor begins at the start; else it may make a detour. On a plane the search is
/// along x and y, and the height changes evenly from start to goal.
///
/// The search ends after a number of iterations, not after a time, and the result depends on the arguments
/// only. Nothing is printed. Thread safety: any number of threads may plan at once; while one does, OMPL logs
/// nothing in the whole process.
/// @param corridor  of voxels; in one of nodes, a robot at the edge of a node would reach into the next
/// @throws std::invalid_argument if a number of a pose or of the options is not finite or out of its range,
/// or if the corridor is made of nodes
[[nodiscard]] FRONTLUX_EXPORT PathPlan plan_path(const TravelCorridor& corridor, const Lattice& lattice,
                                                 const Pose& start, const Pose& goal, const PathKey& key,
                                                 const PathOptions& options = {});

/// Whether the body of a robot that goes straight from one point [m] to another stays in space that is known
/// to be free: every voxel that a box of the corridor's `reach()` around the robot enters has to be a
/// passable cell (see `SegmentVoxels`). False if an end is not finite or beyond the key range.
/// @param deviation  [m] along each axis, by which the robot may be beside the straight line
[[nodiscard]] FRONTLUX_EXPORT bool segment_is_free(
    const TravelCorridor& corridor, const Lattice& lattice, const Eigen::Vector3d& from,
    const Eigen::Vector3d& to, const Eigen::Vector3d& deviation = Eigen::Vector3d::Zero());

}  // namespace frontlux::planner
