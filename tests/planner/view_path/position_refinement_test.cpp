#include "planner/path/walled_space.hpp"
#include "support/complaint.hpp"
#include "support/plain_frontiers.hpp"
#include "support/random.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/position_refinement.hpp>

namespace frontlux::planner {
namespace {

constexpr double kResolution = 0.3;

using test::key_at;

// 40 x 40 x 12 voxels.
struct Hall : test::WalledSpace {
  Hall() : WalledSpace(40, 12, kResolution) {}
  [[nodiscard]] TravelCorridor corridor_of(const Robot& robot, const Pose& at) const {
    return corridor(robot.travel, *grid.lattice().key(at.position));
  }
};

// Pillars, and chests that nobody has looked into.
Hall random_hall(test::Random& random) {
  Hall hall;
  for (int i = 0; i < 14; ++i) {
    const int x = random.below(37), y = random.below(37), z = i % 3 == 0 ? 0 : random.below(8);
    test::fill(hall.grid, {key_at(x, y, z), key_at(x + random.below(3), y + random.below(3), z + 3)},
               random.one_in(3) ? Occupancy::kOccupied : Occupancy::kUnknown);
    if (random.one_in(2)) test::fill(hall.grid, {key_at(x, y, 0), key_at(x, y, 11)}, Occupancy::kOccupied);
  }
  return hall;
}

bool same(std::span<const Pose> a, std::span<const Pose> b) {
  return std::ranges::equal(
      a, b, [](const Pose& p, const Pose& q) { return p.position == q.position && p.yaw == q.yaw; });
}

// Everything that holds of a refined path, judged without the corridor.
void expect_sound(const Hall& hall, std::span<const Pose> given, const RefinedPath& refined,
                  std::span<const VoxelKey> frontiers, const Robot& robot) {
  const auto& path = refined.viewpoints;
  ASSERT_EQ(path.size(), given.size());
  EXPECT_TRUE(same(std::span(path).first(1), given.first(1)));
  EXPECT_TRUE(same(std::span(path).last(1), given.last(1)));
  const auto seen = [&](const auto& poses) {
    return test::seen_by_hand(hall.grid, poses, frontiers, robot.view).size();
  };
  EXPECT_EQ(refined.before.distinct, seen(given));
  EXPECT_EQ(refined.after.distinct, seen(path));
  EXPECT_GE(refined.after.distinct, refined.before.distinct);
  const bool plane = robot.travel.motion == Motion::kPlane;
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LE((path[i].position - given[i].position).norm(), 0.6 * (1 + 1e-9));
    if (plane) {
      EXPECT_EQ(path[i].position.z(), given[i].position.z());
    }
    if (i > 0) {
      EXPECT_LE((path[i].position - path[i - 1].position).norm(), 1.2 * (1 + 1e-8));
    }
  }
  test::expect_free(hall.grid, path, plane ? test::BodyBox{2, 2, 0} : test::BodyBox{1, 1, 1}, 10);
}

Pose random_pose(test::Random& random, double height) {
  const double x = random.uniform(1.0, 11.0), y = random.uniform(1.0, 11.0);
  return {{x, y, height > 0.0 ? height : random.uniform(1.3, 2.9)}, random.uniform(-3.0, 3.0)};
}

TEST(PositionRefinement, NeverSeesFewerAndStaysFree) {
  for (const bool on_ground : {false, true}) {
    const Robot robot = on_ground ? ugv() : uav();
    std::uint64_t before = 0, after = 0;
    int paths = 0, moved = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      test::Random random(seed);
      const Hall hall = random_hall(random);
      const Pose start = random_pose(random, on_ground ? 0.75 : 0.0);
      Pose goal = random_pose(random, on_ground ? 0.75 : 0.0);
      const TravelCorridor corridor = hall.corridor_of(robot, start);
      const PathPlan plan = plan_path(corridor, hall.grid.lattice(), start, goal, {seed, 0, 0});
      if (!plan.found()) continue;
      const FrontierSet frontiers(hall.grid, hall.bounds);
      const auto fast = make_ray_caster(hall.grid), walk = make_grid_ray_caster(hall.grid);
      const auto pairs = visible_pairs(*fast, hall.grid, plan.viewpoints, frontiers.keys(), robot.view);
      auto path = plan.viewpoints;
      const auto turned =
          optimize_path(path, centers(hall.grid.lattice(), frontiers.keys()), pairs, robot.view);
      for (std::size_t i = 1; i + 1 < path.size(); ++i) path[i].yaw = turned.yaws[i];

      const auto refined = refine_positions(path, frontiers.keys(), *fast, hall.grid, corridor, robot);
      expect_sound(hall, path, refined, frontiers.keys(), robot);
      if (HasFatalFailure()) return;
      EXPECT_EQ(same(path, refined.viewpoints), refined.outer_iterations == 0);
      const auto again = refine_positions(path, frontiers.keys(), *walk, hall.grid, corridor, robot);
      EXPECT_TRUE(same(again.viewpoints, refined.viewpoints));
      EXPECT_EQ(again.rays, refined.rays);
      EXPECT_EQ(again.after.fuzzy, refined.after.fuzzy);
      ++paths;
      moved += refined.outer_iterations > 0 ? 1 : 0;
      before += refined.before.distinct;
      after += refined.after.distinct;
    }
    EXPECT_GE(paths, 12);
    EXPECT_GT(moved, 3);
    EXPECT_GT(after, before);
  }
}

// A lidar of 3 m on a straight path, 3.25 m from the only frontier.
struct OutOfRange {
  Hall hall;
  Robot robot = uav();
  std::vector<Pose> path{{{2.15, 2.0, 1.65}, 0.5}, {{3.15, 2.0, 1.65}, 0.0}, {{4.15, 2.0, 1.65}, -0.5}};
  std::vector<VoxelKey> frontiers{key_at(10, 17, 5)};  // its centre at 3.15, 5.25, 1.65 m

  OutOfRange() {
    hall.grid.set(frontiers[0], Occupancy::kUnknown);
    robot.view = {FieldOfView::Shape::kSpinning, 0.0, 0.7, 3.0};
  }
  [[nodiscard]] RefinedPath refine(const PositionOptions& options = {}) const {
    const auto caster = make_ray_caster(hall.grid);
    return refine_positions(path, frontiers, *caster, hall.grid, hall.corridor_of(robot, path[0]), robot,
                            options);
  }
};

TEST(PositionRefinement, StepsTowardsWhatIsOutOfRange) {
  const OutOfRange scene;
  const auto refined = scene.refine();
  expect_sound(scene.hall, scene.path, refined, scene.frontiers, scene.robot);
  EXPECT_EQ(refined.before.distinct, 0U);
  EXPECT_EQ(refined.after.distinct, 1U);
  EXPECT_GT(refined.viewpoints[1].position.y(), 2.25);
  EXPECT_NEAR(refined.viewpoints[1].position.x(), 3.15, 0.05);  // by symmetry

  PositionOptions near;
  near.max_shift = 0.2;  // not enough
  const auto short_of = scene.refine(near);
  EXPECT_EQ(short_of.after.distinct, 0U);
  EXPECT_LE((short_of.viewpoints[1].position - scene.path[1].position).norm(), 0.2 * (1 + 1e-9));

  PositionOptions taut;
  taut.spacing = 1.0;  // as long as the segments already are
  EXPECT_EQ(scene.refine(taut).outer_iterations, 0);
  EXPECT_TRUE(same(scene.refine(taut).viewpoints, scene.path));
}

TEST(PositionRefinement, AWallHoldsItBack) {
  OutOfRange scene;
  // The box around the path just fits beside it.
  test::fill(scene.hall.grid, {key_at(0, 8, 0), key_at(39, 8, 11)}, Occupancy::kOccupied);
  scene.hall.grid.set(key_at(10, 8, 5), Occupancy::kFree);  // a hole to look through
  const auto refined = scene.refine();
  expect_sound(scene.hall, scene.path, refined, scene.frontiers, scene.robot);
  EXPECT_LT(refined.viewpoints[1].position.y(), 2.1);
  EXPECT_EQ(refined.after.distinct, 0U);
}

TEST(PositionRefinement, NothingToSeeOrToMoveLeavesThePath) {
  OutOfRange scene;
  scene.frontiers.clear();
  const auto blind = scene.refine();
  EXPECT_TRUE(same(blind.viewpoints, scene.path));
  EXPECT_EQ(blind.rays, 0U);
  EXPECT_EQ(blind.after.distinct, 0U);
  scene = {};
  for (scene.path.pop_back(); !scene.path.empty(); scene.path.pop_back()) {
    const auto kept = scene.refine();
    EXPECT_TRUE(same(kept.viewpoints, scene.path));
    EXPECT_EQ(kept.outer_iterations, 0);
  }
}

TEST(PositionRefinement, RefusesWrongOptionsAndPoses) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const OutOfRange scene;
  const auto refused = [&](const auto& change) {
    PositionOptions options;
    change(options);
    EXPECT_REFUSED(scene.refine(options));
  };
  refused([](auto& o) { o.outer_iterations = 0; });
  refused([](auto& o) { o.steps = -1; });
  for (const double bad : {nan, inf, 0.0, -1.0}) {
    refused([&](auto& o) { o.max_shift = bad; });
    refused([&](auto& o) { o.spacing = bad; });
    refused([&](auto& o) { o.sharpness = bad; });
  }
  refused([](auto& o) { o.optimizer.yaw_bins = 0; });
  for (const double bad : {nan, inf}) {
    OutOfRange off, turned;
    off.path[1].position.x() = bad;
    EXPECT_REFUSED(off.refine());
    turned.path[1].yaw = bad;
    EXPECT_REFUSED(turned.refine());
  }
}

}  // namespace
}  // namespace frontlux::planner
