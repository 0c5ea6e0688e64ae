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
  int goals = 0;
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
    ASSERT_FALSE(decision.cells().empty()) << seed;
    const auto truth = naive_cluster_goal(decision, decision.assigned());
    expect_goal(decision.goal(), truth);
    if (!truth || !decision.goal().pose) continue;
    ++goals;
    EXPECT_NEAR(decision.goal().pose->yaw, truth->yaw, 1e-9);
  }
  EXPECT_EQ(goals, 6);
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
  EXPECT_GE(goal.gain, 1.0);
  Found found{*nearest};
  found.yaw = goal.pose->yaw;
  EXPECT_EQ(goal.gain, in_true_view(found, decision.seen_from(*nearest, assigned), member.robot.view).gain);
  if (member.robot.name == "ugv") return sees;
  const auto seen = decision.seen_from(*nearest, wanted);
  const auto length = [&](const VoxelKey& key) { return offset_between(*nearest, key, 1.0).norm(); };
  double least = std::numeric_limits<double>::infinity();
  for (const VoxelKey& key : seen) least = std::min(least, length(key));
  EXPECT_TRUE(std::ranges::any_of(seen, [&](const VoxelKey& key) {  // several may be as near
    const Eigen::Vector3d to = offset_between(*nearest, key, 1.0);
    return length(key) == least && std::abs(goal.pose->yaw - std::atan2(to.y(), to.x())) < 1e-12;
  }));
  return sees;
}

TEST(GoalSelection, NearestIsTheFirstCellByStepsThatSeesTheMiddleOfACluster) {
  std::array<int, 2> of_middle{};  // by robot
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GoalRoom room(26, 6, seed);
    room.clear(5, 20, 2);
    for (const int from : {0, 14}) {
      // Everything, or only what lies at the other side of the room.
      auto frontiers = room.frontiers();
      std::erase_if(frontiers, [&](const VoxelKey& key) { return key.x < GoalRoom::kLow + from; });
      const Sees sees = expect_nearest(room, seed % 2 == 0 ? ground_robot() : aerial_robot(),
                                       room.key(5, 20, 2), frontiers);
      of_middle.at(seed % 2) += sees == Sees::kMiddle ? 1 : 0;
    }
  }
  for (const int count : of_middle) EXPECT_EQ(count, 6);
}

TEST(GoalSelection, NearestSeesAnyFrontierWhereAllMiddlesAreHidden) {
  std::array<int, 2> of_any{}, of_middle{};  // by robot
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    GoalRoom room(12, 4, seed);
    const bool flies = seed / 6 % 2 != 0;
    const int z = flies ? 1 : 2;
    room.clear(5, 5, z);
    auto frontiers = room.frontiers();
    Random random(seed);
    const int kept = 2 + 6 * static_cast<int>(seed % 6);  // of 40
    std::erase_if(frontiers, [&](const VoxelKey&) { return static_cast<int>(random.below(40)) >= kept; });
    const Sees sees =
        expect_nearest(room, flies ? aerial_robot() : ground_robot(), room.key(5, 5, z), frontiers);
    of_any.at(flies ? 1 : 0) += sees == Sees::kFrontier ? 1 : 0;
    of_middle.at(flies ? 1 : 0) += sees == Sees::kMiddle ? 1 : 0;
  }
  for (const int count : of_any) EXPECT_GT(count, 0);
  for (const int count : of_middle) EXPECT_GT(count, 100);
}

// One frontier that is in view from every cell: the goal is the nearest cell that is far enough.
TEST(GoalSelection, NoGoalIsNearerThanTheLeastDistance) {
  GoalRoom room(13, 6);
  const VoxelKey start = room.key(6, 6, 2), frontier = room.unknown(12, 12, 2);
  TeamMember member = ground_robot();
  member.robot.view.max_range = 10.0;
  member.options.advance = 0.0;
  member.options.rendering.samples = ViewQualityOptions::kAll;
  for (const GoalRule rule : {GoalRule::kViewQuality, GoalRule::kClusters, GoalRule::kNearest})
    for (const DistanceMeasure distance : {DistanceMeasure::kPath, DistanceMeasure::kStraight}) {
      if (rule == GoalRule::kNearest && distance == DistanceMeasure::kStraight) continue;
      member.options.rule = rule;
      member.options.distance = distance;
      for (const auto& [least, expected] :
           {std::pair(0.2, 0.3), {0.4, 0.6}, {0.6, 0.6}, {0.8, 0.9}, {1.15, 1.2}}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(rule)) + " from " + std::to_string(least));
        member.options.min_distance = least;
        const Decision decision(room, member, start, {frontier});
        ASSERT_GT(decision.cells().size(), 40U);
        ASSERT_EQ(decision.seen_from(start, {frontier}).size(), 1U);
        // By plain loops as well: straight, there are cells between the multiples of a voxel.
        const auto steps = naive_steps(decision.cells(), start);
        double nearest = std::numeric_limits<double>::infinity();
        for (const VoxelKey& cell : decision.cells()) {
          const double d = distance == DistanceMeasure::kPath
                               ? steps.at(cell) * kResolution
                               : offset_between(start, cell, kResolution).norm();
          if (d > least - 1e-9 && !decision.seen_from(cell, {frontier}).empty())
            nearest = std::min(nearest, d);
        }
        if (distance == DistanceMeasure::kPath) {
          EXPECT_NEAR(nearest, expected, 1e-9);
        }
        ASSERT_TRUE(decision.goal().pose) << decision.goal().reason;
        const double away = distance == DistanceMeasure::kPath
                                ? steps.at(decision.goal().cell) * kResolution
                                : offset_between(start, decision.goal().cell, kResolution).norm();
        EXPECT_NEAR(away, nearest, 1e-9);
      }
      member.options.min_distance = 10.0;
      EXPECT_FALSE(Decision(room, member, start, {frontier}).goal().pose);
    }
}

}  // namespace
}  // namespace frontlux::test
