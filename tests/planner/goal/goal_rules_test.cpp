// Cluster goals and nearest goals against plain formulas.

#include "planner/goal/goal_truth.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::test {
namespace {

std::optional<Found> naive_cluster_goal(const Decision& decision, const std::vector<VoxelKey>& assigned) {
  const Lattice& lattice = decision.room.grid.lattice();
  const FieldOfView& view = decision.member.robot.view;
  std::map<std::array<int, 3>, std::vector<VoxelKey>> clusters;
  for (const VoxelKey& f : assigned) clusters[{f.x / 4, f.y / 4, f.z / 4}].push_back(f);
  const auto rank = [&](const std::vector<VoxelKey>& cluster, Eigen::Vector3d& mean) {
    mean.setZero();
    for (const VoxelKey& f : cluster) mean += lattice.exact_center(f);
    mean /= static_cast<double>(cluster.size());
    return static_cast<double>(cluster.size()) *
           std::exp(-0.1386 * (mean - lattice.exact_center(decision.start)).norm());
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
      for (const VoxelKey& cell : decision.cells()) {
        const double d = (lattice.exact_center(cell) - lattice.exact_center(decision.start)).norm();
        if (d < 0.59 || !view.contains_at_some_yaw(offset_between(cell, target, kResolution)) ||
            !is_visible(*decision.caster, {cell, target}, UnknownPolicy::kBlock))
          continue;
        const auto seen = decision.seen_from(cell, assigned);
        Found found = in_true_view(best_yaw(cell, seen, view.horizontal, &target), seen, view);
        found.quality = found.gain * std::exp(-0.1386 * d);
        if (found.gain == 0.0) continue;
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
    TeamMember member = aerial_robot(Method::kPaper);
    member.robot.travel.node_edge = seed % 2 == 0 ? 0.0 : 1.2;
    member.options.cluster_edge = 1.2;
    auto frontiers = room.frontiers();
    // Hidden ones, so that the first cluster can be exhausted.
    for (const VoxelKey& key : keys_of({room.key(0, 4, 0), room.key(17, 4, 8)}))
      if (room.grid.at(key) == Occupancy::kUnknown) frontiers.push_back(key);
    sort(frontiers);
    const Decision decision(room, member, room.key(9, 9, 5), frontiers);
    if (decision.cells().empty()) continue;
    const auto truth = naive_cluster_goal(decision, decision.assigned());
    expect_goal(decision.goal(), truth);
    if (truth) {
      EXPECT_NEAR(decision.goal().pose->yaw, truth->yaw, 1e-9);
    }
  }
}

TEST(GoalSelection, TheWindowHoldsTheClustersTargetWhateverElseCouldBeSeen) {
  GoalRoom room(36, 9);
  const std::vector<VoxelKey> cluster = {room.unknown(8, 17, 4), room.unknown(8, 18, 4),
                                         room.unknown(9, 17, 4)};
  std::vector<VoxelKey> frontiers = cluster;
  for (const int y : {8, 12, 16, 20, 24})
    for (const int z : {4, 5}) frontiers.push_back(room.unknown(27, y, z));
  sort(frontiers);
  TeamMember member = aerial_robot(Method::kPaper);
  member.robot.view.max_range = 6.0;
  member.options.cluster_edge = 1.2;
  const Decision decision(room, member, room.key(17, 17, 4), frontiers);
  const Goal& goal = decision.goal();
  expect_goal(goal, naive_cluster_goal(decision, frontiers));
  ASSERT_TRUE(goal.pose);
  EXPECT_TRUE(std::ranges::any_of(cluster, [&](const VoxelKey& target) {
    return member.robot.view.contains(offset_between(goal.cell, target, kResolution), goal.pose->yaw);
  }));
}

// Of each set of targets that touch each other, the one nearest to the middle of all; sorted.
std::vector<VoxelKey> naive_middles(const std::vector<VoxelKey>& targets) {
  std::set<VoxelKey> left(targets.begin(), targets.end());
  std::vector<VoxelKey> middles;
  while (!left.empty()) {
    std::vector<VoxelKey> cluster = {*left.begin()};
    left.erase(left.begin());
    for (bool grows = true; grows;) {
      grows = false;
      for (auto it = left.begin(); it != left.end();) {
        const bool touches = std::ranges::any_of(cluster, [&](const VoxelKey& key) {
          return offset_between(key, *it, 1.0).cwiseAbs().maxCoeff() < 1.5;
        });
        if (touches) cluster.push_back(*it);
        it = touches ? left.erase(it) : std::next(it);
        grows = grows || touches;
      }
    }
    // In whole numbers, so that ties are ties.
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const VoxelKey origin = GoalRoom::key(0, 0, 0);
    for (const VoxelKey& key : cluster) sum += offset_between(origin, key, 1.0);
    const auto count = static_cast<double>(cluster.size());
    sort(cluster);
    middles.push_back(*std::ranges::min_element(cluster, {}, [&](const VoxelKey& key) {
      return (count * offset_between(origin, key, 1.0) - sum).squaredNorm();
    }));
  }
  sort(middles);
  return middles;
}

// Whether it is the nearest cell that sees the middle of a cluster or, if there is none, any frontier.
enum class Sees { kMiddle, kFrontier, kNothing };
Sees expect_nearest(const GoalRoom& room, TeamMember member, const VoxelKey& start,
                    const std::vector<VoxelKey>& frontiers) {
  member.options.rule = GoalRule::kNearest;
  const Decision decision(room, member, start, frontiers);
  const Goal& goal = decision.goal();
  const auto steps = naive_steps(decision.cells(), decision.start);
  const auto assigned = decision.assigned();
  std::optional<VoxelKey> nearest;
  auto wanted = naive_middles(assigned);
  const auto find = [&] {
    for (const auto& [cell, count] : steps)
      if (count >= 2 && (!nearest || count < steps.at(*nearest)) && !decision.seen_from(cell, wanted).empty())
        nearest = cell;
  };
  find();
  const bool of_middle = nearest.has_value();
  if (!of_middle) {
    wanted = assigned;
    find();
  }
  EXPECT_EQ(goal.pose.has_value(), nearest.has_value());
  if (!nearest || !goal.pose) return Sees::kNothing;
  const Sees sees = of_middle ? Sees::kMiddle : Sees::kFrontier;
  EXPECT_EQ(goal.cell, *nearest);
  EXPECT_NEAR(goal.distance, steps.at(*nearest) * kResolution, 1e-9);
  if (member.robot.name == "ugv") return sees;
  const auto seen = decision.seen_from(*nearest, wanted);
  const auto length = [&](const VoxelKey& key) { return offset_between(*nearest, key, 1.0).norm(); };
  double least = std::numeric_limits<double>::infinity();
  for (const VoxelKey& key : seen) least = std::min(least, length(key));
  EXPECT_TRUE(std::ranges::any_of(seen, [&](const VoxelKey& key) {  // several may be as near
    const Eigen::Vector3d to = offset_between(*nearest, key, 1.0);
    return length(key) == least && std::abs(goal.pose->yaw - std::atan2(to.y(), to.x())) < 1e-12;
  }));
  EXPECT_GE(goal.gain, 1.0);
  return sees;
}

TEST(GoalSelection, NearestIsTheFirstCellByStepsThatSeesTheMiddleOfACluster) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GoalRoom room(26, 6, seed);
    room.clear(5, 20, 2);
    for (const int from : {0, 14}) {
      // Everything, or only what lies at the other side of the room.
      auto frontiers = room.frontiers();
      std::erase_if(frontiers, [&](const VoxelKey& key) { return key.x < GoalRoom::kLow + from; });
      expect_nearest(room, seed % 2 == 0 ? ground_robot() : aerial_robot(), room.key(5, 20, 2), frontiers);
    }
  }
}

TEST(GoalSelection, NearestSeesAnyFrontierWhereAllMiddlesAreHidden) {
  int of_any = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    GoalRoom room(12, 4, seed);
    room.clear(5, 5, 1);
    auto frontiers = room.frontiers();
    Random random(seed);
    const int kept = 2 + 6 * static_cast<int>(seed % 6);  // of 40
    std::erase_if(frontiers, [&](const VoxelKey&) { return static_cast<int>(random.below(40)) >= kept; });
    const TeamMember robot = seed / 6 % 2 == 0 ? ground_robot() : aerial_robot();
    if (expect_nearest(room, robot, room.key(5, 5, 1), frontiers) == Sees::kFrontier) ++of_any;
  }
  EXPECT_GT(of_any, 0);
}

}  // namespace
}  // namespace frontlux::test
