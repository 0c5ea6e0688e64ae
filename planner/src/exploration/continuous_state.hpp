#pragma once

#include "exploration/exploration_state.hpp"
#include "motion/departure.hpp"
#include "motion/separation.hpp"

#include <frontlux/planner/continuous_exploration.hpp>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace frontlux::planner {

/// What a continuous exploration knows between two plannings.
struct ContinuousExploration::State {
  using Keys = std::vector<VoxelKey>;

  /// One robot in motion.
  struct Member {
    detail::Follower motion;
    std::optional<double> planned = {};  // [s] when it planned last
    double chosen = 0.0;                 // [s] when it chose its goal
    std::uint64_t gained = 0;            // frontiers that it has mapped since it planned last
    bool stopped = false, blocked = false;
    bool lost = false;              // takes no more part
    bool goes_back = false;         // on the way on which it came
    bool going = false;             // it has a goal, or goes back
    int low_gains = 0;              // plannings in a row that expect to see next to nothing
    int waits = 0;                  // plannings in a row after which it could not set out for its goal
    Goal goal = {};                 // the last one
    Keys goal_frontiers = {};       // in view at the goal; sorted
    Keys needed = {};               // voxels that its trajectory needs free; sorted
    Keys held_back_from = {};       // cells that it could not enter since the last planning
    std::vector<Pose> sensed = {};  // where it took scans, from the last one before the last planning on
  };

  detail::ExplorationState team;
  std::vector<Member> members = {};
  VoxelGrid before;                                            // the map at the last planning
  std::vector<std::pair<VoxelKey, std::size_t>> touched = {};  // since then, and by whom

  void settle(double time);
  [[nodiscard]] std::optional<PlanReason> reason_to_plan(const Member& member, double time) const;
  [[nodiscard]] PlannedMotion plan(std::size_t robot, PlanReason reason, double time);
  void take(std::size_t robot, const MapChange& change);
  [[nodiscard]] ExplorationStep collect(double time);
  /// Whether there is nothing for a robot to do, or it has waited for others long enough.
  [[nodiscard]] static bool is_idle(const Member& member);

 private:
  void note_look(std::size_t robot, PlanReason reason, ExplorationStep& step);
  [[nodiscard]] std::vector<KeyBox> places_of_others(std::size_t robot) const;
  [[nodiscard]] Trajectory find_trajectory(std::size_t robot, double start, ExplorationStep& step);
  [[nodiscard]] Trajectory go_back(std::size_t robot, double start, ExplorationStep& step);
  void take_up(std::size_t robot, double start, Trajectory& trajectory, ExplorationStep& step);
  [[nodiscard]] bool brakes_instead(std::size_t robot, double start, Trajectory& trajectory);
  void judge(std::size_t robot, const RobotStep& step);
  [[nodiscard]] bool keeps_apart(std::size_t robot, const Trajectory& trajectory) const;
  [[nodiscard]] SegmentTest segment_test(std::size_t robot) const;
  [[nodiscard]] Keys voxels_needed(std::size_t robot, const Trajectory& trajectory) const;
};

}  // namespace frontlux::planner
