#pragma once

#include "exploration/exploration_state.hpp"
#include "motion/separation.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/continuous_exploration.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace frontlux::planner {

/// What a continuous exploration knows between two plannings.
struct ContinuousExploration::State {
  using Keys = std::vector<VoxelKey>;

  /// To make room for robot `by`, which has nothing to do unless it gets past this one.
  struct Request {
    std::size_t by = 0;
    Keys path;  // cells
  };

  enum class Activity : std::uint8_t {
    kRests,       ///< until something happens
    kMoves,       ///< on its trajectory
    kTriesAgain,  ///< brakes, and plans anew as soon as it rests: nothing ends before
    kRetreats,    ///< on the path on which it came
    kMakesRoom,   ///< by leaving the path of another one
    kLost,        ///< takes no more part
  };

  /// One robot in motion.
  struct Member {
    detail::RobotMotion motion;
    std::optional<double> planned = {};     // [s] when it planned last
    std::optional<double> idle_since = {};  // [s] when it planned first without setting out, since it did
    double chosen = 0.0;                    // [s] when it chose its goal
    std::uint64_t gained = 0;               // frontiers that it has mapped since it planned last
    Activity activity = Activity::kRests;
    bool stopped = false;           // by a bumper, or whatever it met
    bool blocked = false;           // its trajectory, by a voxel that has turned out not to be free
    bool meets_other = false;       // its trajectory leads too near to another one that has stopped
    int low_gains = 0;              // plannings in a row that expect to see next to nothing
    int waits = 0;                  // plannings in a row after which it could not set out, or waited for room
    Goal goal = {};                 // the last one
    Keys goal_frontiers = {};       // in view at the goal; sorted
    Keys needed = {};               // voxels that its trajectory needs free; sorted
    Keys closed = {};               // of these, since it was last looked whether it has passed them
    Keys floor = {};                // voxels that must not become holes under its trajectory; sorted
    Keys opened = {};               // of these, since the same time
    Keys held_back_from = {};       // cells that it could not enter since the last planning
    std::vector<Pose> sensed = {};  // where it took scans, from the last one before the last planning on
    std::size_t samples = 0;        // of its trajectory that its trail has, or passes near by
    std::vector<Pose> passed = {};  // of these, since the last one that the trail has
    std::optional<Pose> last_look = {};          // where it took its last scan that shows something
    std::vector<Eigen::Vector3f> measured = {};  // directions of that scan in which it shows something
    bool sees_nothing = false;                   // all its scans since have shown nothing, and there is one
    bool looked = false;                         // it has taken it since it planned last
    std::optional<Pose> look_before = {};        // the same at the planning before with such a scan
    int missed_looks = 0;  // plannings in a row at its goal with scans from where it rests, beside that
    std::optional<Request> request = {};   // by another one, while it has no goal
    bool others_rest = false;              // another one has come to rest, or was lost, since it planned last
    bool asks = true;                      // when it plans next without a goal: others to make room
    std::vector<Keys> others_rested = {};  // where, each time that it has asked since it had a goal
    std::optional<VoxelKey> told_from = {};  // where it rested when it told the others last

    void note_closed(const VoxelKey& key) {
      if (std::ranges::binary_search(needed, key)) closed.push_back(key);
    }
    void note_opened(const VoxelKey& key) {
      if (std::ranges::binary_search(floor, key)) opened.push_back(key);
    }
    [[nodiscard]] bool is_lost() const { return activity == Activity::kLost; }
    /// Whether it moves, or tries again at once.
    [[nodiscard]] bool is_going() const { return activity != Activity::kRests && !is_lost(); }
    /// Whether it keeps out of all cells in which it might be too near to another one, as every other time
    /// that it waits; else of those in whose middle it would be: it may rest in one of the others.
    [[nodiscard]] bool keeps_out_of_all() const { return waits % 2 == 1; }
  };

  detail::ExplorationState team;
  std::vector<Member> members = {};
  VoxelGrid before;                                            // the map at the last planning
  std::vector<std::pair<VoxelKey, std::size_t>> touched = {};  // since then, and by whom

  void set_motion(std::size_t robot, Trajectory trajectory);
  void start_next_trajectories(double time);
  [[nodiscard]] bool is_at_end(const Member& member, const Pose& pose) const;
  [[nodiscard]] bool has_looked(const Member& member, double time) const;
  [[nodiscard]] std::optional<PlanReason> reason_to_plan(const Member& member, double time) const;
  [[nodiscard]] PlannedMotion plan(std::size_t robot, PlanReason reason, double time);
  void note_scan(std::size_t robot, const MapChange& change);
  void note_solid(std::span<const VoxelKey> voxels);
  void look_for_blocked(double time);
  void extend_trail(std::size_t robot, double until);
  void cut_trail(std::size_t robot, const Eigen::Vector3d& rests);
  void leave_trail(std::size_t robot, double tolerance);
  void stay_on_plane(std::size_t robot, Pose& pose, double time) const;
  [[nodiscard]] ExplorationStep collect(double time);
  [[nodiscard]] Keys voxels_of_robots(double time) const;
  /// A robot needs no room any more.
  void withdraw_requests(std::size_t robot);
  /// A robot has come to rest. The others that rest plan again: they may ask it for room, or get to what it
  /// kept closed.
  void tell_of_rest(std::size_t robot);
  /// A robot is lost: each of the others decides anew what there is for it to do.
  void tell_of_loss(std::size_t robot);
  /// A robot has stopped where none of the others knew that it would: they may not go on through it.
  void tell_of_stop(std::size_t robot, double time);
  /// For long enough, or it has waited long enough for others.
  [[nodiscard]] bool has_nothing_to_do(const Member& member) const;

 private:
  enum class Others { kAll, kThatDoNotRest };

  void note_look(std::size_t robot, PlanReason reason, ExplorationStep& step);
  [[nodiscard]] std::optional<KeyBox> cells_too_near(std::size_t robot, std::size_t other,
                                                     const Eigen::Vector3d& other_at, double shrunk) const;
  [[nodiscard]] std::vector<KeyBox> places_of_others(std::size_t robot, Others which) const;
  [[nodiscard]] bool rests_without_goal(const Member& member) const;
  [[nodiscard]] bool waits_for_room(std::size_t robot) const;
  [[nodiscard]] Keys path_without_resting(std::size_t robot, ExplorationStep& step);
  void end_request(std::size_t robot);
  void ask_for_room(std::size_t robot, ExplorationStep& step);
  [[nodiscard]] std::vector<Pose> path_aside(std::size_t robot) const;
  [[nodiscard]] Trajectory find_trajectory(std::size_t robot, double start, ExplorationStep& step);
  [[nodiscard]] Trajectory without_goal(std::size_t robot, double start, ExplorationStep& step);
  void take_up(std::size_t robot, double start, Trajectory& trajectory, ExplorationStep& step);
  [[nodiscard]] bool brakes_instead(std::size_t robot, double start, Trajectory& trajectory);
  void count_low_gain(std::size_t robot, const RobotStep& step, bool kept);
  [[nodiscard]] bool keeps_apart(std::size_t robot, const Trajectory& trajectory) const;
  [[nodiscard]] bool keeps_apart(std::size_t robot, const Trajectory& trajectory, double from,
                                 std::size_t other) const;
  [[nodiscard]] SegmentTest segment_test(std::size_t robot) const;
  [[nodiscard]] Keys cells_on(const BodyStencil& stencil, const Trajectory& trajectory, double since,
                              bool retreats) const;
  [[nodiscard]] Keys voxels_needed(std::size_t robot, const Trajectory& trajectory, Keys& floor) const;
};

}  // namespace frontlux::planner
