// What scans say of voxels; `mapping_test.cpp` compares maps by both models with OctoMap's, node by node.

#include "octomap/quiet_octomap.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/planner/mapping.hpp>

#include <cmath>

namespace frontlux::planner {
namespace {

// How many scans have to pass a voxel that rays have passed so often, and then one has hit, until it is free.
int misses_to_clear(const SensorModel& sensor, int misses_before) {
  Mapping mapping({.resolution = 0.3, .sensor_model = sensor});
  const Eigen::Vector3f origin(0.15F, 0.15F, 0.15F);
  const auto state = [&] {
    return mapping.grid().at(mapping.grid().lattice().key(Eigen::Vector3f(3.15F, 0.15F, 0.15F)).value());
  };
  const std::vector<Eigen::Vector3f> hit{{3.15F, 0.15F, 0.15F}}, pass{{6.15F, 0.15F, 0.15F}};
  for (int i = 0; i < misses_before; ++i) mapping.insert(origin, pass);
  mapping.insert(origin, hit);
  int misses = 0;
  for (; state() != Occupancy::kFree && misses < 100; ++misses) mapping.insert(origin, pass);
  return misses;
}

TEST(SensorModel, SaysHowManyMissesAHitOutweighs) {
  EXPECT_EQ(misses_to_clear(kOctomapSensorModel, 0), 3);
  EXPECT_EQ(misses_to_clear(kOctomapSensorModel, 100), 0);
  EXPECT_EQ(misses_to_clear(kCautiousSensorModel, 0), 6);
  EXPECT_EQ(misses_to_clear(kCautiousSensorModel, 100), 1);
}

// Of random scans from one place: for each ray the voxel in which it ends, if OctoMap's tree has it as free.
TEST(SensorModel, LeavesHitsThatWereOverruled) {
  test::Random random(3);
  Mapping mapping(
      {.resolution = 0.3, .bounds = {make_key(32760, 32760, 32764), make_key(32776, 32776, 32772)}});
  const Eigen::Vector3f origin(0.15F, 0.15F, 0.15F);
  std::size_t all = 0;
  for (int scan = 0; scan < 60; ++scan) {
    std::vector<Eigen::Vector3f> points;
    std::vector<VoxelKey> expected;
    for (int i = 0; i < 40; ++i) points.push_back(random.point(-3.0, 3.0).cast<float>());
    mapping.insert(origin, points, 2.8);
    for (const Eigen::Vector3f& point : points) {
      const VoxelKey key = mapping.grid().lattice().key(point).value();
      const auto* node = mapping.tree().search(octomap::OcTreeKey(key.x, key.y, key.z));
      if ((point - origin).norm() <= 2.8F && mapping.bounds().contains(key) && node != nullptr &&
          !mapping.tree().isNodeOccupied(node))
        expected.push_back(key);
    }
    std::ranges::sort(expected);
    EXPECT_TRUE(std::ranges::equal(mapping.overruled_hits(), expected));
    all += expected.size();
  }
  EXPECT_GT(all, 100U);
}

TEST(SensorModel, IsOctomapsByDefault) {
  const octomap::OcTree theirs(0.3);
  const Mapping ours({.resolution = 0.3});
  EXPECT_EQ(ours.tree().getProbHitLog(), theirs.getProbHitLog());
  EXPECT_EQ(ours.tree().getProbMissLog(), theirs.getProbMissLog());
  EXPECT_EQ(ours.tree().getClampingThresMinLog(), theirs.getClampingThresMinLog());
  EXPECT_EQ(ours.tree().getClampingThresMaxLog(), theirs.getClampingThresMaxLog());
}

TEST(SensorModel, RefusesWhatMakesNoSense) {
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.5, .miss = 0.4, .least = 0.1, .most = 0.9}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = 0.4, .least = 0.0, .most = 0.9}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = std::nan(""), .least = 0.1, .most = 0.9}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = 0.4, .least = 0.1, .most = 1.0}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = 0.4, .least = 0.4, .most = 0.9}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = 0.5, .least = 0.1, .most = 0.9}}));
  EXPECT_REFUSED(Mapping({.sensor_model = {.hit = 0.7, .miss = 0.4, .least = 0.1, .most = 0.7}}));
}

}  // namespace
}  // namespace frontlux::planner
