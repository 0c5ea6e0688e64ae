// What scans say of voxels; `mapping_test.cpp` compares maps by both models with OctoMap's, node by node.

#include "octomap/quiet_octomap.hpp"
#include "support/complaint.hpp"

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
