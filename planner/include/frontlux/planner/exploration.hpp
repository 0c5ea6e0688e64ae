#pragma once

#include <frontlux/caster_kind.hpp>
#include <frontlux/export.hpp>
#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/scan.hpp>
#include <frontlux/planner/tour_part.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
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
namespace detail {
struct ExplorationState;
}

/// A team, and how it explores.
struct FRONTLUX_EXPORT ExplorationOptions {
  std::vector<TeamMember> team;  ///< who comes first has the first choice: ground robots, then aerial ones
  /// The caster that answers what is visible.
  CasterKind caster = CasterKind::kFast;
  /// In motion: tours through clusters of frontiers, for all robots together, in the place of one goal after
  /// the other.
  bool tours = false;
  TourPart tours_without = TourPart::kNone;  ///< left out of the search for tours
  bool assign = true;    ///< each frontier to one robot; off: every robot goes for all that it sees
  bool optimize = true;  ///< off: robots look ahead along their paths
  /// How paths are found.
  PathOptions path;
  /// How their yaws are optimised.
  PathOptimizerOptions optimizer;
  std::uint64_t seed = 1;  ///< of the path search; the rendering has its own in the team's options

  /// [frontiers] In lock-step a step has low gain if all its paths together are expected to see fewer:
  /// distinct ones, or with `GainMode::kSum` summed over viewpoints. In motion without tours a chosen goal
  /// has low gain if fewer are expected to be in view at the goal itself (`Goal::gain`). On tours no goal has
  /// low gain. There it is how many a place has to show to be worth a stop; fewer are asked for towards the
  /// end, and of sensors of short range.
  double epsilon = 10.0;
  int low_gain_steps = 3;    ///< of low gain in a row end it: steps, in motion goals that each robot chose
  int max_steps = 1000;      ///< so does this number of steps, in motion plannings
  double latency = 0.1;      ///< [s] that the clock charges for a planning
  double period = 1.0;       ///< [s] in motion: after at most this time a robot plans its path anew
  double commitment = 30.0;  ///< [s] in motion: a goal that is not seen yet is kept for this long
  int max_visits = 2;        ///< a frontier that stays unknown after so many looks at it is abandoned
  int min_cluster_size = 4;  ///< frontiers in connected clusters of fewer come last

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// What robots in lock-step explore with by default; the team is to be added. Robots take the corridor's own
/// shortest paths, since a random search finds longer ones; `kPaper` searches by RRT.
[[nodiscard]] FRONTLUX_EXPORT ExplorationOptions exploration_options(Method method = Method::kDefault);
/// The same for robots in motion. A frontier that stays unknown after one look, in the last scan before a
/// planning, is abandoned, and the number of plannings has no limit.
[[nodiscard]] FRONTLUX_EXPORT ExplorationOptions motion_options(Method method = Method::kDefault);
/// What `frontlux explore` has by default, in motion and on tours; the team is to be added. A stop shows at
/// least ten frontiers, but no fewer than make up 0.3 m2 and no more than 0.9 m2.
/// @param resolution  [m] of the map
[[nodiscard]] FRONTLUX_EXPORT ExplorationOptions tour_options(double resolution);

/// Where a robot begins, and what it knows to be free there without having seen it.
struct ExplorationStart {
  Pose pose;  ///< of its sensor
  /// Voxels; of its body at least.
  std::vector<VoxelKey> known_free;
};

/// A voxel that became unknown, free or occupied and was not so before.
struct VoxelChange {
  /// The voxel.
  VoxelKey key;
  Occupancy before = Occupancy::kUnknown;  ///< what it was
  Occupancy after = Occupancy::kUnknown;   ///< what it is now
  friend constexpr auto operator<=>(const VoxelChange&, const VoxelChange&) = default;
};

/// A place to which a robot's tour leads.
struct PlannedStop {
  Pose pose;                  ///< of its sensor; beyond its next stops the middle of the voxel
  std::size_t clusters = 0;   ///< of frontiers that it looks at from there
  std::size_t frontiers = 0;  ///< of them in view, about
};

/// What one robot planned, did and mapped in one step.
struct RobotStep {
  Goal goal;  ///< or why there is none
  /// The candidates among which its goal was chosen: of a robot on a plane all cells rendered for it, else
  /// the best 1000 by eq. 1. With tours they are places that see a cluster of frontiers each, and the gain is
  /// what they see of it.
  std::vector<RenderedCell> image;
  /// How its path was found, or why there is none.
  PathOutcome path = PathOutcome::kNoCorridor;
  /// In lock-step its path: viewpoints from where it was to the goal; empty if it stays. In motion no path:
  /// where it took its last scan before the previous planning, and then its scans since. Its path is
  /// `trajectory`.
  std::vector<Pose> planned;
  std::uint64_t gain_tangent = 0;    ///< distinct frontiers of its own in the path's view, if it looked ahead
  std::uint64_t gain_predicted = 0;  ///< the same with the yaws as optimised
  std::uint64_t gain_sum = 0;        ///< of its own frontiers in view, summed over the path's viewpoints
  std::size_t travelled = 0;         ///< of `planned` that it reached, the first included; in motion all
  double length = 0.0;               ///< [m] along these
  std::uint64_t gained = 0;          ///< frontiers of the step's beginning that its scans mapped
  std::vector<VoxelChange> changed;  ///< by its scans, sorted by key
  std::vector<VoxelKey> blocked;     ///< cells that it could not go through; sorted
  std::vector<VoxelKey> still_unknown;  ///< frontiers in view of its viewpoints that stayed unknown; sorted
  /// Where it means to look from, in order, if it chose its goal in this step; the first one is its goal.
  /// Empty without tours.
  std::vector<PlannedStop> tour;
  /// In motion, if it planned in this step: where its trajectory leads, from its begin to its end, a few
  /// centimetres at most from the lines between these poses.
  std::vector<Pose> trajectory;
  /// Frontiers that are its own to look at from this step on and were not, or the other way round; sorted.
  std::vector<VoxelKey> reassigned;
};

/// What a step spends its time on. All but the last are planning.
enum class Phase : std::uint8_t { kFrontiers, kCaster, kGoals, kPaths, kOptimization, kMoving };
inline constexpr std::size_t kPhases = 6;
/// "frontiers", "caster", "goals", "paths", "optimization", "moving"
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(Phase phase);

/// What a team planned, did and mapped between two moments.
struct FRONTLUX_EXPORT ExplorationStep {
  std::uint64_t number = 0;   ///< 0: the start, where robots only look around
  double time = 0.0;          ///< [s] of the clock, at its end
  std::size_t frontiers = 0;  ///< in the map when the step was planned
  /// Of them, those that are no robot's: none can see them, or with tours their cluster has no stop.
  std::size_t unassigned = 0;
  std::size_t abandoned = 0;      ///< of them, those no longer tried, since they stay unknown when looked at
  std::uint64_t rays = 0;         ///< cast to plan the step, but for retreats
  std::vector<RobotStep> robots;  ///< in the team's order
  std::array<double, kPhases> seconds{};  ///< [s] by `Phase`

  /// Of all phases but moving [s].
  [[nodiscard]] double planning_seconds() const;
};

/// Why an exploration is over.
enum class ExplorationEnd : std::uint8_t {
  kLowGain,  ///< `low_gain_steps` times in a row too little was expected, see `ExplorationOptions::epsilon`
  kNothingToDo,  ///< no robot has a goal that it can get to; in motion it tries ten times if others are in
                 ///< its way
  kStepLimit,    ///< `max_steps` are done
  kCutOff,       ///< as one of the first two, but a robot cannot get to where it came from
};
/// One of the words "low_gain", "nothing_to_do", "step_limit", "cut_off".
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(ExplorationEnd end);
/// In words: "expected gain stayed below 10 frontiers 3 times in a row".
/// @param steps  what `max_steps` counts: in motion, "plannings"
[[nodiscard]] FRONTLUX_EXPORT std::string describe(ExplorationEnd end, const ExplorationOptions& options,
                                                   std::string_view steps = "steps");

/// Moves a robot's sensor straight to a viewpoint and returns what it measures there; nothing if the robot
/// could not go, and is where it was. The one function that a real or a simulated robot has to provide.
using Drive = std::function<std::optional<Scan>(std::size_t robot, const Pose& viewpoint)>;

/// The paper's Alg. 1, step by step: a team of robots explores what the bounds of a map hold.
///
///     Exploration exploration(options, std::move(mapping));
///     exploration.begin(starts, drive);
///     while (!exploration.end()) exploration.step(drive);
///
/// The result depends on the options, the starts and the scans only: not on time, not on the number of
/// threads, not on the choice among the fast, the embree and the grid caster. Works in TBB's current arena.
/// Thread safety: as a standard container.
class FRONTLUX_EXPORT Exploration {
 public:
  /// @param mapping  the map to fill; empty, or with what is known already
  /// @throws std::invalid_argument naming the value that is out of bounds, or for `tours`
  Exploration(ExplorationOptions options, Mapping mapping);
  ~Exploration();
  Exploration(Exploration&&) noexcept;
  Exploration& operator=(Exploration&&) noexcept;

  /// Alg. 1, lines 1 and 2: each robot looks all around at its start.
  /// @throws std::invalid_argument unless there is one finite start for each robot, or if it has begun
  ExplorationStep begin(std::span<const ExplorationStart> starts, const Drive& drive);

  /// Alg. 1, lines 4 to 11. It may be called after the end, too.
  /// @throws std::invalid_argument before `begin`, or for a scan that `Mapping::insert` refuses; so does
  ///         `repeat`. After that, or if `drive` has thrown, here or in `begin`, the exploration must not be
  ///         used any more.
  ExplorationStep step(const Drive& drive);

  /// Repeats a recorded step: afterwards the exploration is in the state in which it was after that step, and
  /// the next steps are the same as then. Takes about as long as the step did, except for paths.
  /// @return false if the robots did not map what they mapped then: the world or the options are different.
  /// The exploration must not be used any more.
  bool repeat(const ExplorationStep& recorded, const Drive& drive);

  /// Alg. 1, line 3: why the exploration is over; nothing while it goes on.
  [[nodiscard]] std::optional<ExplorationEnd> end() const;

  /// As given.
  [[nodiscard]] const ExplorationOptions& options() const;
  /// The map so far.
  [[nodiscard]] const Mapping& mapping() const;
  /// Of the robots' sensors.
  [[nodiscard]] std::span<const Pose> poses() const;
  /// Of the map after the last step, abandoned ones included; sorted.
  [[nodiscard]] std::span<const VoxelKey> frontiers() const;

 private:
  std::unique_ptr<detail::ExplorationState> state_;
};

}  // namespace frontlux::planner
