// Alg. 2 as printed, ray by ray through the grid, against rounds of batches.

#include "planner/goal/goal_room.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/views.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/frontier_assignment.hpp>

#include <tbb/task_arena.h>

namespace frontlux::planner {
namespace {

using test::camera;
using test::cone;
using test::kDegree;
using test::key_at;
using test::lidar;
using test::Random;

// The free voxels stand for cells of a corridor, the unknown ones for frontiers.
struct Scene {
  VoxelGrid grid{0.3};
  std::vector<VoxelKey> cells, frontiers;

  [[nodiscard]] AssignedFrontiers assigned(const RayCaster& caster, const FieldOfView& view,
                                           const std::vector<FrontierViewpoint>& viewpoints = {}) const {
    return find_visible_frontiers(caster, grid, frontiers, {cells, view, viewpoints});
  }
};

// Rooms of random size with walls that have holes, or noise. A dense one has a corridor of most free voxels
// and some others, and few frontiers, in any state.
Scene random_scene(std::uint64_t seed, bool dense = false) {
  Random random(seed);
  Scene scene;
  const int room = 4 + random.below(9), hole = 5 + random.below(40);
  const bool noise = random.one_in(4);
  const int keep_cells = 1 + random.below(12), keep_frontiers = dense ? 8 : 1 + random.below(6);
  for_each_key({key_at(-24, -20, -8), key_at(23, 19, 7)}, [&](const VoxelKey& key) {
    const bool wall = noise ? random.one_in(6) : (key.x % room == 0 || key.y % room == 0 || key.z % 9 == 0);
    if (wall && !random.one_in(hole))
      scene.grid.set(key, Occupancy::kOccupied);
    else if (!random.one_in(8))
      scene.grid.set(key, Occupancy::kFree);
    const Occupancy state = scene.grid.at(key);
    if (dense ? (state == Occupancy::kFree ? !random.one_in(5) : random.one_in(40))
              : state == Occupancy::kFree && random.one_in(4 * keep_cells))
      scene.cells.push_back(key);
    if (state == Occupancy::kUnknown ? random.one_in(keep_frontiers) : dense && random.one_in(300))
      scene.frontiers.push_back(key);
  });
  if (random.one_in(2))  // a corridor in one corner only: most frontiers fail
    std::erase_if(scene.cells, [](const VoxelKey& k) { return k.x > 32768 - 8 || k.y > 32768; });
  random.shuffle(scene.cells);
  std::ranges::sort(scene.frontiers);
  return scene;
}

// The indices of the frontiers that Alg. 2 finds.
std::vector<std::uint32_t> naive(const Scene& scene, const FieldOfView& view) {
  const auto caster = make_grid_ray_caster(scene.grid);
  const auto found = test::naive_assigned(*caster, 0.3, scene.frontiers, scene.cells, view);
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < scene.frontiers.size(); ++i)
    if (std::ranges::find(found, scene.frontiers[i]) != found.end()) indices.push_back(i);
  return indices;
}

// Every frontier is seen from the cell named for it.
void expect_seen_from(const Scene& scene, const FieldOfView& view, const AssignedFrontiers& assigned) {
  ASSERT_EQ(assigned.seen_from.size(), assigned.frontiers.size());
  const std::set<VoxelKey> cells(scene.cells.begin(), scene.cells.end());
  const auto judge = make_grid_ray_caster(scene.grid);
  for (std::size_t i = 0; i < assigned.frontiers.size(); ++i) {
    const VoxelKey &cell = assigned.seen_from[i], &frontier = scene.frontiers[assigned.frontiers[i]];
    ASSERT_TRUE(test::is_visible(*judge, {cell, frontier}, UnknownPolicy::kPass));
    ASSERT_TRUE(cells.contains(cell));
    ASSERT_TRUE(view.contains_at_some_yaw(test::offset_between(cell, frontier, 0.3)));
  }
}

FieldOfView some_view(std::uint64_t seed) {
  return seed % 3 == 0   ? lidar(3.0 + 0.3 * static_cast<double>(seed % 10))
         : seed % 3 == 1 ? camera(5.0)
                         : cone(100 * kDegree, 4.0);
}

class FrontierAssignmentIn : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(DenseOrNot, FrontierAssignmentIn, testing::Bool());

// What is found is what the algorithm as printed finds, and `seen_from` proves it.
TEST_P(FrontierAssignmentIn, EqualsTheAlgorithmAsPrinted) {
  const bool dense = GetParam();
  std::size_t taken = 0, unseen = 0;
  for (std::uint64_t seed = 1; seed <= (dense ? 16 : 24); ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = random_scene(dense ? 100 + seed : seed, dense);
    const auto caster = seed % 2 == 0 ? make_grid_ray_caster(scene.grid) : make_ray_caster(scene.grid);
    // The last dense ones reach higher than a word has bits.
    const FieldOfView view = dense && seed > 12 ? camera(30.0) : some_view(seed);
    const AssignedFrontiers assigned = scene.assigned(*caster, view);
    ASSERT_EQ(assigned.frontiers, naive(scene, view));
    expect_seen_from(scene, view, assigned);
    if (HasFatalFailure()) return;
    taken += assigned.frontiers.size();
    unseen += scene.frontiers.size() - assigned.frontiers.size();
  }
  EXPECT_GT(taken, 1'000U);
  EXPECT_GT(unseen, 1'000U);
}

TEST(FrontierAssignment, PreviousViewpointsChangeNoAnswer) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = random_scene(200 + seed, seed % 2 == 0);
    const FieldOfView view = some_view(seed);
    const auto caster = make_ray_caster(scene.grid);
    const AssignedFrontiers plain = scene.assigned(*caster, view);
    std::vector<FrontierViewpoint> viewpoints;
    for (std::size_t i = 0; i < plain.frontiers.size(); ++i)
      viewpoints.push_back({scene.frontiers[plain.frontiers[i]], plain.seen_from[i]});
    const AssignedFrontiers again = scene.assigned(*caster, view, viewpoints);
    EXPECT_EQ(again.frontiers, plain.frontiers);
    EXPECT_EQ(again.seen_from, plain.seen_from);
    EXPECT_LE(again.rays, plain.rays);
    // Wrong ones: cells that see something else, or none of the corridor's.
    Random random(seed);
    viewpoints.clear();
    for (const VoxelKey& frontier : scene.frontiers)
      viewpoints.push_back(
          {frontier, random.one_in(3) ? key_at(random.below(50) - 25, 0, 0) : random.pick(scene.cells)});
    const AssignedFrontiers misled = scene.assigned(*caster, view, viewpoints);
    EXPECT_EQ(misled.frontiers, plain.frontiers);
    expect_seen_from(scene, view, misled);
  }
}

TEST(FrontierAssignment, GivesTheSecondAgentWhatTheFirstDoesNotSee) {
  const Scene scene = random_scene(5);
  Scene low = scene, high = scene;
  std::erase_if(low.cells, [](const VoxelKey& k) { return k.z != 32768 - 5; });
  std::erase_if(high.cells, [](const VoxelKey& k) { return k.z < 32768 + 1; });
  const std::vector<FrontierAgent> agents = {{low.cells, lidar(6.0)}, {high.cells, camera(10.0)}};
  const auto caster = make_ray_caster(scene.grid);
  const auto assigned = assign_frontiers(*caster, scene.grid, scene.frontiers, agents);
  const auto ugv = naive(low, lidar(6.0)), alone = naive(high, camera(10.0));
  std::vector<std::uint32_t> uav, unassigned;
  std::ranges::set_difference(alone, ugv, std::back_inserter(uav));
  for (std::uint32_t i = 0; i < scene.frontiers.size(); ++i)
    if (!std::ranges::binary_search(ugv, i) && !std::ranges::binary_search(alone, i)) unassigned.push_back(i);
  ASSERT_EQ(assigned.assigned.size(), 2U);
  EXPECT_EQ(assigned.assigned[0].frontiers, ugv);
  EXPECT_EQ(assigned.assigned[1].frontiers, uav);
  EXPECT_EQ(assigned.unassigned, unassigned);
  EXPECT_FALSE(ugv.empty());
  EXPECT_FALSE(uav.empty());
}

TEST_P(FrontierAssignmentIn, AnyNumberOfThreadsGivesTheSame) {
  const Scene scene = random_scene(9, GetParam());
  const auto caster = make_ray_caster(scene.grid);
  std::vector<AssignedFrontiers> assigned;
  for (const int threads : {1, 2, 3})
    tbb::task_arena(threads).execute([&] { assigned.push_back(scene.assigned(*caster, camera(8.0))); });
  for (const AssignedFrontiers& one : assigned) {
    EXPECT_EQ(one.frontiers, assigned[0].frontiers);
    EXPECT_EQ(one.seen_from, assigned[0].seen_from);
    EXPECT_EQ(one.rays, assigned[0].rays);
  }
  EXPECT_FALSE(assigned[0].frontiers.empty());
}

TEST(FrontierAssignment, TakesNothingFromNothing) {
  const Scene scene = random_scene(2);
  const auto caster = make_grid_ray_caster(scene.grid);
  EXPECT_TRUE(find_visible_frontiers(*caster, scene.grid, {}, {scene.cells, camera(8.0)}).frontiers.empty());
  const std::vector<FrontierAgent> stuck = {{{}, lidar(6.0)}};
  EXPECT_EQ(assign_frontiers(*caster, scene.grid, scene.frontiers, stuck).unassigned.size(),
            scene.frontiers.size());
  EXPECT_EQ(assign_frontiers(*caster, scene.grid, scene.frontiers, {}).unassigned.size(),
            scene.frontiers.size());
}

TEST(FrontierAssignment, WorksAtTheEndsOfTheKeyRange) {
  VoxelGrid grid(0.3);
  grid.set({3, 0, 0}, Occupancy::kOccupied);
  const std::vector<VoxelKey> cells = {{0, 0, 0}, {65535, 65535, 65535}};
  const std::vector<VoxelKey> frontiers = {{6, 0, 0}, {65530, 65535, 65535}, {65535, 65535, 65535}};
  const auto caster = make_grid_ray_caster(grid);
  const std::vector<VoxelKey> first(cells.begin(), cells.begin() + 1), second(cells.begin() + 1, cells.end());
  EXPECT_TRUE(find_visible_frontiers(*caster, grid, frontiers, {first, lidar(6.0)}).frontiers.empty());
  EXPECT_EQ(find_visible_frontiers(*caster, grid, frontiers, {second, lidar(6.0)}).frontiers,
            (std::vector<std::uint32_t>{1}));
  EXPECT_REFUSED(find_visible_frontiers(*caster, grid, frontiers, {cells, lidar(6.0)}));
  for (const double range : {-1.0, 1e9})
    EXPECT_REFUSED(find_visible_frontiers(*caster, grid, frontiers, {first, lidar(range)}));
}

}  // namespace
}  // namespace frontlux::planner
