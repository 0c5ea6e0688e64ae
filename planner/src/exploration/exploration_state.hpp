#pragma once

#include "frontier/abandoned_frontiers.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/information_gain.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner {

/// What an exploration knows between the steps, and the parts of one.
struct Exploration::State {
  using Keys = std::vector<VoxelKey>;

  // A path and who sees what along it, until the robot has gone it.
  struct Plan {
    Keys targets;
    std::optional<InformationGain> gain;
  };

  ExplorationOptions options;
  Mapping mapping;
  FrontierSet frontiers;
  std::unique_ptr<RayCaster> caster;
  detail::AbandonedFrontiers abandoned;
  std::optional<GoalSelection> selection = {};
  // Of robots whose corridor is one of nodes: they travel between the nodes by voxels.
  std::vector<std::optional<TravelCorridor>> ways = {};
  std::vector<Pose> poses = {};
  std::vector<std::vector<Pose>> trails = {};  // where each robot has been
  Keys changed = {};                           // by the last step, sorted
  std::uint64_t number = 0;
  int quiet = 0;
  bool idle = false;

  State(ExplorationOptions given, Mapping map);

  [[nodiscard]] const Lattice& lattice() const { return mapping.grid().lattice(); }
  [[nodiscard]] MapChange change() const { return {mapping.grid(), changed}; }
  [[nodiscard]] std::size_t size() const { return options.team.size(); }
  [[nodiscard]] const TravelCorridor& way_of(std::size_t robot) const {
    return ways[robot] ? *ways[robot] : selection->corridor(robot);
  }
  [[nodiscard]] std::optional<VoxelKey> cell_at(const Eigen::Vector3d& position) const {
    const auto x = lattice().key(position.x()), y = lattice().key(position.y()),
               z = lattice().key(position.z());
    if (!x || !y || !z) return std::nullopt;
    return VoxelKey{*x, *y, *z};
  }

  // exploration.cpp
  void select_from(std::span<const ExplorationStart> starts);
  void close(const ExplorationStep& step);

  // exploration_plan.cpp
  TeamGoals select_goals(ExplorationStep& step);
  void plan_way(std::size_t robot, RobotStep& planned);
  Plan optimize(std::size_t robot, const RayCaster& counting, RobotStep& planned);

  // exploration_travel.cpp
  void go(std::size_t robot, const Plan& plan, const Drive& drive, RobotStep& step);
  void take(const RobotStep& step, std::size_t robot);
  void follow(const ExplorationStep& step);

 private:
  [[nodiscard]] std::vector<Pose> way_back(std::size_t robot) const;
};

}  // namespace frontlux::planner
