// A robot in space keeps its distance from what is below it, at whatever height that is.

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/robot.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;

constexpr double kResolution = 0.2;
constexpr int kHalf = 12;                   // [voxels] from the middle to the edge of the ground
constexpr int kLowest = -9, kHighest = 14;  // [voxels] of pits' floors, and of what is above the ground
const KeyBox kBounds{key_at(-kHalf, -kHalf, kLowest - 1), key_at(kHalf, kHalf, kHighest)};

// Pits, steps and pillars around the start, which is level and at 0: the first layer that is free.
std::map<std::pair<int, int>, int> random_ground(std::uint64_t seed) {
  test::Random random(seed);
  std::map<std::pair<int, int>, int> ground;
  for (int x = -kHalf; x <= kHalf; ++x)
    for (int y = -kHalf; y <= kHalf; ++y) ground[{x, y}] = 0;
  for (int i = 0; i < 16; ++i) {
    const int x = random.below(2 * kHalf) - kHalf, y = random.below(2 * kHalf) - kHalf,
              size = 4 + random.below(9), top = kLowest + random.below(17);
    for (int u = x; u < x + size; ++u)
      for (int v = y; v < y + size; ++v)
        if (ground.contains({u, v}) && std::max(std::abs(u), std::abs(v)) > 2) ground[{u, v}] = top;
  }
  return ground;
}

TEST(HeightOverGround, IsAsLowAsTheBodyAllowsEverywhere) {
  std::size_t below_the_start = 0, above_it = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto ground = random_ground(seed);
    VoxelGrid grid(kResolution);
    for (const auto& [place, top] : ground)
      for (int z = kBounds.min.z - Lattice::kOrigin; z <= kHighest; ++z)
        grid.set(key_at(place.first, place.second, z), z < top ? Occupancy::kOccupied : Occupancy::kFree);
    Robot robot = uav();
    robot.travel.extents = {0.5, 0.5, 0.3};
    robot = in_motion(robot, kResolution);
    robot.travel.floor = kLowest * kResolution;  // the lowest of the world, as in `frontlux explore`
    TravelCorridor corridor(robot.travel, grid.lattice(), kBounds);
    corridor.update({grid}, key_at(0, 0, 3));
    ASSERT_EQ(corridor.state(), CorridorState::kReady);

    const double side = robot.travel.extents.x() / 2 + robot.travel.margin,
                 down = robot.travel.extents.z() / 2 + robot.travel.margin;
    for (int x = 2 - kHalf; x <= kHalf - 2; ++x)
      for (int y = 2 - kHalf; y <= kHalf - 2; ++y) {
        // What the body, with its margin, is above [m].
        double top = -std::numeric_limits<double>::infinity();
        for (const auto& [place, layer] : ground) {
          const double off = std::max(std::abs(place.first - x), std::abs(place.second - y)) - 0.5;
          if (off * kResolution < side - 1e-9) top = std::max(top, layer * kResolution);
        }
        std::optional<double> lowest;
        for (int z = kLowest; z <= kHighest && !lowest; ++z)
          if (corridor.contains(key_at(x, y, z))) lowest = (z + 0.5) * kResolution;
        ASSERT_TRUE(lowest) << x << ", " << y;
        const double distance = *lowest - down - top;
        EXPECT_GE(distance, -1e-9) << x << ", " << y;
        EXPECT_LT(distance, kResolution - 1e-9) << x << ", " << y;
        below_the_start += *lowest < 0.0 ? 1 : 0;
        above_it += top > 0.0 ? 1 : 0;
      }
  }
  EXPECT_GT(below_the_start, 500U);
  EXPECT_GT(above_it, 500U);
}

}  // namespace
}  // namespace frontlux::planner
