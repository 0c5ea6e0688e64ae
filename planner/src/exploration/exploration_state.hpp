#pragma once

#include "frontier/abandoned_frontiers.hpp"
#include "mapping/conservative_map.hpp"
#include "tour/tour_planning.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/information_gain.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What an exploration knows between the steps, and the stages of a step.
struct ExplorationState {
  using Keys = std::vector<VoxelKey>;
  using Gains = std::vector<std::optional<InformationGain>>;  // of each robot's path, if it has a goal

  ExplorationOptions options;
  Mapping mapping;
  /// If given: the map in motion. Frontiers come from it.
  std::optional<ConservativeMap> conservative_map = {};
  Keys also_changed = {};  // voxels that count as changed when the frontiers are updated next
  FrontierSet frontiers;
  std::unique_ptr<RayCaster> caster;
  AbandonedFrontiers abandoned;
  std::optional<GoalSelection> selection = {};  // from the start on
  std::optional<TourPlanning> tours = {};       // if they are wanted
  std::vector<Keys> targets = {};               // what each robot looks at on its path
  // Of robots whose corridor is one of nodes: between the nodes they travel by voxels.
  std::vector<std::optional<TravelCorridor>> voxel_corridors = {};
  std::vector<Pose> poses = {};
  std::vector<std::vector<Pose>> trails = {};       // where each robot has been
  std::vector<Goal> last_goals = {};                // of the last step
  std::vector<std::optional<VoxelKey>> ahead = {};  // of a path to a far stop: up to here it is planned
  std::vector<Keys> retreated_to = {};              // by robots that had no goal since
  std::vector<Keys> assigned = {};                  // frontiers that are each robot's, as last noted; sorted
  Keys wanted = {};                                 // frontiers that are not abandoned, at the last selection
  std::size_t unassigned = 0;                       // of them, at the last selection of goals
  Keys changed = {};                                // by the last step, sorted
  std::uint64_t number = 0;                         // of the next step
  double time = 0.0;                                // [s] in lock-step
  int low_gain_steps = 0;                           // in a row
  bool nothing_to_do = false;                       // in the last step no robot had a goal or moved

  ExplorationState(ExplorationOptions given, Mapping map);

  /// How a robot travels between the nodes of its corridor, if it has such. @pre it has been started
  [[nodiscard]] TravelOptions travel_by_voxels(std::size_t robot) const;
  /// What robots find their paths in. On tours it is `conservative_map`: a robot that does not move measures
  /// the same again and again, and if beams that graze the floor had freed it before the robot, it would
  /// never go on.
  [[nodiscard]] const VoxelGrid& travel_map() const {
    return tours ? conservative_map->grid() : mapping.grid();
  }
  [[nodiscard]] const Lattice& lattice() const { return mapping.grid().lattice(); }
  [[nodiscard]] std::size_t size() const { return options.team.size(); }
  [[nodiscard]] ExplorationStep new_step() const;

  // The stages, in their order.
  void start_from(std::span<const ExplorationStart> starts);
  /// A robot that was lost takes part again. Notes nothing of what is known to be free there.
  void join(std::size_t robot, const ExplorationStart& start);
  /// What a robot takes for free at its start. A map that is given knows better, but for its body.
  [[nodiscard]] Keys free_at_start(std::size_t robot, const ExplorationStart& start,
                                   const VoxelGrid& given) const;
  /// Step 0 tells of all that was known before it: of what the first robot has changed.
  static void tell_of_given_map(const VoxelGrid& given, ExplorationStep& step);
  void look_around(std::span<const ExplorationStart> starts, const Drive& drive, ExplorationStep& step);
  void update_views(ExplorationStep& step);
  /// @param choosing  if given: the robot that chooses; the others keep their goals
  void select_goals(ExplorationStep& step, std::optional<std::size_t> choosing = std::nullopt);
  /// Notes which frontiers have become or ceased to be a robot's.
  void note_assignment(ExplorationStep& step);
  /// Brings a robot's corridor up to date; all robots keep their goals.
  void update_corridor(std::size_t robot, ExplorationStep& step,
                       CorridorExtent extent = CorridorExtent::kAllCells);
  /// Writes how many frontiers there are, and how many of them are abandoned, or no robot's.
  void count_frontiers(ExplorationStep& step) const;
  /// Leaves a robot the stop of its tour that it has for a goal. @return false if no path leads there now
  [[nodiscard]] bool keep_stop(std::size_t robot, ExplorationStep& step);
  void set_targets(std::size_t robot);
  /// Shares the frontiers out in tours, and gives a robot the first stop of its tour for a goal.
  /// @param starts  of all robots, when the robot's trajectory begins
  void plan_tours(std::size_t robot, std::span<const MotionState> starts, ExplorationStep& step);
  void plan_paths(ExplorationStep& step);
  [[nodiscard]] Gains optimize_paths(ExplorationStep& step) const;
  /// Turns a robot along its path, and notes in the step what it is expected to see.
  /// @return of the path with these yaws
  [[nodiscard]] InformationGain optimize_path(std::size_t robot, std::vector<Pose>& path,
                                              ExplorationStep& step) const;
  void execute_paths(const Gains& gains, const Drive& drive, ExplorationStep& step);
  [[nodiscard]] bool execute_again(const ExplorationStep& recorded, const Drive& drive,
                                   ExplorationStep& step);
  /// How many of these changes have made a frontier known.
  [[nodiscard]] std::uint64_t mapped_frontiers(std::span<const VoxelChange> changes) const;
  /// Cells that the robot does not go through any more, in all its corridors.
  void block(std::size_t robot, std::span<const VoxelKey> cells);
  void advance_clock(ExplorationStep& step);
  void update_frontiers(ExplorationStep& step);
  /// Takes note of what `Exploration::end` decides by; what follows is the next step.
  void end_step(const ExplorationStep& step);

  /// The one in which its paths are planned.
  [[nodiscard]] const TravelCorridor& path_corridor(std::size_t robot) const {
    return voxel_corridors[robot] ? *voxel_corridors[robot] : selection->corridor(robot);
  }
  /// For a robot without a goal: back to the last place of its trail from which it could go on, from where it
  /// is; empty if there is none.
  [[nodiscard]] std::vector<Pose> plan_retreat(std::size_t robot, const Goal& goal);
  /// Whether no voxel that its sensor has been in can be occupied beside its body.
  [[nodiscard]] bool fills_its_voxel(std::size_t robot) const;
  /// Whether a robot cannot get to where it came from, although there is something to see, and is in the
  /// smaller part of what it has been in.
  [[nodiscard]] bool is_cut_off(std::size_t robot, const Goal& goal) const;
  /// What robots find their paths in, and where the last step has changed it.
  [[nodiscard]] MapChange change() const { return {travel_map(), changed}; }

 private:
  [[nodiscard]] TravelOptions travel_from(const ExplorationStart& start, TravelOptions travel) const;
  [[nodiscard]] std::optional<TravelCorridor> voxel_corridor(TravelOptions travel) const;
  [[nodiscard]] CorridorExtent extent_of_tours(std::size_t robot) const;
  bool find_path_to_stop(std::size_t robot, const VoxelKey& cell, ExplorationStep& step);
  [[nodiscard]] Goal first_stop(std::size_t robot) const;
  [[nodiscard]] double path_gain(const RobotStep& robot) const;
  void count_low_gain(const ExplorationStep& step);
  [[nodiscard]] Keys frontiers_of_others(std::size_t robot) const;
  // The place of the robot's trail to which it retreats, but for cells that it has tried.
  [[nodiscard]] std::optional<std::size_t> place_to_retreat_to(std::size_t robot, const Goal& goal,
                                                               const Keys& tried) const;
  // Takes note of the place that the robot retreats to now; nothing if there is none.
  std::optional<std::size_t> note_retreat(std::size_t robot, const Goal& goal);
  [[nodiscard]] std::vector<Pose> retreat_to(std::size_t robot, std::size_t place);
  [[nodiscard]] bool can_reach_as_many_as(std::size_t robot, std::size_t count) const;
  [[nodiscard]] bool can_reach(std::size_t robot, const VoxelKey& cell) const;
  [[nodiscard]] TravelCorridor corridor_elsewhere(std::size_t robot) const;
  [[nodiscard]] bool would_have_goal_at(TravelCorridor& elsewhere, std::size_t robot, const VoxelKey& cell,
                                        double length) const;
  void remember(std::size_t robot, const RobotStep& step);
};

}  // namespace frontlux::planner::detail
