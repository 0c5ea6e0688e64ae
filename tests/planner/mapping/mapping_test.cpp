#include "octomap/quiet_octomap.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/mapping.hpp>

#include <tbb/task_arena.h>

namespace frontlux::planner {
namespace {

using octomap::OcTree;
using test::Random;
using Points = std::vector<Eigen::Vector3f>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

octomap::point3d to_octomap(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }

// Two trees, node by node, inner ones included.
struct SameNodes {
  const OcTree &tree, &expected;
  std::size_t count = 0;     // of nodes compared
  std::string way{}, why{};  // to the first difference: the number of the child at each level

  bool below(const octomap::OcTreeNode& a, const octomap::OcTreeNode& b) {
    ++count;
    if (a.getLogOdds() != b.getLogOdds()) {
      why = std::to_string(a.getLogOdds()) + " and " + std::to_string(b.getLogOdds());
      return false;
    }
    for (unsigned i = 0; i < 8; ++i) {
      const bool has = tree.nodeChildExists(&a, i);
      if (has != expected.nodeChildExists(&b, i)) {
        why = (has ? "one child too many: " : "no child ") + std::to_string(i);
        return false;
      }
      if (!has) continue;
      way += static_cast<char>('0' + i);
      if (!below(*tree.getNodeChild(&a, i), *expected.getNodeChild(&b, i))) return false;
      way.pop_back();
    }
    return true;
  }
};

void expect_same_nodes(const OcTree& tree, const OcTree& expected, const std::string& where) {
  ASSERT_EQ(tree.size(), expected.size()) << where;
  ASSERT_EQ(tree.getRoot() == nullptr, expected.getRoot() == nullptr) << where;
  SameNodes same{tree, expected};
  if (tree.getRoot() != nullptr) {
    ASSERT_TRUE(same.below(*tree.getRoot(), *expected.getRoot()))
        << where << ": node " << same.way << ": " << same.why;
  }
  ASSERT_EQ(same.count, tree.size()) << where;  // the count that the tree keeps is true
}

// Where most rays go wrong if any does: ends on faces, edges and corners, along axes and diagonals, in the
// voxel of the origin, twice the same.
Points adversarial_points(Random& random, const Eigen::Vector3f& origin, double resolution, double reach,
                          int count) {
  Points points;
  const auto on_lattice = [&] {
    return static_cast<float>(std::round(random.uniform(-reach, reach) / resolution) * resolution);
  };
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3f p = origin + random.point(-reach, reach).cast<float>();
    switch (random.below(8)) {
      case 0:
        p = {on_lattice(), on_lattice(), on_lattice()};
        break;
      case 1:
        p[random.below(3)] = on_lattice();
        break;
      case 2: {
        const int axis = random.below(3);
        p = origin + Eigen::Vector3f::Unit(axis) * (p[axis] - origin[axis]);
        break;
      }
      case 3: {
        const auto d = static_cast<float>(random.uniform(-reach, reach));
        p = origin + Eigen::Vector3f(d, random.one_in(2) ? d : -d, random.one_in(2) ? d : -d);
        break;
      }
      case 4:
        p = origin + 0.01F * (p - origin);
        break;
      case 5:
        if (!points.empty()) p = random.pick(points);
        break;
    }
    points.push_back(p);
  }
  return points;
}

Eigen::Vector3f random_origin(Random& random, double resolution) {
  Eigen::Vector3d at = random.point(-2.0, 2.0);
  for (double& along : at)
    if (random.one_in(4)) along = std::round(along / resolution) * resolution;
  return at.cast<float>();
}

void insert_by_octomap(OcTree& tree, const Eigen::Vector3f& origin, const Points& points, double max_range) {
  octomap::Pointcloud cloud;
  for (const auto& p : points) cloud.push_back(to_octomap(p));
  tree.insertPointCloud(cloud, to_octomap(origin), std::isfinite(max_range) ? max_range : -1.0, false, false);
}

// As a user of OctoMap would set it.
OcTree tree_with(double resolution, const SensorModel& sensor) {
  OcTree tree(resolution);
  tree.setProbHit(sensor.hit);
  tree.setProbMiss(sensor.miss);
  tree.setClampingThresMin(sensor.least);
  tree.setClampingThresMax(sensor.most);
  return tree;
}

TEST(Mapping, PointsEqualInsertPointCloud) {
  Random random(1);
  for (const double resolution : {0.3, 0.1, 0.25, 0.07}) {
    for (const double max_range : {4.0, std::numeric_limits<double>::infinity()}) {
      const SensorModel& sensor = resolution == 0.25 ? kCautiousSensorModel : kOctomapSensorModel;
      Mapping mapping({.resolution = resolution, .sensor_model = sensor});
      OcTree oracle = tree_with(resolution, sensor);
      for (int scan = 0; scan < (test::long_mode() ? 25 : 10); ++scan) {
        const auto origin = random_origin(random, resolution);
        auto points = adversarial_points(random, origin, resolution, 6.0, 1 + random.below(600));
        points.insert(points.end(), {{kNan, 0.F, 0.F}, {1.F, kNan, kNan}});
        mapping.insert(origin, points, max_range);
        insert_by_octomap(oracle, origin, points, max_range);
        expect_same_nodes(mapping.tree(), oracle,
                          "resolution " + std::to_string(resolution) + ", scan " + std::to_string(scan));
        if (HasFatalFailure()) return;
      }
    }
  }
}

// The same scan again and again: nodes are clamped, pruned, and opened once more when something moves.
void expect_repeated_scans_equal_octomaps(const SensorModel& sensor) {
  Mapping mapping({.resolution = 0.2, .sensor_model = sensor});
  OcTree oracle = tree_with(0.2, sensor);
  const Eigen::Vector3f origin(0.3F, -0.2F, 1.1F);
  const auto wall = [&](float distance) {
    Points points;
    for (int y = -60; y <= 60; ++y)
      for (int z = -60; z <= 60; ++z)
        points.push_back(
            {origin.x() + distance, 0.05F * static_cast<float>(y), 0.05F * static_cast<float>(z)});
    return points;
  };
  for (int scan = 0; scan < 40; ++scan) {
    const auto points = wall(scan < 15 ? 4.F : scan < 20 ? 2.F : 4.1F);
    mapping.insert(origin, points);
    insert_by_octomap(oracle, origin, points, -1.0);
    expect_same_nodes(mapping.tree(), oracle, "scan " + std::to_string(scan));
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(Mapping, RepeatedScansEqualInsertPointCloud) {
  expect_repeated_scans_equal_octomaps(kOctomapSensorModel);
  expect_repeated_scans_equal_octomaps(kCautiousSensorModel);
}

// A box of rays too large for a bitmap, out to the ends of the key range.
TEST(Mapping, FarPointsEqualInsertPointCloud) {
  Random random(3);
  const double resolution = 0.01, edge = 327.68;
  Mapping mapping({.resolution = resolution});
  OcTree oracle(resolution);
  for (int scan = 0; scan < 3; ++scan) {
    const auto origin = random_origin(random, resolution);
    auto points = adversarial_points(random, origin, resolution, scan == 0 ? 30.0 : 400.0, 8);
    points.push_back({static_cast<float>(-edge), 0.F, static_cast<float>(edge - 0.005)});
    mapping.insert(origin, points, 350.0);
    insert_by_octomap(oracle, origin, points, 350.0);
    expect_same_nodes(mapping.tree(), oracle, "scan " + std::to_string(scan));
    if (HasFatalFailure()) return;
  }
}

// What a scan means, said with OctoMap's own pieces: one ray at a time, sets of keys, updates of nodes.
class ScanOracle {
 public:
  explicit ScanOracle(const MappingOptions& options) : options_(options), tree_(options.resolution) {}

  void insert(const Scan& scan) {
    octomap::KeySet misses, hits;
    octomap::KeyRay ray;
    const auto origin = to_octomap(scan.origin);
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (std::isnan(scan.ranges[i])) continue;
      const bool hit = std::isfinite(scan.ranges[i]);
      const float reach = hit ? scan.ranges[i] + static_cast<float>(options_.surface_depth)
                              : static_cast<float>(scan.max_range);
      const Eigen::Vector3f end = scan.origin + scan.directions[i] * reach;
      if (tree_.computeRayKeys(origin, to_octomap(end), ray)) misses.insert(ray.begin(), ray.end());
      octomap::OcTreeKey key;
      if (hit && tree_.coordToKeyChecked(to_octomap(end), key)) hits.insert(key);
    }
    for (const auto& key : misses)
      if (hits.count(key) == 0 && inside(key)) tree_.updateNode(key, false);
    for (const auto& key : hits)
      if (inside(key)) tree_.updateNode(key, true);
  }

  [[nodiscard]] const OcTree& tree() const { return tree_; }

 private:
  [[nodiscard]] bool inside(const octomap::OcTreeKey& key) const {
    return options_.bounds.contains({key[0], key[1], key[2]});
  }
  MappingOptions options_;
  OcTree tree_;
};

Scan random_scan(Random& random, double resolution, int rays) {
  Scan scan;
  scan.origin = random_origin(random, resolution);
  scan.max_range = 5.0;
  for (int i = 0; i < rays; ++i) {
    Eigen::Vector3f direction;
    do {
      for (int a = 0; a < 3; ++a)
        direction[a] = random.one_in(5) ? 0.F : static_cast<float>(random.uniform(-1, 1));
    } while (direction.norm() < 0.1F);
    scan.directions.push_back(direction.normalized());
    scan.ranges.push_back(random.one_in(6)    ? kInfinity
                          : random.one_in(10) ? kNan
                                              : static_cast<float>(random.uniform(0.0, 5.0)));
  }
  return scan;
}

using test::key_at;
KeyBox box(int min, int max) { return {key_at(min, min + 1, min + 3), key_at(max, max + 2, max - 1)}; }

TEST(Mapping, ScansEqualTheirDefinitionAndTheMirrorFollows) {
  Random random(4);
  for (const double depth : {0.001, 0.0}) {
    const MappingOptions options{.resolution = 0.3, .bounds = box(-12, 9), .surface_depth = depth};
    Mapping mapping(options);
    ScanOracle oracle(options);
    for (int i = 0; i < 60; ++i) {
      const Scan scan = random_scan(random, 0.3, 1 + random.below(1500));
      const VoxelGrid before = mapping.grid();
      const auto changed = mapping.insert(scan).keys;
      oracle.insert(scan);
      expect_same_nodes(mapping.tree(), oracle.tree(), "scan " + std::to_string(i));
      if (HasFatalFailure()) return;
      ASSERT_TRUE(mapping.grid() == make_voxel_grid(mapping.tree())) << "scan " << i;
      ASSERT_TRUE(std::ranges::equal(changed, changed_keys(before, mapping.grid()))) << "scan " << i;
    }
    const auto known = mapping.grid().known_bounds();
    ASSERT_TRUE(known.has_value());
    EXPECT_EQ(*known, options.bounds);  // full to the brim, and nothing spilt
  }
}

// Rays that go far beyond the bounds: from inside them they are not followed to their ends.
TEST(Mapping, RaysBeyondTheBoundsEqualTheirDefinition) {
  Random random(7);
  for (int round = 0; round < (test::long_mode() ? 40 : 15); ++round) {
    const MappingOptions options{.resolution = 0.3, .bounds = box(-12, random.below(12))};
    Mapping mapping(options);
    ScanOracle oracle(options);
    for (int i = 0; i < 5; ++i) {
      Scan scan = random_scan(random, 0.3, 1 + random.below(100));
      scan.max_range = 900.0;
      for (float& range : scan.ranges) range *= random.one_in(2) ? 150.F : 1.F;
      mapping.insert(scan);
      oracle.insert(scan);
      expect_same_nodes(mapping.tree(), oracle.tree(), "round " + std::to_string(round));
      if (HasFatalFailure()) return;
    }
  }
}

// A wall that lies on a voxel face belongs to the voxels behind it.
TEST(Mapping, SurfaceOnAVoxelFaceFallsBehindIt) {
  Mapping mapping({.resolution = 0.3});
  Scan scan;
  scan.origin = {0.1F, 0.1F, 0.1F};
  scan.max_range = 10.0;
  for (int i = -40; i <= 40; ++i) {
    const Eigen::Vector3f on_wall(3.6F, 0.05F * static_cast<float>(i) + 0.013F, 0.1F);
    const Eigen::Vector3f ray = on_wall - scan.origin;
    scan.directions.push_back(ray.normalized());
    scan.ranges.push_back(ray.norm());
  }
  mapping.insert(scan);
  const Lattice lattice(0.3);
  for (int i = -40; i <= 40; ++i) {
    const float y = 0.05F * static_cast<float>(i) + 0.013F;
    EXPECT_EQ(mapping.grid().at(*lattice.key(Eigen::Vector3f(3.7F, y, 0.1F))), Occupancy::kOccupied) << y;
    EXPECT_EQ(mapping.grid().at(*lattice.key(Eigen::Vector3f(3.5F, y, 0.1F))), Occupancy::kFree) << y;
  }
}

TEST(Mapping, SameForAnyNumberOfThreads) {
  const auto map_with = [](int threads) {
    Random random(5);
    auto mapping = std::make_unique<Mapping>(MappingOptions{.resolution = 0.15});
    std::vector<VoxelKey> changes;
    tbb::task_arena(threads).execute([&] {
      for (int i = 0; i < 5; ++i) {
        const auto keys = mapping->insert(random_scan(random, 0.15, 20000)).keys;
        changes.insert(changes.end(), keys.begin(), keys.end());
      }
    });
    return std::pair(std::move(mapping), changes);
  };
  const auto one = map_with(1), two = map_with(2);
  EXPECT_EQ(one.second, two.second);
  expect_same_nodes(one.first->tree(), two.first->tree(), "1 and 2 threads");
}

TEST(Mapping, MarksVoxelsFree) {
  const MappingOptions options{.resolution = 0.3, .bounds = box(-12, 9)};
  Random random(6);
  for (int round = 0; round < 3; ++round) {
    Mapping mapping(options);
    for (int i = 0; i < 2; ++i) mapping.insert(random_scan(random, 0.3, 200));
    const OcTree before(mapping.tree());
    const VoxelGrid grid_before = mapping.grid();
    std::vector<VoxelKey> chosen = test::keys_of(box(-3, 4));
    for (int i = 0; i < 200; ++i)  // some of them outside the bounds, some twice
      chosen.push_back(random.key_in(cube({32748, 32748, 32748}, 40)));
    const auto changed = mapping.mark_free(chosen).keys;
    EXPECT_TRUE(std::ranges::equal(changed, changed_keys(grid_before, mapping.grid())));
    EXPECT_TRUE(mapping.grid() == make_voxel_grid(mapping.tree()));
    const std::set<VoxelKey> marked(chosen.begin(), chosen.end());
    for_each_key(cube({32748, 32748, 32748}, 40), [&](const VoxelKey& key) {
      const octomap::OcTreeKey octomap_key(key.x, key.y, key.z);
      const auto* was = before.search(octomap_key);
      const auto* is = mapping.tree().search(octomap_key);
      if (options.bounds.contains(key) && marked.contains(key)) {
        ASSERT_NE(is, nullptr);
        const float miss = before.getProbMissLog();
        EXPECT_EQ(is->getLogOdds(), was == nullptr ? miss : std::min(miss, was->getLogOdds()));
      } else {
        ASSERT_EQ(was == nullptr, is == nullptr) << key.x << " " << key.y << " " << key.z;
        if (was != nullptr) {
          EXPECT_EQ(is->getLogOdds(), was->getLogOdds());
        }
      }
    });
  }
}

// From a copy of any tree on, however full, pruned or large its nodes: as if all had gone into one map.
TEST(Mapping, GoesOnFromWhatIsKnown) {
  Random random(91);
  for (int round = 0; round < 20; ++round) {
    const MappingOptions options{.resolution = 0.3, .bounds = cube({32750, 32750, 32750}, 36)};
    Mapping whole(options);
    for (int i = 0; i < 5; ++i) whole.insert(random_scan(random, 0.3, 1 + random.below(1500)));
    Mapping second(options, whole.tree());
    const OcTree before(whole.tree());
    EXPECT_TRUE(second.grid() == whole.grid());
    for (int i = 0; i < 5; ++i) {
      const Scan scan = random_scan(random, 0.3, 1 + random.below(1500));
      const auto changed = second.insert(scan).keys;
      ASSERT_TRUE(std::ranges::equal(changed, whole.insert(scan).keys)) << round << ", " << i;
      expect_same_nodes(second.tree(), whole.tree(), "round " + std::to_string(round));
      if (HasFatalFailure()) return;
      ASSERT_TRUE(second.grid() == make_voxel_grid(whole.tree())) << round << ", " << i;
    }
    EXPECT_GT(whole.tree().size(), before.size());
  }
}

TEST(Mapping, TakesFromWhatIsKnownItsNodesOnly) {
  const SensorModel other{.hit = 0.9, .miss = 0.3, .least = 0.05, .most = 0.99};
  OcTree known = tree_with(0.3, other);
  known.setOccupancyThres(0.8);
  known.enableChangeDetection(true);
  const octomap::OcTreeKey inside(32768, 32768, 32768), outside(32700, 32768, 32768);
  known.setNodeValue(inside, octomap::logodds(0.7));  // free by the tree's own threshold
  known.setNodeValue(outside, octomap::logodds(0.2));
  const MappingOptions options{.resolution = 0.3, .bounds = cube({32760, 32760, 32760}, 16)};
  Mapping mapping(options, known);
  EXPECT_EQ(mapping.grid().at({32768, 32768, 32768}), Occupancy::kOccupied);
  EXPECT_EQ(mapping.grid().at({32700, 32768, 32768}), Occupancy::kFree);
  EXPECT_EQ(mapping.grid().count()[1] + mapping.grid().count()[2], 2U);
  EXPECT_EQ(mapping.tree().getProbHit(), OcTree(0.3).getProbHit());
  EXPECT_EQ(mapping.tree().getClampingThresMax(), OcTree(0.3).getClampingThresMax());
  EXPECT_FALSE(mapping.tree().isChangeDetectionEnabled());
  known.clear();
  EXPECT_EQ(mapping.tree().search(outside)->getLogOdds(), octomap::logodds(0.2));
  test::expect_complaint([&] { Mapping({.resolution = 0.2}, known); }, {"0.3", "0.2"});
  EXPECT_REFUSED(Mapping({.resolution = 0.3, .surface_depth = -0.1}, known));
  EXPECT_EQ(Mapping({.resolution = 0.3}, OcTree(0.3)).grid().count()[1], 0U);
}

class MappingFiles : public test::FolderTest {};

TEST_F(MappingFiles, HoldWhatTheMapDoes) {
  Mapping mapping({.resolution = 0.1 + 1e-9});
  Random random(7);
  mapping.write(path("empty.bt"));
  for (int i = 0; i < 4; ++i) mapping.insert(random_scan(random, 0.1, 500));
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  mapping.write(path("map.ot"));
  mapping.write(path("map.bt"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");

  const auto in_file = [&](const char* name) {
    return std::get<std::shared_ptr<OcTree>>(read_octree(path(name)));
  };
  const auto full = in_file("map.ot");
  EXPECT_EQ(full->getResolution(), 0.1 + 1e-9);
  expect_same_nodes(*full, mapping.tree(), "map.ot");
  EXPECT_TRUE(make_voxel_grid(*in_file("map.bt")) == mapping.grid());
  OcTree by_octomap(0.5);
  ASSERT_TRUE(by_octomap.readBinary(path("map.bt")));
  EXPECT_TRUE(make_voxel_grid(by_octomap) == mapping.grid());
  EXPECT_EQ(in_file("empty.bt")->size(), 0U);

  EXPECT_REFUSED(mapping.write(path("map.pcd")));
  EXPECT_THROW(mapping.write(path("no/map.bt")), std::runtime_error);
  std::filesystem::create_directory(path("folder.bt"));
  EXPECT_THROW(mapping.write(path("folder.bt")), std::runtime_error);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"empty.bt", "folder.bt", "map.bt", "map.ot"}));
}

TEST(Mapping, RefusesWrongCalls) {
  EXPECT_REFUSED(Mapping({.resolution = 0.0}));
  EXPECT_REFUSED(Mapping({.resolution = std::nan("")}));
  EXPECT_REFUSED(Mapping({.bounds = {{2, 0, 0}, {1, 9, 9}}}));
  EXPECT_REFUSED(Mapping({.surface_depth = -0.1}));
  Mapping mapping({.resolution = 0.3});
  const Points points = {{1.F, 0.F, 0.F}};
  EXPECT_REFUSED(mapping.insert({kNan, 0.F, 0.F}, points));
  EXPECT_REFUSED(mapping.insert({1e5F, 0.F, 0.F}, points));
  EXPECT_REFUSED(mapping.insert({0.F, 0.F, 0.F}, points, 0.0));
  EXPECT_REFUSED(mapping.insert({0.F, 0.F, 0.F}, points, std::nan("")));
  EXPECT_REFUSED(mapping.insert(Scan{{0.F, 0.F, 0.F}, 5.0, {}, {1.F}}));
  EXPECT_EQ(mapping.tree().size(), 0U);
}

// Distances that are 0 in float between voxels that differ: OctoMap's own loop does not end here.
TEST(Mapping, EndsWhereDistancesUnderflow) {
  Mapping mapping({.resolution = 0.3});
  const Points points = {{-1e-30F, -1e-30F, -1e-30F}};
  mapping.insert({1e-30F, 1e-30F, 1e-30F}, points);
  EXPECT_EQ(mapping.grid().at({32768, 32768, 32768}), Occupancy::kFree);
  EXPECT_EQ(mapping.grid().at({32767, 32767, 32767}), Occupancy::kOccupied);
  EXPECT_EQ(mapping.grid().count()[1] + mapping.grid().count()[2], 2U);
}

TEST(VoxelsOf, BoxesOnTheLatticeAndOff) {
  const auto voxels = [](const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
    return voxels_of(Lattice(0.3), {min, max});
  };
  EXPECT_EQ(voxels({0, -0.6, -0.05}, {12.0, 3.6, 2.95}), (KeyBox{key_at(0, -2, -1), key_at(39, 11, 9)}));
  EXPECT_EQ(voxels({-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}), kAllVoxels);
  EXPECT_REFUSED(voxels({0, 0, 0}, {1, 0, 1}));
  EXPECT_REFUSED(voxels({0, 0, std::nan("")}, {1, 1, 1}));
  EXPECT_REFUSED(voxels({1e5, 1e5, 1e5}, {2e5, 2e5, 2e5}));
}

}  // namespace
}  // namespace frontlux::planner
