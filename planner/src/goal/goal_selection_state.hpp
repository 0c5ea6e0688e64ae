#pragma once

#include "assignment/unseen_frontiers.hpp"
#include "goal/goal_query.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/goal_selection.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner {

/// What a team knows between the steps, and how it decides one.
struct GoalSelection::State {
  using Keys = std::vector<VoxelKey>;  // sorted, each once

  struct Member {
    TravelCorridor corridor;
    ViewQualityImage image;
    Keys changed = {};  // since the image was last rendered
    bool lost = false;
    Keys missed = {};                                         // changed since the corridor's last update
    Eigen::Vector3d position = Eigen::Vector3d::Zero();       // [m]
    VoxelKey cell = {};                                       // of the position
    Keys assigned = {};                                       // frontiers to choose a goal for
    Keys released = {};                                       // assigned frontiers that no goal of its sees
    Keys targets = {};                                        // frontiers of its last choice
    std::vector<FrontierViewpoint> previous_viewpoints = {};  // of the assigned frontiers, sorted
    detail::UnseenFrontiers unseen = {};
    bool rendered = false;  // whether the image is that of `targets`
    Goal goal = {};         // the last one
  };

  // One step.
  struct Step {
    const RayCaster& caster;
    const VoxelGrid& grid;
    TeamGoals& result;
    std::optional<std::size_t> choosing = {};  // nothing: all robots
    std::vector<bool> pending = {};            // robots that have to choose, or to choose again

    [[nodiscard]] bool chooses(std::size_t robot) const { return !choosing || *choosing == robot; }
  };

  std::vector<TeamMember> team;
  Lattice lattice;
  KeyBox bounds;
  bool exclusive;  // a frontier is one robot's; else every robot goes for all that it sees
  std::vector<Member> members = {};

  void note_change(const MapChange& change);
  void update_corridor(std::size_t robot, const VoxelGrid& grid, const Pose& pose,
                       CorridorExtent extent = CorridorExtent::kAllCells);
  void lose(std::size_t robot);
  /// As it is before its first step.
  [[nodiscard]] Member new_member(std::size_t robot) const;
  void begin_step(std::optional<std::size_t> choosing);
  void assign(Step& step, const Keys& frontiers);
  void decide(Step& step);

  [[nodiscard]] bool can_move(std::size_t robot) const {
    return members[robot].corridor.state() == CorridorState::kReady;
  }
  [[nodiscard]] detail::GoalQuery query(const RayCaster& caster, std::size_t robot,
                                        std::span<const VoxelKey> targets) const;

 private:
  void renew_corridor(std::size_t robot);
  [[nodiscard]] Keys seen_by(const Step& step, std::size_t robot, const Keys& frontiers) const;
  [[nodiscard]] std::optional<RenderedCell> choose(const Step& step, std::size_t robot, const Keys& targets);
  [[nodiscard]] std::optional<RenderedCell> render(const detail::GoalQuery& query, const VoxelGrid& grid,
                                                   Member& member) const;
  void decide(Step& step, std::size_t robot);
  [[nodiscard]] std::size_t release(Step& step, std::size_t robot);
  void take_uncovered(Step& step, std::size_t robot);
  void set_goal(Goal& goal, std::size_t robot, const RenderedCell& best) const;
};

}  // namespace frontlux::planner
