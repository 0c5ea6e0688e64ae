#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/trajectory.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace frontlux::planner {

/// Why a robot plans.
enum class PlanReason : std::uint8_t {
  kStart,     ///< it has no trajectory yet, or has joined the others again
  kArrival,   ///< it has looked from its goal, or its trajectory is about to end and it has nothing to see
              ///< there
  kGoalSeen,  ///< most of what it was going for is mapped
  kBlocked,   ///< its trajectory leads through what is no longer known to be free, or where another robot
              ///< has stopped
  kStopped,   ///< it could not follow its trajectory, or has left it
  kPeriod,    ///< its plan is as old as `ExplorationOptions::period`
};
/// "start", "arrival", "goal_seen", "blocked", "stopped", "period"
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(PlanReason reason);

/// [m] What robots in motion keep between the boxes around their bodies, along that of the axes on which they
/// are farthest apart. Those that are nearer already may stay so, but come no nearer.
inline constexpr double kSeparation = 0.32;

/// One robot's planning, and what all robots have done since the planning before.
struct PlannedMotion {
  /// Who planned: a number in the team.
  std::size_t robot = 0;
  /// Why it planned.
  PlanReason reason = PlanReason::kStart;
  /// To be followed from its begin on; until then, the one before. If it begins before the time for which it
  /// was planned, it is the one that the robot is on: nothing better was found.
  Trajectory trajectory;
  /// Of each robot what it has done; goal, tour, path, image and gains are those of the robot that planned.
  ExplorationStep step;
};

/// Robots that explore without stops and without waiting for each other: `Exploration` for robots in motion.
/// Scans go in when they are taken, trajectories come out; nothing in here waits, reads a clock or starts a
/// thread. Each robot plans for itself: when it has looked from its goal, when what it was going for has been
/// mapped by anybody, when its path is blocked, and at least every `ExplorationOptions::period` but on its
/// way back or aside. It knows the others' plans: frontiers are assigned to one robot, and a trajectory keeps
/// apart from the bodies of the others for all time to come. If there is none such, the robot keeps the one
/// it has; it brakes if something is on that, even where another one would pass, which plans at once then.
///
///     ContinuousExploration exploration(options, std::move(mapping));
///     exploration.begin(starts, now());
///     while (!exploration.end()) {
///       exploration.insert(robot, pose, scan);                     // as they come
///       const double time = now();                                 // of all that plan
///       while (const auto planned = exploration.plan(time)) {      // until none has a reason to plan
///         send(planned->robot, planned->trajectory);               // its poses at their times
///         if (exploration.end()) break;
///       }
///     }
///
/// The result depends on the options, the starts, the scans and the times given only. Works in TBB's current
/// arena. Thread safety: as a standard container.
class FRONTLUX_EXPORT ContinuousExploration {
 public:
  /// @throws std::invalid_argument naming the value that is out of bounds
  ContinuousExploration(ExplorationOptions options, Mapping mapping);
  ~ContinuousExploration();
  ContinuousExploration(ContinuousExploration&&) noexcept;
  ContinuousExploration& operator=(ContinuousExploration&&) noexcept;

  /// All robots rest at their starts. Returns step 0, with what is known to be free there.
  /// @param time  [s] on a clock of the user's choice, as all times here, within 10^10 s of its zero: seconds
  ///              since 1970 will do, their millionths will not
  /// @throws std::invalid_argument unless there is one start for each robot, in the map's key range, for such
  ///         a time, or if it has begun
  ExplorationStep begin(std::span<const ExplorationStart> starts, double time);

  /// A scan that a robot took with its sensor at a pose. Returns what it changed in the map. Rays that end on
  /// a robot of the team are to be left out (NaN): what they hit would be closed until others pass there.
  /// @param pose  where the robot was, as it is believed: by it is judged from where it has looked. Rays
  ///              begin at the scan's own origin. It does not move the robot for the planner: new
  ///              trajectories begin on the one that it has. One that is not on that reports `displaced`, or
  ///              `stopped` if something is in its path.
  /// @throws std::invalid_argument before `begin`, if there is no such robot, for a pose that is not finite,
  ///         or for what `Mapping::insert` refuses
  MapChange insert(std::size_t robot, const Pose& pose, const Scan& scan);

  /// A robot rests at a pose since it could not go on: something that no sensor saw blocks its path.
  /// @param blocked  cells that it could not enter; if there are none, or it would not have entered any of
  ///                 them as it is, the cell that it is in will not be entered again
  /// @throws std::invalid_argument before `begin`, if there is no such robot, or for a pose or time out of
  ///         bounds; so do `displaced` and `lose`
  void stopped(std::size_t robot, const Pose& pose, double time, std::span<const VoxelKey> blocked);

  /// A robot rests at a pose that is not the one of its trajectory, and nothing blocks its path: its
  /// controller lagged behind, it was halted, or its localization has jumped. It plans anew from there, as
  /// soon as its turn comes. If what lies between its trajectory and the pose is not known to be free, it
  /// does not go back over what it has travelled before.
  void displaced(std::size_t robot, const Pose& pose, double time);

  /// A robot takes no more part, since it has failed or nobody hears of it any more. It rests at a pose,
  /// where the others keep apart from it, and what it was to see becomes theirs, unless it joins them again.
  void lose(std::size_t robot, const Pose& pose, double time);

  /// A robot that was lost takes part again, from where it rests, and gets its share of what is left to see.
  /// Cells that were closed by `stopped` are open to it. A robot that comes later is in the team from the
  /// begin on, and lost before the first planning. `end` does not wait for it; when it has joined, the
  /// exploration goes on.
  /// @param start  its pose, of a robot on a plane at the height of that; what is known to be free there, if
  ///               the map does not know
  /// @throws std::invalid_argument as `stopped`, or if the robot was not lost
  void join(std::size_t robot, const ExplorationStart& start, double time);

  /// Plans for a robot that has a reason to; nothing if none has. Who has waited for four periods comes
  /// first, then a robot on whose path something is, or that was stopped, then who has waited for two
  /// periods; of the rest the first in the team. Each plans at most once for a time.
  /// @throws std::invalid_argument before `begin`, or for a time out of bounds; so does `finish`
  [[nodiscard]] std::optional<PlannedMotion> plan(double time);

  /// What the robots have done since the last planning, when nobody will plan any more.
  [[nodiscard]] ExplorationStep finish(double time);

  /// Where a robot is by its trajectories, or will be at a time to come.
  /// @throws std::invalid_argument before `begin`, or if there is no such robot
  [[nodiscard]] MotionState at(std::size_t robot, double time) const;

  /// Why the exploration is over; nothing while it goes on. A robot has nothing to do if it has found no goal
  /// and has rested for one and a half periods, in which what closed its way for a moment is seen to be free,
  /// or for ten as long as no scan has come from where it rests; if it has waited for others more than ten
  /// times in a row; or if it is lost. Of low gain is an exploration without tours in which each robot has
  /// chosen a goal of low gain, or found none, `low_gain_steps` times in a row.
  [[nodiscard]] std::optional<ExplorationEnd> end() const;

  /// As given.
  [[nodiscard]] const ExplorationOptions& options() const;
  /// The map so far.
  [[nodiscard]] const Mapping& mapping() const;

 private:
  void rest(std::size_t robot, const Pose& pose, double time);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
