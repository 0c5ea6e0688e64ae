// The mirror of a tree, kept in step or rebuilt; the drop-in; files.

#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/tree_state.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/caster_kind.hpp>
#include <frontlux/live_map.hpp>
#include <frontlux/octomap.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>
#include <utility>

namespace frontlux::test {
namespace {

template <class Tree>
void expect_mirrors(const VoxelGrid& grid, const Tree& tree, int reach) {
  for_each_key({key_at(-reach, -reach, -reach), key_at(reach - 1, reach - 1, reach - 1)},
               [&](const VoxelKey& key) {
                 ASSERT_EQ(grid.at(key), state_of(tree, key)) << key.x << ' ' << key.y << ' ' << key.z;
               });
}

octomap::point3d random_point(Random& random, double reach) {
  const Eigen::Vector3f at = random.point(-reach, reach).cast<float>();
  return {at.x(), at.y(), at.z()};
}

octomap::Pointcloud random_cloud(Random& random, int points) {
  octomap::Pointcloud cloud;
  for (int i = 0; i < points; ++i) cloud.push_back(random_point(random, 2));
  return cloud;
}

octomap::ColorOcTree random_color_tree(Random& random, double reach, int points) {
  octomap::ColorOcTree tree(0.2);
  for (int i = 0; i < points; ++i) tree.updateNode(random_point(random, reach), random.one_in(2));
  return tree;
}

TEST(VoxelGridOfATree, EqualsSearch) {
  for (const NamedMap& map : small_maps()) {
    SCOPED_TRACE(map.name);
    expect_mirrors(make_voxel_grid(*map.tree), *map.tree, 60);
  }
  Random random(3);
  const octomap::ColorOcTree color = random_color_tree(random, 3, 500);
  expect_mirrors(make_voxel_grid(color), color, 20);
  EXPECT_TRUE(make_voxel_grid(octomap::OcTree(0.1)) == VoxelGrid(0.1));
}

octomap::OcTree root_alone() {
  octomap::OcTree tree(0.1);
  std::stringstream one_node;  // its log-odds, and no children
  const float log_odds = 1.0F;
  one_node.write(reinterpret_cast<const char*>(&log_odds), sizeof log_odds);
  one_node.put('\0');
  tree.readData(one_node);
  return tree;
}

TEST(VoxelGridOfATree, ARootWithoutChildrenFillsTheWorld) {
  VoxelGrid world(0.1);
  world.fill({{}, 16}, Occupancy::kOccupied);
  EXPECT_TRUE(make_voxel_grid(root_alone()) == world);
}

TEST(Octree, WithoutATreeIsRefused) {
  const Octree none;
  EXPECT_REFUSED(make_voxel_grid(none));
  EXPECT_REFUSED(voxel_grid_bytes(none));
  EXPECT_REFUSED(OctreeMirror(none));
  EXPECT_REFUSED(LiveMap(none));
  EXPECT_REFUSED(OctreeRayCaster(none));
  EXPECT_REFUSED(make_octomap_ray_caster(none));
  for (const auto& [_, kind] : kCasterNames) EXPECT_REFUSED(make_ray_caster(kind, VoxelGrid(0.1), none));
  EXPECT_REFUSED(write_octree(none, "none.ot"));
}

// Insertions, deletions of what was seen, with and without the change list reset in between: always equal to
// a rebuild.
TEST(VoxelGridOfATree, TakesNoMoreMemoryThanForetold) {
  const auto compare = [](const Octree& tree) {
    const std::size_t foretold = voxel_grid_bytes(tree);
    EXPECT_LE(make_voxel_grid(tree).memory_bytes(), foretold);
    return foretold;
  };
  for (const NamedMap& map : small_maps()) {
    SCOPED_TRACE(map.name);
    compare(map.tree);
  }
  compare(std::make_shared<octomap::OcTree>(0.1));
  Random random(4);
  compare(std::make_shared<octomap::ColorOcTree>(random_color_tree(random, 3, 500)));
  const Octree sparse = make_sparse_tree(20);
  EXPECT_LT(compare(sparse), make_voxel_grid(sparse).memory_bytes() * 11 / 10);
}

TEST(OctreeMirror, FollowsChangesExactly) {
  for (const bool reset : {true, false}) {
    octomap::OcTree tree(0.1);
    Random random(5);
    tree.insertPointCloud(random_cloud(random, 50), {0, 0, 0});
    tree.enableChangeDetection(true);
    OctreeMirror mirror(tree);
    for (int round = 0; round < 30; ++round) {
      const octomap::point3d origin(static_cast<float>(random.uniform(-1, 1)), 0.05F, 0.05F);
      tree.insertPointCloud(random_cloud(random, 30), origin);
      if (round % 7 == 3) tree.prune();
      if (round % 7 == 5) tree.expand();
      EXPECT_TRUE(mirror.update());
      if (reset) tree.resetChangeDetection();
      ASSERT_TRUE(mirror.grid() == make_voxel_grid(tree)) << round;
    }
  }
}

// A voxel that flips and flips back vanishes from OctoMap's list of changes.
TEST(OctreeMirror, NoticesChangesThatUndoThemselves) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), true);
  tree.enableChangeDetection(true);
  OctreeMirror mirror(tree);
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 8; ++k) tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), i % 2 == 1);
    EXPECT_TRUE(mirror.update());
    ASSERT_TRUE(mirror.grid() == make_voxel_grid(tree)) << i;
  }
}

TEST(OctreeMirror, RebuildsWhereChangeDetectionCannotBeTrusted) {
  octomap::OcTree tree(0.1);
  Random random(6);
  tree.insertPointCloud(random_cloud(random, 50), {0, 0, 0});
  OctreeMirror mirror(tree);

  tree.insertPointCloud(random_cloud(random, 50), {0, 0, 0});  // not watched
  EXPECT_FALSE(mirror.update());
  EXPECT_TRUE(mirror.grid() == make_voxel_grid(tree));

  tree.enableChangeDetection(true);
  EXPECT_FALSE(mirror.update());  // it may have changed before it was watched
  EXPECT_TRUE(mirror.update());

  tree.setOccupancyThres(0.9);
  EXPECT_FALSE(mirror.update());
  EXPECT_TRUE(mirror.grid() == make_voxel_grid(tree));

  tree.clear();
  EXPECT_FALSE(mirror.update());
  EXPECT_TRUE(mirror.grid() == VoxelGrid(0.1));

  tree.insertPointCloud(random_cloud(random, 50), {0, 0, 0});
  EXPECT_FALSE(mirror.update());
  EXPECT_TRUE(mirror.grid() == make_voxel_grid(tree));

  tree.setNodeValue(octomap::point3d(1.5F, 1.5F, 1.5F), 3.0F);  // told nobody
  mirror.rebuild();
  EXPECT_TRUE(mirror.grid() == make_voxel_grid(tree));
}

// A temporary tree would be gone by the first refresh.
static_assert(std::is_constructible_v<OctreeRayCaster, const octomap::OcTree&>);
static_assert(!std::is_constructible_v<OctreeRayCaster, octomap::OcTree>);
static_assert(!std::is_constructible_v<OctreeRayCaster, octomap::ColorOcTree>);
static_assert(!std::is_constructible_v<OctreeMirror, octomap::OcTree>);

TEST(OctreeRayCaster, RefreshTakesANewSnapshot) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(1.05F, 0.05F, 0.05F), true);
  OctreeRayCaster fast(tree);
  const octomap::point3d origin(0.05F, 0.05F, 0.05F), east(1, 0, 0);
  octomap::point3d end;
  EXPECT_TRUE(fast.castRay(origin, east, end, true));
  EXPECT_FLOAT_EQ(end.x(), 1.05F);
  tree.updateNode(octomap::point3d(0.55F, 0.05F, 0.05F), true);
  EXPECT_TRUE(fast.castRay(origin, east, end, true));
  EXPECT_FLOAT_EQ(end.x(), 1.05F);  // still the snapshot
  fast.refresh();
  EXPECT_TRUE(fast.castRay(origin, east, end, true));
  EXPECT_FLOAT_EQ(end.x(), 0.55F);

  const std::vector<Ray> rays(2, Ray{{0.05F, 0.05F, 0.05F}, {1, 0, 0}, -1.0});
  std::vector<Hit> hits(2);
  fast.castRays(rays, hits, true);
  EXPECT_FLOAT_EQ(hits[1].end.x(), 0.55F);
}

// References to the caster last, and answer from the new map; but for another resolution there is a new one.
TEST(OctreeRayCaster, RefreshKeepsItsCaster) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(1.05F, 0.05F, 0.05F), true);
  OctreeRayCaster fast(tree);
  const RayCaster& caster = fast.caster();
  const Ray east{{0.05F, 0.05F, 0.05F}, {1, 0, 0}, -1.0};
  EXPECT_FLOAT_EQ(caster.cast(east, UnknownPolicy::kPass).end.x(), 1.05F);
  Random random(9);
  for (int i = 0; i < 5; ++i) {
    tree.insertPointCloud(random_cloud(random, 200), {0, 0, 0});
    if (i == 3) tree.clear();  // OctoMap reports none of it
    tree.updateNode(octomap::point3d(0.55F + 0.1F * static_cast<float>(i % 2), 0.05F, 0.05F), true);
    fast.refresh();
    ASSERT_EQ(&fast.caster(), &caster);
    EXPECT_EQ(caster.grid(), make_voxel_grid(tree));
    for (int ray = 0; ray < 500; ++ray) {
      const octomap::point3d origin = random_point(random, 2), direction = random_point(random, 2);
      octomap::point3d expected, end;
      ASSERT_EQ(fast.castRay(origin, direction, end, true, 5.0),
                tree.castRay(origin, direction, expected, true, 5.0));
      ASSERT_EQ(end, expected);
    }
  }
  OctreeRayCaster moved = std::move(fast);
  EXPECT_EQ(&moved.caster(), &caster);
  tree.clear();
  tree.setResolution(0.2);
  tree.updateNode(octomap::point3d(1.1F, 0.1F, 0.1F), true);
  moved.refresh();
  EXPECT_EQ(moved.caster().lattice().resolution(), 0.2);
  EXPECT_FLOAT_EQ(moved.caster().cast(east, UnknownPolicy::kPass).end.x(), 1.1F);
}

// Run it with the thread sanitizer, too (`./dev sanitize`).
TEST(OctreeRayCaster, CastsWhileItIsRefreshed) {
  octomap::OcTree tree(0.1);
  const auto wall = [&](float x, bool is_there) {
    tree.updateNode(octomap::point3d(x, 0.05F, 0.05F), is_there);
  };
  wall(1.05F, true);
  OctreeRayCaster fast(tree);
  std::atomic<bool> refreshing = true, casting = false;
  std::size_t wrong = 0, near = 0, far = 0;
  std::thread caster([&] {
    octomap::point3d end;
    while (refreshing) {
      const bool hit = fast.castRay({0.05F, 0.05F, 0.05F}, {1, 0, 0}, end, true);
      const auto is_at = [&](float x) { return hit && std::abs(end.x() - x) < 1e-4F; };
      ++(is_at(0.55F) ? near : is_at(1.05F) ? far : wrong);
      casting = true;
    }
  });
  while (!casting) std::this_thread::yield();
  for (int i = 0; i < 100; ++i) {
    for (int again = 0; again < 10; ++again) wall(0.55F, i % 2 == 0);
    fast.refresh();
    casting = false;
    while (!casting) std::this_thread::yield();  // each map is cast into
  }
  refreshing = false;
  caster.join();
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(near, 25U);
  EXPECT_GT(far, 25U);
}

TEST(OctreeRayCaster, ServesColorTrees) {
  Random random(8);
  const octomap::ColorOcTree tree = random_color_tree(random, 2, 300);
  const OctreeRayCaster fast(tree);
  for (int i = 0; i < 2000; ++i) {
    const octomap::point3d origin = random_point(random, 2), direction = random_point(random, 2);
    octomap::point3d expected, end;
    ASSERT_EQ(fast.castRay(origin, direction, end, true, 5.0),
              tree.castRay(origin, direction, expected, true, 5.0));
    ASSERT_EQ(end, expected);
  }
}

TEST(OctomapRayCaster, RefusesATreeOfAnotherResolution) {
  const auto tree = make_random_tree(4, 0.25);
  const auto caster = make_octomap_ray_caster(*tree);
  const Ray ray{{0.1F, 0.1F, 0.1F}, {1.0F, 0.2F, 0.1F}};
  const KeySegment segment{key_at(0, 0, 0), key_at(5, 1, 0)};
  static_cast<void>(caster->cast(ray, UnknownPolicy::kPass));
  tree->setResolution(1.0);
  const auto cast = [&] { static_cast<void>(caster->cast(ray, UnknownPolicy::kPass)); };
  expect_complaint(cast, {"1 m", "0.25 m", "make another one"});
  std::uint8_t visible = 0;
  PathCount count;
  EXPECT_REFUSED(caster->visible(std::span(&segment, 1), {&visible, 1}, UnknownPolicy::kPass));
  EXPECT_REFUSED(caster->count(std::span(&ray, 1), {&count, 1}, UnknownPolicy::kPass));
  tree->setResolution(0.25);
  cast();
}

class ReadOctree : public FolderTest {};
class WriteOctree : public FolderTest {};

TEST_F(WriteOctree, RefusesWhatCouldNotBeReadAgain) {
  expect_complaint([&] { write_octree(root_alone(), path("root.bt")); }, {"root.bt", ".ot"});
  expect_complaint([&] { write_octree(root_alone(), std::string("no\0map.ot", 9)); }, {"no", "byte of 0"});
  write_octree(root_alone(), path("root.ot"));
  EXPECT_TRUE(make_voxel_grid(read_octree(path("root.ot"))) == make_voxel_grid(root_alone()));
  for (const double resolution : {1e-10, 1e10})
    expect_complaint([&] { write_octree(octomap::OcTree(resolution), path("far.ot")); },
                     {"far.ot", "resolution"});
  EXPECT_EQ(std::ranges::distance(std::filesystem::directory_iterator(folder_)), 1);
}

TEST_F(ReadOctree, ReadsWhatOctomapWrote) {
  const auto tree = make_random_tree(4, 0.25);
  ASSERT_TRUE(tree->writeBinaryConst(path("tree.bt")));
  ASSERT_TRUE(tree->write(path("tree.ot")));
  for (const char* name : {"tree.bt", "tree.ot"}) {
    const Octree read = read_octree(path(name));
    ASSERT_TRUE(std::holds_alternative<std::shared_ptr<octomap::OcTree>>(read));
    EXPECT_TRUE(make_voxel_grid(*std::get<0>(read)) == make_voxel_grid(*tree)) << name;
  }
  octomap::ColorOcTree color(0.2);
  color.updateNode(octomap::point3d(0.5F, 0.5F, 0.5F), true);
  ASSERT_TRUE(color.write(path("color.ot")));
  EXPECT_TRUE(std::holds_alternative<std::shared_ptr<octomap::ColorOcTree>>(read_octree(path("color.ot"))));
  EXPECT_THROW((void)read_octree(path("missing.bt")), std::runtime_error);
}

}  // namespace
}  // namespace frontlux::test
