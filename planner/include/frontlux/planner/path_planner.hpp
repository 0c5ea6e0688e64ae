#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace frontlux::planner {

/// Which search grows the path. All but `kCorridor` are random, and repeat with the same key.
enum class PathSearch : std::uint8_t {
  kRrt,         ///< one tree from the start
  kRrtConnect,  ///< two trees, from start and goal
  kRrtStar,     ///< one tree that is rewired until the iterations are used up
  kCorridor,    ///< none: the corridor's own shortest path
};

/// "rrt", "rrt-connect", "rrt-star", "corridor"
[[nodiscard]] std::string_view name_of(PathSearch search);

struct PathOptions {
  PathSearch search = PathSearch::kRrt;
  /// The search ends after so many; 1 to a million. RRT* takes them all, a hundred times as long as RRT, and
  /// is served well by 2,000.
  int iterations = 20'000;
  double range = 4.0;       ///< [m] longest edge of a tree
  double goal_bias = 0.1;   ///< share of the samples that are the goal itself, 0 to 1; not of RRT-Connect
  double spacing = 1.2;     ///< [m] greatest distance between one viewpoint and the next
  int shortcut_rounds = 6;  ///< at most so many passes of shortening; 0: the path stays as it was found
};

/// What a random search is keyed by: the same key gives the same path, another one may give another.
struct PathKey {
  std::uint64_t seed = 0, step = 0, robot = 0;
};

/// How a search for a path ended.
enum class PathOutcome : std::uint8_t {
  kFound,         ///< by the search that was asked for
  kFellBack,      ///< that search found none; the path is the corridor's own shortest, shortened
  kInPlace,       ///< start and goal are the same point: the robot turns, or does nothing
  kNoCorridor,    ///< the corridor has no cells
  kStartNotFree,  ///< the robot does not fit, as far as is known, where it starts
  kGoalNotFree,   ///< nor where it should go
  kOutOfReach,    ///< it fits at both, but the corridor does not connect them
};

/// One of the words above, as it is written in logs: "found", "fell_back", ...
[[nodiscard]] std::string_view name_of(PathOutcome outcome);

/// In words, as the end of a sentence about the path.
[[nodiscard]] std::string_view describe(PathOutcome outcome);

/// A way from pose to pose.
struct PathPlan {
  PathOutcome outcome = PathOutcome::kNoCorridor;
  /// Start, goal and what lies between, all bends included; the way from one to the next is straight. Start
  /// and goal are those given to the last bit; the yaw of the others is that of the way on, or the yaw before
  /// where the way on is vertical. Empty if there is no path.
  std::vector<Pose> viewpoints;
  double length = 0.0;  ///< [m]
  int iterations = 0;   ///< that the search took

  [[nodiscard]] bool found() const { return !viewpoints.empty(); }
};

/// Finds a way for a robot through its corridor.
///
/// A position is free if all of the robot's body is known free there: not only has the cell of the voxel that
/// holds it to be passable, but all cells that are within `reach()` of it, so positions need not be centres
/// of voxels. A way is free if `way_is_free` says so of each part. From a start that is not free although its
/// cell is passable, as when the map has changed around a robot, the way leads to the middle of that cell
/// first.
///
/// If start and goal are in the corridor, there is a path, since the corridor's own is the last resort; it is
/// the shortest if the start is where the corridor begins, at the robot, else it may make a detour. On a
/// plane the search is along x and y, and the height changes evenly from start to goal.
///
/// The search ends after a number of iterations, not after a time, and the result depends on the arguments
/// only. Nothing is printed. Thread safety: any number of threads may plan at once; while one does, what else
/// uses OMPL in the process is silent too.
/// @param corridor  of voxels, not of nodes, in which a robot at the edge would reach into the next
/// @throws std::invalid_argument if a number of a pose or of the options is not finite or out of its range,
/// or if the corridor is one of nodes
[[nodiscard]] PathPlan plan_path(const TravelCorridor& corridor, const Lattice& lattice, const Pose& start,
                                 const Pose& goal, const PathKey& key, const PathOptions& options = {});

/// Whether the body of a robot that goes straight from one point [m] to another stays in what is known free:
/// every voxel that a box of the corridor's `reach()` around the robot enters on the way is looked at, and
/// has to be a passable cell; where the box comes within a billionth of a voxel of an edge or corner, all
/// that meet there and lie between those of its ends. False if an end is not finite or beyond the key range.
[[nodiscard]] bool way_is_free(const TravelCorridor& corridor, const Lattice& lattice,
                               const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Sum of the distances from viewpoint to viewpoint [m].
[[nodiscard]] double path_length(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
