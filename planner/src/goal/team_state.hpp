#pragma once

#include "assignment/unseen_frontiers.hpp"
#include "goal/goal_query.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/goal_selection.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::planner {

/// What a team knows between the steps, and how one is decided.
struct GoalSelection::State {
  using Keys = std::vector<VoxelKey>;  // sorted, each once

  struct Member {
    TravelCorridor corridor;
    ViewQualityImage image;
    Keys changed = {};                                   // since the image was last rendered
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
    VoxelKey cell = {};                                  // that it is in
    Keys share = {};                                     // frontiers to choose from
    std::vector<FrontierSight> sights = {};              // of its share as it was distributed, sorted
    detail::UnseenFrontiers unseen = {};                 // of those distributed
    Keys blocked = {};                                   // cells it does not go through, in any order
    Keys abandoned = {};                                 // frontiers it made nothing of
    Keys targets = {};                                   // those its goal was last chosen for
    bool rendered = false;                               // whether the image is that of `targets`
  };

  std::vector<TeamMember> team;
  Lattice lattice;
  KeyBox bounds;
  bool distributes;  // else every robot goes for all that it sees
  std::vector<Member> members;

  // goal_selection.cpp
  [[nodiscard]] TravelCorridor new_corridor(const TeamMember& member) const;
  void renew_corridor(std::size_t robot);
  void update(const MapChange& change, std::span<const Pose> poses);
  [[nodiscard]] bool can_move(std::size_t robot) const {
    return members[robot].corridor.state() == CorridorState::kReady;
  }

  // team_decision.cpp
  [[nodiscard]] detail::GoalQuery query(const RayCaster& caster, std::size_t robot,
                                        std::span<const VoxelKey> targets) const;
  void distribute(const RayCaster& caster, const VoxelGrid& grid, const Keys& frontiers, TeamGoals& result);
  void decide(const RayCaster& caster, const VoxelGrid& grid, TeamGoals& result);

 private:
  [[nodiscard]] Keys seen_by(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                             const Keys& frontiers) const;
  std::optional<RenderedCell> choose(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                                     const Keys& targets);
  std::optional<RenderedCell> render(const detail::GoalQuery& query, const VoxelGrid& grid,
                                     Member& member) const;
  void set_goal(Goal& goal, std::size_t robot, const RenderedCell& best) const;
  void decide_one(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot, TeamGoals& result,
                  std::vector<bool>& pending);
  [[nodiscard]] std::size_t release(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                                    TeamGoals& result, std::vector<bool>& pending);
  void take_left_over(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot, TeamGoals& result);
};

}  // namespace frontlux::planner
