// Cluster goals and nearest goals against plain formulas.

#include "planner/goal/goal_truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace frontlux::test {
namespace {

std::optional<Found> naive_cluster_goal(const RayCaster& caster, const std::vector<VoxelKey>& cells,
                                        const VoxelKey& start, const std::vector<VoxelKey>& assigned,
                                        const FieldOfView& view, const Lattice& lattice) {
  std::map<std::array<int, 3>, std::vector<VoxelKey>> clusters;
  for (const VoxelKey& f : assigned) clusters[{f.x / 4, f.y / 4, f.z / 4}].push_back(f);
  const auto rank = [&](const std::vector<VoxelKey>& cluster, Eigen::Vector3d& mean) {
    mean.setZero();
    for (const VoxelKey& f : cluster) mean += lattice.exact_center(f);
    mean /= static_cast<double>(cluster.size());
    return static_cast<double>(cluster.size()) *
           std::exp(-0.1386 * (mean - lattice.exact_center(start)).norm());
  };
  while (!clusters.empty()) {
    Eigen::Vector3d mean, best_mean;
    auto best = clusters.begin();
    for (auto it = clusters.begin(); it != clusters.end(); ++it)
      if (rank(it->second, mean) > rank(best->second, best_mean)) best = it;
    rank(best->second, best_mean);
    std::vector<VoxelKey> order = best->second;
    std::stable_sort(order.begin(), order.end(), [&](const VoxelKey& a, const VoxelKey& b) {
      return (lattice.exact_center(a) - best_mean).norm() < (lattice.exact_center(b) - best_mean).norm();
    });
    for (const VoxelKey& target : order) {
      std::optional<Found> goal;
      for (const VoxelKey& cell : cells) {
        const double d = (lattice.exact_center(cell) - lattice.exact_center(start)).norm();
        if (d < 0.59 || !view.contains_at_some_yaw(offset_between(cell, target, kResolution)) ||
            !is_visible(caster, cell, target, UnknownPolicy::kBlock))
          continue;
        const auto seen = naive_seen(caster, kResolution, cell, assigned, view);
        Found found = best_yaw(cell, seen, view.horizontal, &target);
        found.quality = found.gain * std::exp(-0.1386 * d);
        if (!goal || found.quality > goal->quality * (1 + 1e-9)) goal = found;
      }
      if (goal) return goal;
    }
    clusters.erase(best);
  }
  return std::nullopt;
}

TEST(GoalSelection, ClustersAsANaiveSearchFindsThem) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GoalRoom room(18, 9, seed);
    room.clear(9, 9, 5);
    const auto caster = make_grid_ray_caster(room.grid);
    TeamMember member = aerial_robot(Method::kPaper);
    member.robot.travel.node_edge = seed % 2 == 0 ? 0.0 : 1.2;
    member.options.cluster_edge = 1.2;
    GoalSelection selection({member}, room.grid.lattice(), room.bounds());
    const Pose pose = room.pose(9, 9, 5);
    auto frontiers = room.frontiers();
    // Hidden ones, so that the first cluster can be exhausted.
    for (int x = 0; x < 18; ++x)
      for (int z = 0; z < 9; ++z)
        if (room.grid.at(room.key(x, 4, z)) == Occupancy::kUnknown) frontiers.push_back(room.key(x, 4, z));
    std::sort(frontiers.begin(), frontiers.end());
    frontiers.erase(std::unique(frontiers.begin(), frontiers.end()), frontiers.end());
    const TeamGoals team = selection.select(*caster, {room.grid}, frontiers, {&pose, 1});
    const std::vector<VoxelKey> cells(selection.corridor(0).cells().begin(),
                                      selection.corridor(0).cells().end());
    if (cells.empty()) continue;
    const auto assigned = naive_assigned(*caster, kResolution, frontiers, cells, member.robot.view);
    const auto truth = naive_cluster_goal(*caster, cells, room.key(9, 9, 5), assigned, member.robot.view,
                                          room.grid.lattice());
    expect_goal(team.goals[0], truth);
    if (truth) {
      EXPECT_NEAR(team.goals[0].pose->yaw, truth->yaw, 1e-9);
    }
  }
}

TEST(GoalSelection, TheWindowHoldsTheClustersTargetWhateverElseCouldBeSeen) {
  GoalRoom room(36, 9);
  std::vector<VoxelKey> frontiers = {room.key(8, 17, 4), room.key(8, 18, 4), room.key(9, 17, 4)};
  for (const int y : {8, 12, 16, 20, 24})
    for (const int z : {4, 5}) frontiers.push_back(room.key(27, y, z));
  for (const VoxelKey& frontier : frontiers) room.grid.set(frontier, Occupancy::kUnknown);
  std::sort(frontiers.begin(), frontiers.end());
  const auto caster = make_grid_ray_caster(room.grid);
  TeamMember member = aerial_robot(Method::kPaper);
  member.robot.view.max_range = 6.0;
  member.options.cluster_edge = 1.2;
  GoalSelection selection({member}, room.grid.lattice(), room.bounds());
  const Pose pose = room.pose(17, 17, 4);
  const Goal goal = selection.select(*caster, {room.grid}, frontiers, {&pose, 1}).goals[0];
  const auto cells = selection.corridor(0).cells();
  expect_goal(goal, naive_cluster_goal(*caster, {cells.begin(), cells.end()}, room.key(17, 17, 4), frontiers,
                                       member.robot.view, room.grid.lattice()));
  ASSERT_TRUE(goal.pose);
  bool holds_target = false;
  for (const VoxelKey& target : {room.key(8, 17, 4), room.key(8, 18, 4), room.key(9, 17, 4)})
    holds_target = holds_target ||
                   member.robot.view.contains(offset_between(goal.cell, target, kResolution), goal.pose->yaw);
  EXPECT_TRUE(holds_target);
}

TEST(GoalSelection, NearestIsTheFirstCellByStepsThatSeesAny) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GoalRoom room(26, 6, seed);
    room.clear(5, 20, 2);
    const auto caster = make_grid_ray_caster(room.grid);
    for (const int from : {0, 14}) {
      TeamMember member = seed % 2 == 0 ? ground_robot() : aerial_robot();
      member.options.rule = GoalRule::kNearest;
      GoalSelection selection({member}, room.grid.lattice(), room.bounds());
      const Pose pose = room.pose(5, 20, 2);
      // Everything, or only what lies at the other side of the room.
      auto frontiers = room.frontiers();
      std::erase_if(frontiers, [&](const VoxelKey& key) { return key.x < GoalRoom::kLow + from; });
      const Goal goal = selection.select(*caster, {room.grid}, frontiers, {&pose, 1}).goals[0];
      const auto cells = selection.corridor(0).cells();
      const auto steps = naive_steps(cells, room.key(5, 20, 2));
      const auto assigned = naive_assigned(*caster, kResolution, frontiers, cells, member.robot.view);
      std::optional<VoxelKey> nearest;
      for (const auto& [cell, count] : steps)
        if (count >= 2 && (!nearest || count < steps.at(*nearest)) &&
            !naive_seen(*caster, kResolution, cell, assigned, member.robot.view).empty())
          nearest = cell;
      ASSERT_EQ(goal.pose.has_value(), nearest.has_value());
      if (!nearest) continue;
      EXPECT_EQ(goal.cell, *nearest);
      EXPECT_NEAR(goal.distance, steps.at(*nearest) * kResolution, 1e-9);
      if (member.robot.name == "ugv") continue;
      const auto seen = naive_seen(*caster, kResolution, *nearest, assigned, member.robot.view);
      const auto length = [&](const VoxelKey& key) { return offset_between(*nearest, key, 1.0).norm(); };
      const auto closest = std::min_element(
          seen.begin(), seen.end(), [&](const auto& a, const auto& b) { return length(a) < length(b); });
      const Eigen::Vector3d to = offset_between(*nearest, *closest, 1.0);
      EXPECT_NEAR(goal.pose->yaw, std::atan2(to.y(), to.x()), 1e-12);
      EXPECT_GE(goal.gain, 1.0);
    }
  }
}

}  // namespace
}  // namespace frontlux::test
