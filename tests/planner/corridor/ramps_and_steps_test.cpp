// Which ramps and steps a robot on the ground takes, against counts of voxels and levels, wherever the
// lattice lies: the numbers in docs/robots.md, "On the ground".

#include "planner/corridor/robots_page.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRise = 0.9;                              // [m] of a ramp
constexpr std::array kHeights = {0.0, 0.25, 0.5, 0.75};    // of the floor above a layer of voxels, in voxels
constexpr std::array kPlaces = {0.0, 0.2, 0.4, 0.6, 0.8};  // of a ramp's foot in its voxel

// Ground that rises along one axis, seen from above: what a surface passes is occupied, and one on a face
// belongs to the voxel below.
VoxelGrid rising(double resolution, const KeyBox& bounds, std::size_t axis,
                 const std::function<double(double)>& height) {
  constexpr double kRounding = 1e-9;
  VoxelGrid grid(resolution);
  for_each_key(bounds, [&](const VoxelKey& key) {
    const double along = ((axis == 0 ? key.x : key.y) - Lattice::kOrigin) * resolution,
                 bottom = (key.z - Lattice::kOrigin) * resolution;
    if (height(along + resolution) <= bottom + kRounding)
      grid.set(key, Occupancy::kFree);
    else if (height(along) <= bottom + resolution + kRounding)
      grid.set(key, Occupancy::kOccupied);
  });
  return grid;
}

// Whether it gets from -0.8 m to where it has the level floor beyond `end` under all of its body.
bool gets_up(const TravelOptions& travel, double resolution, std::size_t axis, double end,
             const std::function<double(double)>& height) {
  const auto voxels = [&](double length) { return static_cast<int>(std::ceil(length / resolution)); };
  const int behind = -voxels(1.4), ahead = voxels(end + 1.4), beside = voxels(0.45),
            top = voxels(height(end) + 0.9);
  const KeyBox bounds = axis == 0 ? KeyBox{key_at(behind, -beside, -1), key_at(ahead, beside, top)}
                                  : KeyBox{key_at(-beside, behind, -1), key_at(beside, ahead, top)};
  const VoxelGrid grid = rising(resolution, bounds, axis, height);
  const auto cell = [&](double along) {
    const double floor = std::ceil(height(along) / resolution - 1e-9) * resolution;
    Eigen::Vector3d at(resolution / 2, resolution / 2, floor + travel.sensor_height);
    at[static_cast<Eigen::Index>(axis)] = along;
    return grid.lattice().key(at).value();
  };
  TravelCorridor corridor(travel, grid.lattice(), bounds);
  corridor.update({grid}, cell(-0.8));
  EXPECT_EQ(corridor.state(), CorridorState::kReady) << describe(corridor.state());
  return corridor.contains(cell(end + 0.7));
}

// In how many of 20 places of the lattice it gets up a ramp.
int places_at(const TravelOptions& travel, double resolution, std::size_t axis, double degrees) {
  int count = 0;
  const double slope = std::tan(degrees * kDegree);
  for (const double up : kHeights)
    for (const double place : kPlaces) {
      const double foot = place * resolution, floor = up * resolution;
      const auto height = [&](double x) { return floor + std::clamp((x - foot) * slope, 0.0, kRise); };
      count += gets_up(travel, resolution, axis, foot + kRise / slope, height) ? 1 : 0;
    }
  return count;
}
constexpr int kAllPlaces = kHeights.size() * kPlaces.size();

// As in docs/robots.md.
TravelOptions rover() {
  TravelOptions travel;
  travel.motion = Motion::kGround;
  travel.extents = {0.67, 0.5, 0.5};
  travel.margin = 0.05;
  travel.ground_extents = Eigen::Vector2d(0.5, 0.4);
  return travel;
}

// Voxels beside the middle one, of the smallest odd number that covers a length.
int beside_middle(double length, double resolution) {
  int voxels = 0;
  while ((2 * voxels + 1) * resolution < length - 1e-9) ++voxels;
  return voxels;
}

// The steepest ramp by the levels of its voxels. The robot may be higher over the ground by `lift` levels,
// and its box lets the ground rise by `little` before its end. So before the end it rises by no more than
// both together. When it gets a level higher, the ground behind may lie no more than `little` deeper than it.
double steepest(const TravelOptions& travel, double resolution, Eigen::Index axis) {
  const double half = std::max(travel.extents.x(), travel.extents.y()) / 2,
               rise = std::max(travel.step, std::tan(travel.slope) * half);
  const int little = static_cast<int>(std::ceil(rise / resolution - 1e-9)),
            lift = static_cast<int>(std::floor(travel.step / resolution + 1e-9)) - 1,
            box = beside_middle(travel.extents[axis] + 2 * travel.margin, resolution),
            ground = beside_middle((*travel.ground_extents)[axis], resolution);
  const double slope = std::min(static_cast<double>(little + lift) / box, 2.0 * little / (box + ground + 1));
  return std::atan(slope) / kDegree;
}

TEST(RampsAndSteps, RampsAreTakenAsThePageSays) {
  // [degrees] by voxels and axis: the steepest ramp that it takes, and the least that it leaves.
  struct Limits {
    double resolution;
    std::array<std::array<int, 2>, 2> degrees;
    const char* row;
  };
  for (const Limits& limits : {Limits{0.15, {{{18, 20}, {26, 29}}}, "| 0.15 m | 18, 20 | 26, 29 |"},
                               Limits{0.1, {{{26, 28}, {33, 35}}}, "| 0.1 m | 26, 28 | 33, 35 |"},
                               Limits{0.05, {{{23, 24}, {28, 29}}}, "| 0.05 m | 23, 24 | 28, 29 |"}}) {
    test::expect_row_in_robots_page(limits.row);
    for (const std::size_t axis : {0U, 1U}) {
      SCOPED_TRACE(testing::Message() << limits.resolution << " m along axis " << axis);
      const auto [taken, left] = limits.degrees.at(axis);
      const double limit = steepest(rover(), limits.resolution, static_cast<Eigen::Index>(axis));
      EXPECT_EQ(taken, std::floor(limit));
      for (const int degrees : {taken - 4, taken})
        EXPECT_EQ(places_at(rover(), limits.resolution, axis, degrees), kAllPlaces) << degrees;
      for (const int degrees : {left, left + 6})
        EXPECT_EQ(places_at(rover(), limits.resolution, axis, degrees), 0) << degrees;
    }
  }
}

// A long robot that climbs by its slope and not by its step.
TEST(RampsAndSteps, RampsOfASteepLimit) {
  TravelOptions travel = rover();
  travel.extents = {1.0, 0.6, 0.5};
  travel.ground_extents = Eigen::Vector2d(0.8, 0.5);
  travel.step = 0.1;
  travel.slope = 30.0 * kDegree;
  const double limit = steepest(travel, 0.1, 0);
  EXPECT_NEAR(limit, 31.0, 0.1);
  EXPECT_EQ(places_at(travel, 0.1, 0, limit - 0.5), kAllPlaces);
  EXPECT_EQ(places_at(travel, 0.1, 0, limit + 1.5), 0);
}

// By the levels of voxels between the floors: wherever the lattice lies those that are as high as whole
// voxels in a step, and never one that is higher by a voxel.
TEST(RampsAndSteps, StepsAreTakenUpToWholeVoxels) {
  std::size_t taken = 0, left = 0, by_place = 0;
  for (const double resolution : {0.15, 0.1, 0.05}) {
    const int whole = static_cast<int>(std::floor(rover().step / resolution + 1e-9));
    for (int quarters = 1; quarters <= 4 * (whole + 2); ++quarters) {
      int ups = 0;
      for (const double part : kHeights) {
        const double floor = part * resolution, top = floor + quarters * resolution / 4,
                     foot = 0.35 * resolution;
        const auto level = [&](double height) { return std::ceil(height / resolution - 1e-9); };
        const bool expected = level(top) - level(floor) <= whole;
        const bool up =
            gets_up(rover(), resolution, 0, foot, [&](double x) { return x < foot ? floor : top; });
        EXPECT_EQ(up, expected) << quarters << " quarters of " << resolution << " m, floor at " << part;
        ups += up ? 1 : 0;
      }
      const bool all = ups == static_cast<int>(kHeights.size());
      EXPECT_EQ(all, quarters <= 4 * whole) << quarters;
      EXPECT_EQ(ups == 0, quarters >= 4 * (whole + 1)) << quarters;
      (all ? taken : ups == 0 ? left : by_place) += 1;
    }
  }
  EXPECT_EQ(taken, 4U * (1 + 1 + 3));
  EXPECT_EQ(by_place, 3U * 3);
  EXPECT_EQ(left, 3U * 5);
}

}  // namespace
}  // namespace frontlux::planner
