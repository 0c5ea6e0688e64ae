#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/view_quality.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::planner {

/// How a robot's goal is found.
enum class GoalRule : std::uint8_t {
  kViewQuality,  ///< the cell of the corridor with the best view quality by eq. 1
  kClusters,     ///< the paper's Sec. VI: a cell that sees the middle of the best cluster of frontiers
  kNearest,      ///< the nearest cell that sees the middle of a cluster of frontiers: the usual baseline
};

/// What eq. 1 takes for the distance between a viewpoint and the robot.
enum class DistanceMeasure : std::uint8_t {
  kPath,      ///< length of the shortest path through the corridor; to the mean of a cluster, which may have
              ///< no path to it, the straight distance
  kStraight,  ///< Euclidean, as printed
};

/// How goals are chosen. The paper's eq. 1: view quality = exp(-lambda * distance) * gain.
struct FRONTLUX_EXPORT GoalOptions {
  /// What makes a goal.
  GoalRule rule = GoalRule::kViewQuality;
  /// How the distance to a goal is measured.
  DistanceMeasure distance = DistanceMeasure::kPath;
  double lambda = 0.1386;     ///< [1/m] half per 5 m
  double min_distance = 0.6;  ///< [m] cells nearer to the robot are not goals
  /// [m] If not 0, the quality of cells at a distance d below it is eq. 1 times d / advance. A robot uncovers
  /// what lies behind the frontiers about as far as it moves on. So of two cells that see the same number,
  /// the one far enough away to uncover something is worth the step.
  double advance = 0.0;

  /// [frontiers] Cells with a smaller gain are goals only if no cell with this gain is found, however near
  /// they are. Without it a robot would pick up what is left around it, and a loop that ends when the
  /// expected gain is small would end with far regions unexplored.
  double min_gain = 0.0;

  /// How viewpoints are rendered. `azimuth_bins` is for robots that do not see all around: their gain is that
  /// of the best window of bins.
  ViewQualityOptions rendering;
  double viewpoint_spacing = 0.0;  ///< [m] of the rendered cells along each axis; 0: every cell
  /// With a spacing, all cells within this many spacings of the robot are rendered nevertheless.
  int surroundings = 2;
  /// This many cells, the best by the drawn targets, are rendered again with all their targets, and the goal
  /// is the best of them; a gain of zero is then certain. 0: the best by the drawn targets is the goal.
  int refined = 200;
  /// Cells that cannot be the goal are not rendered: a few cells are counted with all their targets first,
  /// and cells that would be worse than the best of them even if they saw all in their reach are left out.
  /// Used only if `refined` is not 0.
  bool prune = false;

  double cluster_edge = 4.8;  ///< [m] clusters are the frontiers in octree nodes of at least this edge

  /// What is left of a gain at a distance of this length [m], 0 to 1: the factor of eq. 1, without `advance`.
  [[nodiscard]] double discount(double length) const;

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// By default, view quality for all robots: of those that drive counted exactly; in space drawn from buckets
/// at every 0.6 m, pruned, and counted for the best cells. As printed: of those that drive by hits
/// among the drawn frontiers, in space by clusters.
/// @param epsilon  `ExplorationOptions::epsilon`. By default it is also `min_gain`: a robot takes a goal of
///                 low gain only if there is no better one. As printed there is no such bound
[[nodiscard]] FRONTLUX_EXPORT GoalOptions goal_options(const Robot& robot, Method method = Method::kDefault,
                                                       double epsilon = 10.0);
/// The same for a robot in motion: by default near goals cost it less, since it plans again before it
/// arrives.
[[nodiscard]] FRONTLUX_EXPORT GoalOptions motion_goal_options(const Robot& robot,
                                                              Method method = Method::kDefault,
                                                              double epsilon = 10.0);

/// Which frontiers a robot's goal is for, or why it has no goal.
enum class GoalState : std::uint8_t {
  kAssigned,         ///< a goal for frontiers assigned to it
  kReceived,         ///< a goal for its frontiers, some of them released by other robots
  kUncovered,        ///< a goal for frontiers of other robots that their goals do not see
  kNoCorridor,       ///< no goal: there is no corridor where it is
  kNoFrontiers,      ///< no goal: the map has no frontiers
  kNothingAssigned,  ///< no goal: it sees no frontiers from its corridor, or they are assigned to others
  kNothingVisible,   ///< no goal: it sees its frontiers through unknown space only, and has released them
};

/// As it is written in logs: "assigned", "no_corridor", ...
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(GoalState state);

/// A robot's next goal.
struct Goal {
  std::optional<Pose> pose;  ///< of its sensor; if there is none, the robot stays where it is
  VoxelKey cell;             ///< of the pose; a cell of its corridor
  /// Which frontiers it is for, or why there is none.
  GoalState state = GoalState::kNoCorridor;
  std::string reason;           ///< the state in words, with numbers
  double distance = 0.0;        ///< [m] as eq. 1 takes it
  double gain = 0.0;            ///< frontiers that it is expected to see at this yaw
  double standard_error = 0.0;  ///< of the gain; 0 if it was counted
  double quality = 0.0;         ///< eq. 1

  std::size_t assigned = 0;   ///< frontiers assigned to it
  std::size_t released = 0;   ///< frontiers that it released because it sees none of them
  std::size_t received = 0;   ///< frontiers that other robots released and it took
  std::size_t uncovered = 0;  ///< frontiers of other robots that their goals do not see and it took
};

/// What one step decides for all robots.
struct TeamGoals {
  std::vector<Goal> goals;     ///< of each robot, in the order given
  std::size_t frontiers = 0;   ///< in the map
  std::size_t unassigned = 0;  ///< frontiers that no robot sees, or that all released
  std::uint64_t rays = 0;      ///< cast in this step
};

/// A cell that a robot's goal may be in, and what it would see from there.
struct RenderedCell {
  /// A cell of the corridor.
  VoxelKey cell;
  double distance = 0.0;        ///< [m] as eq. 1 takes it
  double gain = 0.0;            ///< expected number of frontiers visible at the best yaw
  double standard_error = 0.0;  ///< of the gain
  double quality = 0.0;         ///< eq. 1
  double yaw = 0.0;             ///< [rad] the best yaw; 0 for robots that see all around
  std::uint32_t hits = 0;       ///< visible among the drawn targets, at the best yaw
};

/// A robot and how its goals are chosen.
struct TeamMember {
  /// Its body and its sensor.
  Robot robot;
  /// How its goals are chosen.
  GoalOptions options;
};

/// Chooses the goals of a team, step by step: the paper's Alg. 1, lines 4 and 5.
///
/// The first robot, the paper's UGV, comes first when frontiers are assigned. A robot that sees none of its
/// frontiers through known space, from wherever it can go, releases them to the others. A robot without
/// frontiers takes those of the others that their goals do not see.
///
/// When the map changes, corridors and rendered cells keep what the change does not reach. The result is the
/// same as that of a new object, on any number of threads and with any exact caster.
///
/// Thread safety: as a standard container. Works in TBB's current arena.
class FRONTLUX_EXPORT GoalSelection {
 public:
  /// @param bounds  of all stencils, as `TravelCorridor` takes them
  /// @param assign  whether each frontier is assigned to one robot (Alg. 2), else to all that see it
  /// @throws std::invalid_argument naming the robot and the value that is out of bounds
  GoalSelection(std::vector<TeamMember> team, const Lattice& lattice, const KeyBox& bounds,
                bool assign = true);
  ~GoalSelection();
  GoalSelection(GoalSelection&&) noexcept;
  GoalSelection& operator=(GoalSelection&&) noexcept;

  /// One step.
  /// @param caster     of the map as it is now
  /// @param change     since the last step
  /// @param frontiers  of the map, in any order
  /// @param poses      of the robots' sensors, one for each robot
  /// @param choosing   if given: the only robot that chooses; the others keep their goals
  /// @throws std::invalid_argument if the number of poses differs, a pose is not finite, or the grid has
  ///                   another resolution
  [[nodiscard]] TeamGoals select(const RayCaster& caster, const MapChange& change,
                                 std::span<const VoxelKey> frontiers, std::span<const Pose> poses,
                                 std::optional<std::size_t> choosing = std::nullopt);

  /// Instead of `select`: takes the change, and updates this robot's corridor only. No robot chooses a goal,
  /// and what was rendered for this one is forgotten.
  /// @pre robot < team().size()
  void update_corridor(const MapChange& change, std::size_t robot, const Pose& pose,
                       CorridorExtent extent = CorridorExtent::kAllCells);

  /// See `TravelCorridor::find_path`. @pre robot < team().size()
  bool find_path(std::size_t robot, const VoxelKey& cell,
                 const std::function<bool(const VoxelKey&)>& through);

  /// From the next step on these cells are impassable for a robot: see `TravelCorridor::block`.
  /// @pre robot < team().size()
  void block(std::size_t robot, std::span<const VoxelKey> cells);

  /// A robot that will not choose again has no goal any more. @pre robot < team().size()
  void lose(std::size_t robot);
  /// It chooses again, and travels like this; what was closed to it is open. @pre robot < team().size()
  /// @throws std::invalid_argument as the constructor
  void join(std::size_t robot, const TravelOptions& travel);

  /// At the next step these boxes of cells are impassable for a robot: see `TravelCorridor::keep_out_of`.
  /// @pre robot < team().size()
  void keep_out_of(std::size_t robot, std::vector<KeyBox> boxes);

  /// As given.
  [[nodiscard]] const std::vector<TeamMember>& team() const;

  /// The robot's corridor at the last step. @pre robot < team().size()
  [[nodiscard]] const TravelCorridor& corridor(std::size_t robot) const;

  /// The frontiers of a robot's last choice, sorted. @pre robot < team().size()
  [[nodiscard]] std::span<const VoxelKey> targets(std::size_t robot) const;

  /// All cells that were rendered for a robot's goal at the last step, sorted, at any distance. With `prune`
  /// these are only the cells that might have been the goal. There are none if the rule is not
  /// `kViewQuality`, or without frontiers. @pre robot < team().size()
  [[nodiscard]] std::vector<RenderedCell> rendered_cells(std::size_t robot) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
