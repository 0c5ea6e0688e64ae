// Alg. 2 as printed, ray by ray through the grid, against rounds of batches.

#include "planner/goal/goal_room.hpp"
#include "support/random.hpp"

#include <frontlux/planner/frontier_assignment.hpp>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Random;

constexpr double kDegree = std::numbers::pi / 180;
FieldOfView lidar(double range) { return {FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, range}; }
FieldOfView camera(double range) { return {FieldOfView::Shape::kPyramid, 90 * kDegree, 72 * kDegree, range}; }
FieldOfView sonar(double range) { return {FieldOfView::Shape::kCone, 100 * kDegree, 0.0, range}; }

VoxelKey key_at(int x, int y, int z) { return make_key(32768 + x, 32768 + y, 32768 + z); }

// The free voxels stand for cells of a corridor, the unknown ones for frontiers.
struct Scene {
  VoxelGrid grid{0.3};
  std::vector<VoxelKey> cells, frontiers;
};

// Rooms of random size with walls that have holes, or noise. A dense one has a corridor of most free voxels
// and some others, and few frontiers, in any state.
Scene random_scene(std::uint64_t seed, bool dense = false) {
  Random random(seed);
  Scene scene;
  const int room = 4 + random.below(9), hole = 5 + random.below(40);
  const bool noise = random.one_in(4);
  const int keep_cells = 1 + random.below(12), keep_frontiers = dense ? 8 : 1 + random.below(6);
  for (int x = -24; x < 24; ++x)
    for (int y = -20; y < 20; ++y)
      for (int z = -8; z < 8; ++z) {
        const bool wall = noise ? random.one_in(6) : (x % room == 0 || y % room == 0 || z % 9 == 0);
        const VoxelKey key = key_at(x, y, z);
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
      }
  if (random.one_in(2))  // a corridor in one corner only: most frontiers fail
    std::erase_if(scene.cells, [](const VoxelKey& k) { return k.x > 32768 - 8 || k.y > 32768; });
  for (std::size_t i = scene.cells.size(); i > 1; --i)
    std::swap(scene.cells[i - 1], scene.cells[random.bits() % i]);
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
    ASSERT_TRUE(test::is_visible(*judge, cell, frontier, UnknownPolicy::kPass));
    ASSERT_TRUE(cells.contains(cell));
    ASSERT_TRUE(view.contains_at_some_yaw(test::offset_between(cell, frontier, 0.3)));
  }
}

// What is found is what the algorithm as printed finds, and `seen_from` proves it.
void expect_as_printed(const Scene& scene, const FieldOfView& view, const RayCaster& caster,
                       std::size_t& taken, std::size_t& unseen) {
  const AssignedFrontiers assigned =
      find_visible_frontiers(caster, scene.grid, scene.frontiers, {scene.cells, view});
  ASSERT_EQ(assigned.frontiers, naive(scene, view));
  expect_seen_from(scene, view, assigned);
  taken += assigned.frontiers.size();
  unseen += scene.frontiers.size() - assigned.frontiers.size();
}

FieldOfView some_view(std::uint64_t seed) {
  return seed % 3 == 0   ? lidar(3.0 + 0.3 * static_cast<double>(seed % 10))
         : seed % 3 == 1 ? camera(5.0)
                         : sonar(4.0);
}

TEST(FrontierAssignment, EqualsTheAlgorithmAsPrinted) {
  std::size_t taken = 0, unseen = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Scene scene = random_scene(seed);
    const auto caster = seed % 2 == 0 ? make_grid_ray_caster(scene.grid) : make_ray_caster(scene.grid);
    SCOPED_TRACE(seed);
    expect_as_printed(scene, some_view(seed), *caster, taken, unseen);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(taken, 1'000U);
  EXPECT_GT(unseen, 1'000U);
}

TEST(FrontierAssignment, EqualsTheAlgorithmAsPrintedInDeepCorridors) {
  std::size_t taken = 0, unseen = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const Scene scene = random_scene(100 + seed, true);
    const auto caster = seed % 2 == 0 ? make_grid_ray_caster(scene.grid) : make_ray_caster(scene.grid);
    // The last ones reach higher than a word has bits.
    const FieldOfView view = seed <= 12 ? some_view(seed) : camera(30.0);
    SCOPED_TRACE(seed);
    expect_as_printed(scene, view, *caster, taken, unseen);
    if (HasFatalFailure()) return;
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
    const AssignedFrontiers plain =
        find_visible_frontiers(*caster, scene.grid, scene.frontiers, {scene.cells, view});
    std::vector<FrontierViewpoint> viewpoints;
    for (std::size_t i = 0; i < plain.frontiers.size(); ++i)
      viewpoints.push_back({scene.frontiers[plain.frontiers[i]], plain.seen_from[i]});
    const AssignedFrontiers again =
        find_visible_frontiers(*caster, scene.grid, scene.frontiers, {scene.cells, view, viewpoints});
    EXPECT_EQ(again.frontiers, plain.frontiers);
    EXPECT_EQ(again.seen_from, plain.seen_from);
    EXPECT_LE(again.rays, plain.rays);
    // Wrong ones: cells that see something else, or none of the corridor's.
    Random random(seed);
    viewpoints.clear();
    for (const VoxelKey& frontier : scene.frontiers)
      viewpoints.push_back(
          {frontier, random.one_in(3) ? key_at(random.below(50) - 25, 0, 0) : random.pick(scene.cells)});
    const AssignedFrontiers misled =
        find_visible_frontiers(*caster, scene.grid, scene.frontiers, {scene.cells, view, viewpoints});
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

class FrontierAssignmentThreads : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(DenseOrNot, FrontierAssignmentThreads, testing::Bool());

TEST_P(FrontierAssignmentThreads, AnyNumberGivesTheSame) {
  const Scene scene = random_scene(9, GetParam());
  const auto caster = make_ray_caster(scene.grid);
  std::vector<AssignedFrontiers> assigned;
  for (const int threads : {1, 2, 3}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      assigned.push_back(
          find_visible_frontiers(*caster, scene.grid, scene.frontiers, {scene.cells, camera(8.0)}));
    });
  }
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
  EXPECT_THROW((void)find_visible_frontiers(*caster, grid, frontiers, {cells, lidar(6.0)}),
               std::invalid_argument);
  EXPECT_THROW((void)find_visible_frontiers(*caster, grid, frontiers, {first, lidar(-1.0)}),
               std::invalid_argument);
  EXPECT_THROW((void)find_visible_frontiers(*caster, grid, frontiers, {first, lidar(1e9)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::planner
