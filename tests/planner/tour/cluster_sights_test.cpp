// A room with a tunnel that is too narrow for the robot, and clusters of frontiers in and beyond it.
#include "tour/cluster_sights.hpp"

#include "support/random.hpp"
#include "support/test.hpp"
#include "support/voxel_keys.hpp"

#include <algorithm>
#include <atomic>
#include <functional>

namespace frontlux::planner::detail {
namespace {

constexpr double kResolution = 0.2;
constexpr KeyBox kBounds{{32768, 32768, 32768}, {32808, 32787, 32777}};

VoxelKey at(int x, int y, int z) { return make_key(32768 + x, 32768 + y, 32768 + z); }

TravelOptions flying_cube() {
  TravelOptions options;
  options.extents = {0.6, 0.6, 0.6};
  options.min_height = -100.0;
  return options;
}

FrontierCluster cluster_of(std::uint32_t id, const VoxelKey& key) {
  FrontierCluster cluster;
  cluster.id = ClusterId{id};
  cluster.revision = 1;
  cluster.keys = {key};
  cluster.box = {key, key};
  return cluster;
}

struct Scene {
  VoxelGrid grid{kResolution};
  TravelCorridor corridor{flying_cube(), Lattice(kResolution), kBounds};
  TravelGraph graph{Lattice(kResolution), kBounds, 5, 2};
  FieldOfView view{FieldOfView::Shape::kPyramid, 1.57, 1.2, 6.0};
  ViewRegion region{view, kResolution};
  std::unique_ptr<RayCaster> caster;
  ClusterSights sights;
  bool is_shut_in = false, is_in_the_way = false;  // whatever the map says; another robot
  const std::function<bool(const VoxelKey&)> connects = [this](const VoxelKey& cell) {
    ++asked_if_connected;
    return !is_shut_in && corridor.contains(cell);
  };
  std::atomic<int> asked_if_connected = 0;
  std::atomic<int> asked = 0;  // whether the robot gets to a cell
  const std::function<bool(const VoxelKey&)> reaches = [this](const VoxelKey& cell) {
    ++asked;
    return connects(cell) && !is_in_the_way;
  };

  Scene() {
    test::fill(grid, {at(0, 0, 0), at(14, 14, 6)}, Occupancy::kFree);
    test::fill(grid, {at(15, 7, 2), at(34, 7, 2)}, Occupancy::kFree);
    corridor.update({grid}, at(7, 7, 3));
    graph.update(corridor, {{kBounds}});
    caster = make_grid_ray_caster(grid);
  }

  void look(const std::vector<FrontierCluster>& clusters, std::span<const KeyBox> changes) {
    sights.update({{*caster, grid, graph, view, region}, clusters, changes, reaches, connects});
  }
  void look_at_faces(const std::vector<FrontierCluster>& clusters) {
    sights.look_at_faces({{*caster, grid, graph, view, region}, clusters, {}, reaches, connects});
  }
};

TEST(ClusterSights, FindsClustersThatNoUsualPlaceShows) {
  Scene scene;
  const FrontierCluster end = cluster_of(3, at(35, 7, 2));  // of the tunnel, farther than half the range
  scene.look({end}, {{kBounds}});
  ASSERT_FALSE(scene.sights.viewpoints(ClusterId{3}).empty());
  for (const ClusterViewpoint& viewpoint : scene.sights.viewpoints(ClusterId{3})) {
    EXPECT_EQ(viewpoint.seen, 1U);
    EXPECT_TRUE(scene.corridor.contains(viewpoint.cell));
    EXPECT_EQ(viewpoint.cell.y, at(0, 7, 0).y) << "in line with the tunnel";
    EXPECT_NEAR(viewpoint.yaw, 0.0, 0.1);
  }
  EXPECT_TRUE(scene.sights.viewpoints(ClusterId{4}).empty());
  // It keeps them as long as they show it.
  const auto before = scene.sights.viewpoints(ClusterId{3}).front().cell;
  scene.look({end}, {{kBounds}});
  EXPECT_EQ(scene.sights.viewpoints(ClusterId{3}).front().cell, before);
  scene.look({}, {});
  EXPECT_TRUE(scene.sights.viewpoints(ClusterId{3}).empty());
}

// With something else to look at, it tries again and again, with pauses of 2, 4, 8, 8, ... plannings.
TEST(ClusterSights, TriesHiddenClustersEverLessOften) {
  Scene scene;
  const FrontierCluster seen = cluster_of(1, at(15, 3, 3)), hidden = cluster_of(2, at(30, 18, 8));
  std::vector<int> tries;
  for (int planning = 1; planning <= 32; ++planning) {
    scene.asked = 0;
    scene.look({seen, hidden}, {{kBounds}});
    ASSERT_FALSE(scene.sights.viewpoints(ClusterId{1}).empty());
    EXPECT_TRUE(scene.sights.viewpoints(ClusterId{2}).empty());
    if (scene.asked > 20) tries.push_back(planning);
  }
  EXPECT_EQ(tries, (std::vector{1, 3, 7, 15, 23, 31}));
}

// What has not been looked at again since nothing that it depends on has changed is what a new look finds.
TEST(ClusterSights, AreThoseOfANewLook) {
  test::Random random(5);
  Scene scene;
  std::vector<FrontierCluster> clusters;
  for (std::uint32_t id = 1; id <= 6; ++id) {
    FrontierCluster& cluster = clusters.emplace_back(cluster_of(id, at(15, 2 * static_cast<int>(id), 3)));
    cluster.keys.push_back(at(15, 2 * static_cast<int>(id), 4));
    cluster.box.max = cluster.keys.back();
  }
  std::vector<KeyBox> changes = {kBounds};
  int compared = 0;
  for (int round = 0; round < 60; ++round) {
    scene.look(clusters, changes);
    const ViewpointQuery query{*scene.caster, scene.grid, scene.graph, scene.view, scene.region};
    for (const FrontierCluster& cluster : clusters) {
      std::vector<ClusterViewpoint> anew = find_viewpoints(query, cluster, {}).viewpoints;
      std::erase_if(anew, [&](const ClusterViewpoint& seen) { return !scene.corridor.contains(seen.cell); });
      if (anew.empty()) continue;  // it may know others
      const auto kept = scene.sights.viewpoints(cluster.id);
      ASSERT_EQ(kept.size(), anew.size()) << round;
      for (std::size_t i = 0; i < anew.size(); ++i) {
        EXPECT_EQ(kept[i].cell, anew[i].cell);
        EXPECT_EQ(kept[i].yaw, anew[i].yaw);
        EXPECT_EQ(kept[i].seen, anew[i].seen);
        ++compared;
      }
    }
    const VoxelKey middle = random.key_in({at(0, 0, 0), at(14, 14, 6)});
    const KeyBox box = grown({middle, middle}, random.below(2));
    test::fill(scene.grid, box, random.one_in(2) ? Occupancy::kOccupied : Occupancy::kFree);
    std::vector<VoxelKey> keys;
    for_each_key(box, [&](const VoxelKey& key) { keys.push_back(key); });
    scene.corridor.update({scene.grid, keys}, at(7, 7, 3));
    changes = {grown(box, 3)};  // with the cells of the body of three voxels
    scene.graph.update(scene.corridor, changes);
    scene.caster->update(scene.grid);
  }
  EXPECT_GT(compared, 200);
}

TEST(ClusterSights, TriesAllBeforeItSeesNone) {
  Scene scene;
  const FrontierCluster hidden = cluster_of(2, at(30, 18, 8));
  for (int planning = 1; planning <= 5; ++planning) {
    scene.asked = 0;
    scene.look({hidden}, {{kBounds}});
    EXPECT_GT(scene.asked, 20);
  }
  // Nothing has changed.
  scene.asked = 0;
  scene.look({hidden}, {});
  EXPECT_EQ(scene.asked, 0);
}

// A door far from the cluster lets the robot get to where it sees the cluster from, or another robot leaves.
TEST(ClusterSights, FindsWhatTheRobotGetsToLater) {
  for (const auto& [faces, another] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    Scene scene;
    const FrontierCluster cluster =
        faces ? cluster_of(1, at(5, 5, -1)) : cluster_of(3, at(35, 7, 2));  // in line with the tunnel
    bool& closed = another ? scene.is_in_the_way : scene.is_shut_in;
    closed = true;
    const auto look = [&] {
      scene.look({cluster}, {});
      if (faces) scene.look_at_faces({cluster});
      return !scene.sights.viewpoints(cluster.id).empty();
    };
    EXPECT_FALSE(look());
    closed = false;
    int looks = 1;
    while (!look() && looks < 20) ++looks;
    EXPECT_LE(looks, another ? 9 : 1) << faces;
    EXPECT_TRUE(look()) << "they stay";
  }
}

// A way opens to the usual places, near the cluster, when the robot has found others far away: they see more.
TEST(ClusterSights, AreTheBestFirstWhereverTheyWereFound) {
  const KeyBox bounds{at(0, 0, 0), at(60, 40, 12)};
  VoxelGrid grid(kResolution);
  test::fill(grid, bounds, Occupancy::kFree);
  FrontierCluster wall = cluster_of(1, at(0, 5, 4));
  wall.box = {at(0, 5, 4), at(0, 35, 8)};
  wall.keys.clear();
  for_each_key(wall.box, [&](const VoxelKey& key) { wall.keys.push_back(key); });
  test::fill(grid, wall.box, Occupancy::kUnknown);
  TravelCorridor corridor(flying_cube(), Lattice(kResolution), bounds);
  std::vector<VoxelKey> blocked;  // between the robot and the usual places
  for_each_key({at(11, 0, 0), at(35, 40, 12)}, [&](const VoxelKey& key) { blocked.push_back(key); });
  corridor.block(blocked);
  corridor.update({grid}, at(45, 20, 6));
  TravelGraph graph(Lattice(kResolution), bounds, 5, 2);
  graph.update(corridor, {{bounds}});
  const FieldOfView view{FieldOfView::Shape::kPyramid, 1.2, 1.0, 10.0};
  const ViewRegion region(view, kResolution);
  const auto caster = make_grid_ray_caster(grid);
  bool opens = false;
  const std::function<bool(const VoxelKey&)> reaches = [&](const VoxelKey& cell) {
    return opens ? corridor.fits(cell) : corridor.contains(cell);
  };
  ClusterSights sights;
  const auto look = [&] {
    sights.update({{*caster, grid, graph, view, region, 10.0}, {&wall, 1}, {}, reaches, reaches});
    return sights.viewpoints(wall.id);
  };
  const std::size_t far = look().front().seen;
  opens = true;
  const auto viewpoints = look();
  EXPECT_TRUE(std::ranges::is_sorted(viewpoints, std::greater{}, &ClusterViewpoint::seen));
  EXPECT_EQ(viewpoints.front().seen, far);
  EXPECT_LT(viewpoints.back().seen, far) << "of a usual place";
}

TEST(ClusterSights, TellWhatTheRobotWouldSee) {
  Scene scene;
  const FrontierCluster seen = cluster_of(1, at(15, 3, 3)), hidden = cluster_of(2, at(30, 18, 8));
  scene.look({hidden}, {{kBounds}});
  EXPECT_FALSE(scene.sights.would_see_any());
  scene.look({seen, hidden}, {});
  EXPECT_FALSE(scene.sights.would_see_any()) << "it sees it";
  scene.is_shut_in = true;
  scene.look({seen, hidden}, {});
  EXPECT_FALSE(scene.sights.sees_any());
  EXPECT_TRUE(scene.sights.would_see_any());
  scene.is_shut_in = false;
  scene.is_in_the_way = true;
  scene.look({seen, hidden}, {});
  EXPECT_FALSE(scene.sights.sees_any());
  EXPECT_FALSE(scene.sights.would_see_any()) << "another robot does not shut it in";
}

// It is asked for each part of the graph's cubes whether it connects now, not for each cell.
TEST(ClusterSights, CostLittleOfARobotThatIsShutIn) {
  Scene scene;
  scene.is_shut_in = true;
  std::vector<FrontierCluster> clusters;
  for (std::uint32_t i = 0; i < 10; ++i)
    clusters.push_back(cluster_of(i + 1, at(30, static_cast<int>(i), 8)));
  for (int planning = 0; planning < 3; ++planning) scene.look(clusters, {});
  scene.asked = scene.asked_if_connected = 0;
  scene.look(clusters, {});
  EXPECT_EQ(scene.asked, 0);
  EXPECT_GT(scene.asked_if_connected, 0);
  EXPECT_LE(scene.asked_if_connected, 10 * static_cast<int>(2 * scene.graph.size()));
}

// The layer under the room, of which the camera sees no middle.
TEST(ClusterSights, LooksAtFaces) {
  Scene scene;
  FrontierCluster floor = cluster_of(1, at(5, 5, -1));
  floor.box = {at(5, 5, -1), at(9, 9, -1)};
  floor.keys.clear();
  for_each_key(floor.box, [&](const VoxelKey& key) { floor.keys.push_back(key); });
  const FrontierCluster open = cluster_of(2, at(15, 3, 3));
  scene.look({floor, open}, {{kBounds}});
  ASSERT_TRUE(scene.sights.viewpoints(ClusterId{1}).empty());
  const VoxelKey seen_from = scene.sights.viewpoints(ClusterId{2}).front().cell;
  scene.look_at_faces({floor, open});
  ASSERT_FALSE(scene.sights.viewpoints(ClusterId{1}).empty());
  EXPECT_EQ(scene.sights.viewpoints(ClusterId{1}).front().aim, Aim::kFace);
  EXPECT_EQ(scene.sights.viewpoints(ClusterId{2}).front().cell, seen_from);
  // What it has found it keeps.
  scene.look({floor, open}, {{kBounds}});
  EXPECT_FALSE(scene.sights.viewpoints(ClusterId{1}).empty());
  EXPECT_TRUE(scene.sights.sees_any());
  scene.look({}, {});
  EXPECT_FALSE(scene.sights.sees_any());
}

}  // namespace
}  // namespace frontlux::planner::detail
