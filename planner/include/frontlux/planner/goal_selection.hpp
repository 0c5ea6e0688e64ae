#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/view_quality.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::planner {

/// How a robot's goal is found.
enum class GoalRule : std::uint8_t {
  kViewQuality,  ///< the cell of the corridor from which eq. 1 promises most
  kClusters,     ///< the paper's Sec. VI: a cell that sees the middle of the best cluster of frontiers
  kNearest,      ///< the nearest cell from which any frontier is visible: the usual baseline
};

/// What eq. 1 takes for the distance between a viewpoint and the robot.
enum class TravelDistance : std::uint8_t {
  kPath,      ///< length of the shortest way through the corridor; to the middle of a cluster, to which
              ///< there may be none, the straight distance
  kStraight,  ///< Euclidean, as printed
};

/// How goals are chosen. Eq. 1: view quality = exp(-lambda * distance) * gain.
struct GoalOptions {
  GoalRule rule = GoalRule::kViewQuality;
  TravelDistance distance = TravelDistance::kPath;
  double lambda = 0.1386;     ///< [1/m] half per 5 m
  double min_distance = 0.6;  ///< [m] nearer cells are no goals
  /// [m] Not 0: the quality of cells at distance d that are nearer than this is eq. 1 times d / advance. What
  /// lies behind the frontiers is uncovered about as far as the robot moves on, so that of two cells that
  /// see as many, one far enough to uncover something is worth the step.
  double advance = 0.0;

  /// [frontiers] Cells that promise fewer are goals only if no other cell is found that promises as many,
  /// however near they are. Else a robot would pick up what is left around it, and a loop that ends when
  /// paths promise little would end with far regions untouched.
  double min_gain = 0.0;

  /// How viewpoints are rendered. `azimuth_bins` matters for robots that do not see all around: their gain is
  /// what the best window of bins holds.
  ViewQualityOptions rendering;
  double viewpoint_spacing = 0.0;  ///< [m] of the rendered cells along each axis; 0: every cell
  /// With a spacing: all cells within so many spacings of the robot are rendered nevertheless.
  int surroundings = 2;
  /// So many cells, the best as far as drawn targets tell, are rendered again with all their targets, and the
  /// goal is the best of them; a gain of zero is then certain. 0: the best by the drawn targets is the goal.
  int refined = 200;
  /// Cells that cannot be the goal are not rendered: a few cells are counted with all their targets first,
  /// and those that would be worse than the best of them even if they saw all in their reach are left out.
  /// Without `refined` it means nothing.
  bool prune = false;

  double cluster_edge = 4.8;  ///< [m] clusters are the frontiers in octree nodes of at least this edge

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// View quality for all robots: counted exactly on a plane; drawn from buckets, at every second voxel,
/// pruned, and counted for the best, in space. Or as printed, for robots on a plane by hits among the drawn
/// frontiers and for those in space by clusters.
[[nodiscard]] GoalOptions goal_options(const Robot& robot, Method method = Method::kDefault);

/// Why a robot has a goal, or none.
enum class GoalState : std::uint8_t {
  kOwn,              ///< a goal, for frontiers distributed to it
  kReleased,         ///< a goal, for frontiers that another could make nothing of, or those too
  kLeftOver,         ///< a goal, for frontiers of others that their goals do not see
  kNoCorridor,       ///< none: it is nowhere from where it could go
  kNoFrontiers,      ///< none: the map has no frontiers
  kNothingAssigned,  ///< none: it sees none of them from its corridor, or others see them all
  kNothingVisible,   ///< none: it sees none through known space, so it has released its frontiers
};

/// One of the words above, as it is written in logs: "own", "no_corridor", ...
[[nodiscard]] std::string_view name_of(GoalState state);

/// A robot's next goal.
struct Goal {
  std::optional<Pose> pose;  ///< of its sensor; nothing, and then it stays where it is
  VoxelKey cell;             ///< that of the pose, a cell of its corridor
  GoalState state = GoalState::kNoCorridor;
  std::string reason;           ///< the state in a sentence, with numbers
  double distance = 0.0;        ///< [m] as eq. 1 takes it
  double gain = 0.0;            ///< frontiers that it is expected to see; clusters: those in view at this yaw
  double standard_error = 0.0;  ///< of the gain; 0 if it was counted
  double quality = 0.0;         ///< eq. 1

  std::size_t assigned = 0;   ///< frontiers distributed to it
  std::size_t released = 0;   ///< of its frontiers, given back because it sees none
  std::size_t received = 0;   ///< released by others
  std::size_t left_over = 0;  ///< taken of others, which their goals do not see
};

/// What one step decides for all robots.
struct TeamGoals {
  std::vector<Goal> goals;     ///< of each robot, in the order given
  std::size_t frontiers = 0;   ///< in the map
  std::size_t unassigned = 0;  ///< that nobody sees or could make anything of
  std::uint64_t rays = 0;      ///< cast for all this
};

/// A cell as it was rendered for a robot's goal.
struct RenderedCell {
  VoxelKey cell;
  double distance = 0.0;        ///< [m] as eq. 1 takes it
  double gain = 0.0;            ///< expected number of frontiers that it sees, at the best yaw
  double standard_error = 0.0;  ///< of the gain
  double quality = 0.0;         ///< eq. 1
  double yaw = 0.0;             ///< [rad] the best one; 0 for robots that see all around
  std::uint32_t hits = 0;       ///< visible among the drawn targets, at the best yaw
};

/// A robot and how its goals are chosen.
struct TeamMember {
  Robot robot;
  GoalOptions options;
};

/// Chooses the goals of a team, step by step: the paper's Alg. 1, lines 4 and 5.
///
/// The first robot has the first choice among the frontiers, so that the paper's UGV comes first. A robot
/// that sees nothing of what it got from anywhere it can go to releases it to the others, and one that is
/// left with nothing takes of the others what their goals do not see.
///
/// Corridors and rendered cells keep from step to step what a change of the map does not reach; the result is
/// the same as that of a new object. It does not depend on the number of threads, nor on whether the caster
/// walks the grid or uses Embree.
///
/// Thread safety: as a standard container. Works in TBB's current arena.
class GoalSelection {
 public:
  /// @param bounds      where collision boxes have to be, as `TravelCorridor` takes them
  /// @param distribute  whether a frontier is one robot's, by Alg. 2; else it is every robot's that sees it
  /// @throws std::invalid_argument naming the robot and the value that is out of bounds
  GoalSelection(std::vector<TeamMember> team, const Lattice& lattice, const KeyBox& bounds,
                bool distribute = true);
  ~GoalSelection();
  GoalSelection(GoalSelection&&) noexcept;
  GoalSelection& operator=(GoalSelection&&) noexcept;

  /// One step.
  /// @param caster     of the map as it is now
  /// @param change     since the last step
  /// @param frontiers  all of the map's, in any order
  /// @param poses      of the robots' sensors, one for each
  /// @throws std::invalid_argument if the number of poses differs, a pose is not finite, or the grid has
  ///                   another resolution
  [[nodiscard]] TeamGoals select(const RayCaster& caster, const MapChange& change,
                                 std::span<const VoxelKey> frontiers, std::span<const Pose> poses);

  /// From the next step on a robot does not go through these cells: see `TravelCorridor::block`.
  /// @pre robot < team().size()
  void block(std::size_t robot, std::span<const VoxelKey> cells);

  [[nodiscard]] const std::vector<TeamMember>& team() const;

  /// Where a robot could go at the last step. @pre robot < team().size()
  [[nodiscard]] const TravelCorridor& corridor(std::size_t robot) const;

  /// The frontiers that a robot's goal was last chosen for, sorted. @pre robot < team().size()
  [[nodiscard]] std::span<const VoxelKey> targets(std::size_t robot) const;

  /// All cells that were rendered for a robot's goal at the last step, sorted, whatever their distance; with
  /// `prune` only those that might have been the goal; none if its rule is not `kViewQuality` or it had no
  /// frontiers. @pre robot < team().size()
  [[nodiscard]] std::vector<RenderedCell> rendered_cells(std::size_t robot) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
