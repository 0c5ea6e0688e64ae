#include "embree/blocker_boxes.hpp"

#include "support/maps.hpp"
#include "support/random.hpp"
#include "walk/walk.hpp"

#include <frontlux/octomap.hpp>

#include <gtest/gtest.h>

namespace frontlux::test {
namespace {

using detail::Blockers;
using detail::blocks;
using detail::make_blockers;

std::vector<KeyBox> boxes_of(const Blockers& blockers) {
  std::vector<KeyBox> boxes;
  for (const auto& group : blockers.groups)
    for (std::size_t i = 0; i < group->boxes.size(); ++i) boxes.push_back(group->box(i));
  return boxes;
}

std::vector<KeyBox> make_blocker_boxes(const VoxelGrid& grid, UnknownPolicy unknown) {
  return boxes_of(make_blockers(grid, unknown));
}

bool in_one_cube(const KeyBox& box, int edge) {
  return box.min.x / edge == box.max.x / edge && box.min.y / edge == box.max.y / edge &&
         box.min.z / edge == box.max.z / edge;
}

// Boxes hold nothing but blockers, stay in their unit, and cover every blocker in `part` with a face
// neighbour that is none.
void expect_boxes_are_the_shell(const VoxelGrid& grid, UnknownPolicy unknown, const KeyBox& part) {
  std::set<VoxelKey> covered;
  for (const KeyBox& box : make_blocker_boxes(grid, unknown)) {
    const bool whole_node = box.max.x - box.min.x >= 63;
    EXPECT_TRUE(whole_node || in_one_cube(box, detail::BoxGroup::kUnitEdge));
    for (int z = std::max(box.min.z, part.min.z); z <= std::min(box.max.z, part.max.z); ++z)
      for (int y = std::max(box.min.y, part.min.y); y <= std::min(box.max.y, part.max.y); ++y)
        for (int x = std::max(box.min.x, part.min.x); x <= std::min(box.max.x, part.max.x); ++x) {
          const VoxelKey key = detail::as_key({x, y, z});
          ASSERT_TRUE(blocks(grid.at(key), unknown));
          covered.insert(key);
        }
  }
  for (int z = part.min.z; z <= part.max.z; ++z)
    for (int y = part.min.y; y <= part.max.y; ++y)
      for (int x = part.min.x; x <= part.max.x; ++x) {
        if (!blocks(grid.at(detail::as_key({x, y, z})), unknown)) continue;
        bool shell = false;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {-1, 1}) {
            std::array<int, 3> beside{x, y, z};
            beside[axis] += side;
            if (beside[axis] < 0 || beside[axis] > 65535) continue;
            shell = shell || !blocks(grid.at(detail::as_key(beside)), unknown);
          }
        ASSERT_TRUE(!shell || covered.contains(detail::as_key({x, y, z}))) << x << ' ' << y << ' ' << z;
      }
}

TEST(BlockerBoxes, CoverTheShellAndNothingFree) {
  const KeyBox part{{32700, 32700, 32700}, {32840, 32840, 32840}};
  for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      expect_boxes_are_the_shell(make_voxel_grid(*make_random_tree(seed, 0.1)), unknown, part);
      expect_boxes_are_the_shell(make_voxel_grid(*make_noise_tree(seed, 0.1, 40)), unknown, part);
    }
}

TEST(BlockerBoxes, HoldAtTheEdgesOfTheKeyRange) {
  VoxelGrid grid(0.1);
  grid.fill({{0, 0, 0}, 5}, Occupancy::kFree);
  grid.set({0, 3, 3}, Occupancy::kOccupied);
  grid.set({31, 0, 31}, Occupancy::kOccupied);
  for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
    expect_boxes_are_the_shell(grid, unknown, {{0, 0, 0}, {40, 40, 40}});
  grid.fill({{}, 16}, Occupancy::kUnknown);
  grid.fill({{65504, 65504, 65504}, 5}, Occupancy::kFree);
  grid.set({65535, 65535, 65530}, Occupancy::kOccupied);
  for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
    expect_boxes_are_the_shell(grid, unknown, {{65490, 65490, 65490}, {65535, 65535, 65535}});
}

TEST(BlockerBoxes, AFlatWallIsAFewBoxes) {
  VoxelGrid grid(0.1);
  grid.fill({{32768, 32768, 32768}, 6}, Occupancy::kFree);
  for (std::uint16_t y = 0; y < 64; ++y)
    for (std::uint16_t z = 0; z < 64; ++z)
      grid.set({32800, static_cast<std::uint16_t>(32768 + y), static_cast<std::uint16_t>(32768 + z)},
               Occupancy::kOccupied);
  EXPECT_EQ(make_blocker_boxes(grid, UnknownPolicy::kPass).size(), std::size_t{16});
}

TEST(BlockerBoxes, UniformMapsNeedNone) {
  VoxelGrid grid(0.1);
  for (const Occupancy state : {Occupancy::kUnknown, Occupancy::kFree, Occupancy::kOccupied}) {
    grid.fill({{}, 16}, state);
    EXPECT_TRUE(make_blocker_boxes(grid, UnknownPolicy::kBlock).empty());
    EXPECT_TRUE(make_blocker_boxes(grid, UnknownPolicy::kPass).empty());
  }
}

// What is followed equals what is made anew, box for box, and what did not change is shared.
TEST(BlockerBoxes, FollowingEqualsMakingAnew) {
  Random random(21);
  for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      VoxelGrid grid = make_voxel_grid(*make_random_tree(seed, 0.1));
      Blockers followed = make_blockers(grid, unknown);
      for (int round = 0; round < 15; ++round) {
        const VoxelGrid before = grid;
        const int edits = random.below(20);
        for (int i = 0; i < edits; ++i) {
          const int log2_edge = random.one_in(4) ? random.below(8) : 0;
          const auto along = [&] {
            return static_cast<std::uint16_t>((32768 + random.below(200) - 100) >> log2_edge << log2_edge);
          };
          grid.fill({{along(), along(), along()}, log2_edge}, static_cast<Occupancy>(random.below(3)));
        }
        followed = detail::update_blockers(followed, before, grid, unknown);
        ASSERT_EQ(boxes_of(followed), boxes_of(make_blockers(grid, unknown)));
      }
    }
  VoxelGrid grid = make_voxel_grid(*make_random_tree(1, 0.1));
  const Blockers blockers = make_blockers(grid, UnknownPolicy::kBlock);
  const VoxelGrid before = grid;
  grid.set({32768 + 20, 32768 + 20, 32768 + 20}, Occupancy::kOccupied);
  const Blockers after = detail::update_blockers(blockers, before, grid, UnknownPolicy::kBlock);
  std::size_t shared = 0;
  for (const auto& group : after.groups)
    shared += static_cast<std::size_t>(std::count(blockers.groups.begin(), blockers.groups.end(), group));
  EXPECT_GE(shared + 3, after.groups.size());  // whole nodes, and the tile
}

// One free leaf of 2^45 voxels: its surface must not be spelt out in small boxes.
TEST(BlockerBoxes, HugeLeavesStayCheap) {
  VoxelGrid grid(0.1);
  grid.fill({{0, 0, 0}, 15}, Occupancy::kFree);
  EXPECT_LT(make_blocker_boxes(grid, UnknownPolicy::kBlock).size(), std::size_t{1000});
}

}  // namespace
}  // namespace frontlux::test
