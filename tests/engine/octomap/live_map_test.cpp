// After every update the grid, the caster, the keys and what they update are as if made anew.

#include "support/floating_point_control.hpp"
#include "support/maps.hpp"
#include "support/plain_frontiers.hpp"
#include "support/random.hpp"
#include "support/tree_state.hpp"
#include "support/views.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/live_map.hpp>
#include <frontlux/view_quality.hpp>

#include <cfenv>

namespace frontlux::test {
namespace {

const KeyBox kBounds{key_at(-14, -14, -14), key_at(13, 13, 13)};
const FieldOfView kView{FieldOfView::Shape::kSpinning, 0.0, 1.2, 2.0};

std::vector<VoxelKey> different(const VoxelGrid& a, const VoxelGrid& b, const KeyBox& box) {
  std::vector<VoxelKey> keys = keys_of(box);
  std::erase_if(keys, [&](const VoxelKey& key) { return a.at(key) == b.at(key); });
  std::ranges::sort(keys);
  return keys;
}

octomap::Pointcloud random_cloud(Random& random) {
  octomap::Pointcloud cloud;
  for (int i = 0; i < 60; ++i) cloud.push_back(to_octomap(random.point(-2.0, 2.0).cast<float>()));
  return cloud;
}

void expect_same_answers(const RayCaster& caster, const VoxelGrid& grid, Random& random) {
  const auto fresh = make_grid_ray_caster(grid);
  for (int i = 0; i < 200; ++i) {
    const Ray ray{random.point(-2.0, 2.0).cast<float>(), random.point(-1.0, 1.0).cast<float>(), -1.0};
    for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass}) {
      const Hit hit = caster.cast(ray, unknown), expected = fresh->cast(ray, unknown);
      ASSERT_EQ(hit.stop, expected.stop);
      ASSERT_EQ(hit.key, expected.key);
    }
  }
}

template <class Tree>
void expect_in_step(std::uint64_t seed) {
  Random random(seed);
  Tree tree(0.2);
  tree.insertPointCloud(random_cloud(random), {0.1F, 0.1F, 0.1F});
  LiveMap map(tree);
  FrontierSet frontiers(map.grid(), kBounds);
  const std::vector<VoxelKey> viewpoints = keys_of({key_at(-3, -3, -1), key_at(3, 3, 1)});
  ViewQualityImage image(map.grid().lattice(), kView, {});
  image.render(map.caster(), viewpoints, frontiers.keys());
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const VoxelGrid before = map.grid();
    if (round == 5) tree.clear();
    if (round != 7) tree.insertPointCloud(random_cloud(random), {0.1F, 0.1F, 0.1F}, round == 8 ? 1.0 : -1.0);
    if (round == 9) tree.setNodeValue(0.5F, 0.5F, 0.5F, -2.0F);  // not reported
    const MapChange change = round == 9 ? map.rebuild() : map.update();

    ASSERT_TRUE(map.grid() == make_voxel_grid(tree));
    EXPECT_EQ(&change.grid, &map.grid());
    EXPECT_TRUE(std::ranges::equal(change.keys, different(before, map.grid(), kBounds)));
    EXPECT_EQ(change.keys.empty(), round == 7);
    expect_same_answers(map.caster(), map.grid(), random);
    frontiers.update(change);
    EXPECT_TRUE(std::ranges::equal(frontiers.keys(), frontiers_by_hand(map.grid(), kBounds)));
    image.update(map.caster(), viewpoints, frontiers.keys(), change);
    const ViewQualityImage anew =
        render_view_quality(map.caster(), map.grid().lattice(), viewpoints, frontiers.keys(), kView);
    EXPECT_TRUE(std::ranges::equal(image.values(), anew.values()));
  }
}

TEST(LiveMap, IsInStepAfterEveryUpdate) {
  expect_in_step<octomap::OcTree>(1);
  expect_in_step<octomap::ColorOcTree>(2);
}

TEST(LiveMap, SharesTheTreeOfAFile) {
  Octree tree = read_octree(FRONTLUX_DATA_DIR "/maps/room_0.2m.ot");
  const auto room = std::get<0>(tree);
  LiveMap map(std::move(tree));
  room->insertRay({0.1F, 0.1F, 1.0F}, {0.1F, 0.1F, 1.9F});
  LiveMap moved(std::move(map));
  moved.update();
  EXPECT_TRUE(moved.grid() == make_voxel_grid(*room));
}

TEST(LiveMap, LeavesTheTreesChangeDetectionAsItWas) {
  for (const bool was_on : {false, true}) {
    octomap::OcTree tree(0.2);
    tree.enableChangeDetection(was_on);
    {
      LiveMap map(tree);
      tree.updateNode(octomap::point3d(0.1F, 0.1F, 0.1F), true);
      EXPECT_EQ(map.update().keys.size(), 1U);
      LiveMap moved(std::move(map));
      tree.updateNode(octomap::point3d(0.5F, 0.1F, 0.1F), true);
      EXPECT_EQ(moved.update().keys.size(), 1U);
    }
    EXPECT_EQ(tree.isChangeDetectionEnabled(), was_on);
    EXPECT_EQ(tree.numChangesDetected(), 0U);
    tree.updateNode(octomap::point3d(0.9F, 0.1F, 0.1F), true);
    EXPECT_EQ(tree.numChangesDetected(), was_on ? 1U : 0U);
  }
}

TEST(LiveMap, TellsOfAChangeAfterAnUpdateThatFailed) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), false);
  LiveMap map(tree);
  tree.updateNode(octomap::point3d(5.05F, 0.05F, 0.05F), false);
  tree.setResolution(0.2);
  EXPECT_THROW(map.update(), std::invalid_argument);
  EXPECT_THROW(map.rebuild(), std::invalid_argument);
  EXPECT_TRUE(map.caster().grid() == map.grid());
  tree.setResolution(0.1);
  EXPECT_EQ(map.update().keys.size(), 1U);
  EXPECT_TRUE(map.update().keys.empty());
}

TEST(LiveMap, IsUpToDateAfterAChangeThatIsTooMuchToTell) {
  octomap::OcTree tree(0.1);
  LiveMap map(tree);
  std::stringstream lone_root(full_record(1.0F, 0));
  tree.readData(lone_root);
  EXPECT_THROW(map.rebuild(), std::length_error);
  EXPECT_TRUE(map.grid() == make_voxel_grid(tree));
  EXPECT_EQ(map.grid().at({}), Occupancy::kOccupied);
  EXPECT_TRUE(map.caster().grid() == map.grid());
  EXPECT_TRUE(map.caster().cast({{1, 2, 3}, {1, 0, 0}}, UnknownPolicy::kPass).occupied());
  const VoxelKey freed{1, 2, 3};
  tree.setNodeValue(tree_key(freed), -2.0F);
  EXPECT_TRUE(std::ranges::equal(map.rebuild().keys, std::array{freed}));
  EXPECT_EQ(map.caster().grid()->at(freed), Occupancy::kFree);
  EXPECT_TRUE(map.update().keys.empty());
}

TEST(LiveMap, IsTheSameWhateverFloatingPointModeItIsMadeIn) {
  octomap::OcTree tree(0.1);
  for (std::uint16_t x = 32768; x < 32798; ++x)
    tree.updateNode(octomap::OcTreeKey(x, 32768, 32768), x == 32777);
  // What each of them leaves the caller's mode at.
  std::vector<std::uint64_t> modes;
  std::fesetround(FE_TOWARDZERO);
  modes.push_back(floating_point_control());
  LiveMap made(tree), made_anew(tree);
  modes.push_back(floating_point_control());
  made_anew.rebuild();
  modes.push_back(floating_point_control());
  tree.updateNode(octomap::OcTreeKey(32768, 32778, 32768), false);  // beside the ray below
  const std::size_t changed = made.update().keys.size();
  modes.push_back(floating_point_control());
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(changed, 1U);
  EXPECT_NE(modes[0], floating_point_control()) << "it is another mode";
  EXPECT_EQ(modes, std::vector(4, modes[0])) << "the mode is the caller's";
  octomap::point3d end;
  const bool hits = tree.castRay({1.0F, 0.05F, 0.05F}, {1, 0, 0}, end, false, 5.0);
  for (const LiveMap* map : {&made, &made_anew}) {
    // On a face of the voxel that is occupied.
    const Ray ray{{1.0F, 0.05F, 0.05F}, {1, 0, 0}, 5.0};
    std::vector<Hit> batch(20);
    map->caster().cast(std::vector<Ray>(20, ray), batch, UnknownPolicy::kBlock);
    batch.push_back(map->caster().cast(ray, UnknownPolicy::kBlock));
    for (const Hit& hit : batch) {
      EXPECT_EQ(hit.stop == RayStop::kOccupied, hits);
      EXPECT_EQ(hit.end, Eigen::Vector3f(end.x(), end.y(), end.z()));
    }
  }
}

TEST(ChangedKeys, AreRefusedIfThereAreTooMany) {
  const VoxelGrid unknown(0.1);
  VoxelGrid filled(0.1);
  filled.fill({{}, 7}, Occupancy::kFree);
  filled.set({3, 4, 200}, Occupancy::kOccupied);
  EXPECT_EQ(changed_keys(unknown, filled), different(unknown, filled, cube({}, 256)));
  filled.fill({{}, 16}, Occupancy::kFree);
  EXPECT_THROW(static_cast<void>(changed_keys(unknown, filled)), std::length_error);
}

}  // namespace
}  // namespace frontlux::test
