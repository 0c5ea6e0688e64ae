// Between OctoMap's types and ours; casters of what read_octree returns.

#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/caster_kind.hpp>

#include <typeinfo>

namespace frontlux::test {
namespace {

TEST(OctomapConversions, AreExactInBothDirections) {
  Random random(1);
  const octomap::OcTree tree(0.1);
  const Lattice lattice(0.1);
  for (int i = 0; i < 1000; ++i) {
    const VoxelKey key = random.key_in(kAllVoxels);
    EXPECT_EQ(from_octomap(to_octomap(key)), key);
    EXPECT_EQ(from_octomap(tree.keyToCoord(to_octomap(key))), lattice.center(key));
    const Eigen::Vector3f point = random.point(-3000.0, 3000.0).cast<float>();
    EXPECT_EQ(from_octomap(to_octomap(point)), point);
    EXPECT_EQ(from_octomap(tree.coordToKey(to_octomap(point))), lattice.key(point));
  }
}

TEST(OctomapConversions, ACloudHoldsTheCentresThatCastRayReturns) {
  const auto tree = std::get<0>(read_octree(FRONTLUX_DATA_DIR "/maps/room_0.2m.ot"));
  const OctreeRayCaster fast(*tree);
  Random random(2);
  std::vector<Ray> rays(500);
  octomap::Pointcloud expected;
  for (Ray& ray : rays) {
    ray = {{2.0F, 2.0F, 1.0F}, random.point(-1.0, 1.0).cast<float>(), 1.5};
    octomap::point3d end;
    if (tree->castRay(to_octomap(ray.origin), to_octomap(ray.direction), end, true, 1.5))
      expected.push_back(end);
  }
  std::vector<Hit> hits(rays.size());
  fast.castRays(rays, hits, true);
  const octomap::Pointcloud cloud = to_pointcloud(hits);
  EXPECT_GT(cloud.size(), 10U);
  EXPECT_LT(cloud.size(), rays.size());
  EXPECT_TRUE(std::ranges::equal(cloud, expected));
}

// They answer alike: only their types tell them apart.
TEST(CastersOfAnOctree, AreOfTheKindThatIsAskedFor) {
  const Octree file = read_octree(FRONTLUX_DATA_DIR "/maps/room_0.2m.ot");
  const octomap::OcTree& tree = *std::get<0>(file);
  const VoxelGrid grid = make_voxel_grid(tree);
  std::map<CasterKind, std::unique_ptr<RayCaster>> expected;
  expected[CasterKind::kFast] = make_ray_caster(grid);
  expected[CasterKind::kEmbree] = make_embree_ray_caster(grid);
  expected[CasterKind::kGrid] = make_grid_ray_caster(grid);
  expected[CasterKind::kOctomap] = make_octomap_ray_caster(tree);
  std::set<std::string> types;
  for (const auto& [name, kind] : kCasterNames) {
    const RayCaster& caster = *expected.at(kind);
    types.insert(typeid(caster).name());
    for (const auto& made : {make_ray_caster(kind, grid, tree), make_ray_caster(kind, grid, file)}) {
      const RayCaster& now = *made;
      EXPECT_EQ(typeid(now), typeid(caster)) << name;
      EXPECT_EQ(now.grid().has_value(), kind != CasterKind::kOctomap) << name;
    }
  }
  EXPECT_EQ(types.size(), kCasterNames.size());
}

TEST(CastersOfAnOctree, AnswerAsThoseOfItsTree) {
  for (const char* name : {"/maps/room_0.2m.ot", "/maps/color_room_0.2m.ot"}) {
    Octree tree = read_octree(std::string(FRONTLUX_DATA_DIR) + name);
    const VoxelGrid grid = make_voxel_grid(tree);
    const Ray ray{{0.1F, 0.1F, 1.0F}, {1.0F, 0.2F, 0.1F}};
    const Hit expected = make_grid_ray_caster(grid)->cast(ray, UnknownPolicy::kPass);
    EXPECT_TRUE(expected.occupied());
    for (const auto& [_, kind] : kCasterNames)
      EXPECT_EQ(make_ray_caster(kind, grid, tree)->cast(ray, UnknownPolicy::kPass).end, expected.end);
    EXPECT_EQ(make_octomap_ray_caster(tree)->cast(ray, UnknownPolicy::kPass).end, expected.end);

    // These share the tree.
    OctreeRayCaster fast(tree);
    OctreeMirror mirror(tree);
    tree = {};
    octomap::point3d end;
    EXPECT_TRUE(fast.castRay(to_octomap(ray.origin), to_octomap(ray.direction), end, true));
    EXPECT_EQ(from_octomap(end), expected.end);
    fast.refresh();
    mirror.rebuild();
    EXPECT_TRUE(mirror.grid() == grid);
  }
}

}  // namespace
}  // namespace frontlux::test
