#include "tour/cluster_viewpoints.hpp"

#include "support/random.hpp"
#include "support/views.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;
using Keys = std::vector<VoxelKey>;

constexpr double kResolution = 0.2;
constexpr KeyBox kBounds{{32750, 32750, 32768}, {32800, 32800, 32779}};

struct Room {
  VoxelGrid grid{kResolution};
  TravelCorridor corridor;
  TravelGraph graph;
  FrontierCluster cluster;

  // Free but for some pillars; unknown beyond a plane, on which the cluster lies.
  explicit Room(Random& random)
      : corridor(options(), Lattice(kResolution), kBounds), graph(Lattice(kResolution), kBounds, 5, 2) {
    KeyBox known = kBounds;
    known.max.x = 32785;
    test::fill(grid, known, Occupancy::kFree);
    for (int i = 0; i < 25; ++i) {
      KeyBox pillar = *intersection(cube(random.key_in(known), 2 + random.below(3)), known);
      pillar.min.z = kBounds.min.z;
      test::fill(grid, pillar, Occupancy::kOccupied);
    }
    const VoxelKey robot = make_key(32755, 32755, 32772);
    test::fill(grid, grown({robot, robot}, 1), Occupancy::kFree);
    corridor.update({grid}, robot);
    graph.update(corridor, {{kBounds}});
    const int y = 32755 + random.below(35);
    for_each_key({make_key(32786, y, 32770), make_key(32786, y + 8, 32777)},
                 [&](const VoxelKey& key) { cluster.keys.push_back(key); });
    test::sort(cluster.keys);
    cluster.box = bounds_of(cluster.keys);
  }
  static TravelOptions options() {
    TravelOptions options;
    options.extents = {0.4, 0.4, 0.4};
    options.min_height = -100.0;
    return options;
  }
};

// A room, a sensor in it, and from where that sees the cluster.
struct Look {
  Look(Random& random, const FieldOfView& of_sensor) : room(random), view(of_sensor) {}
  Room room;
  FieldOfView view;
  ViewRegion region{view, kResolution};
  std::unique_ptr<RayCaster> caster = make_grid_ray_caster(room.grid);
  ViewpointQuery query{*caster, room.grid, room.graph, view, region};
  std::vector<ClusterViewpoint> viewpoints = find_viewpoints(query, room.cluster, {}).viewpoints;
};

TEST(ClusterViewpoints, SeeWhatTheyCount) {
  Random random(61);
  std::size_t found = 0;
  for (int round = 0; round < 30; ++round) {
    const Look look(random, round % 2 == 0 ? test::camera(5.0) : test::lidar(5.0));
    const auto& [room, view, region, caster, query, viewpoints] = look;
    found += viewpoints.size();
    for (std::size_t i = 0; i < viewpoints.size(); ++i) {
      const ClusterViewpoint& viewpoint = viewpoints[i];
      EXPECT_TRUE(room.corridor.fits(viewpoint.cell));
      if (i > 0) {
        EXPECT_LE(viewpoint.seen, viewpoints[i - 1].seen);
      }
      Keys by_hand;
      for (const VoxelKey& key : room.cluster.keys)
        if (view.contains(test::offset_between(viewpoint.cell, key, kResolution), viewpoint.yaw) &&
            test::is_visible(*caster, KeySegment{viewpoint.cell, key}, UnknownPolicy::kBlock))
          by_hand.push_back(key);
      EXPECT_EQ(viewpoint.seen, by_hand.size());
      EXPECT_EQ(visible_from(query, room.cluster.keys, viewpoint.cell, viewpoint.yaw, Aim::kMiddle), by_hand);
    }
  }
  EXPECT_GT(found, 60u);
}

// Of clusters so small that each frontier is in the sample.
TEST(ClusterViewpoints, SeePartsOfOtherClusters) {
  Random random(63);
  std::size_t partly = 0;
  for (int round = 0; round < 20; ++round) {
    const Look look(random, round % 2 == 0 ? test::camera(5.0) : test::lidar(5.0));
    const auto& [room, view, region, caster, query, viewpoints] = look;
    std::vector<FrontierCluster> clusters;
    for (std::size_t first = 0; first + 16 <= room.cluster.keys.size(); first += 16) {
      const auto begin = room.cluster.keys.begin() + static_cast<std::ptrdiff_t>(first);
      clusters.emplace_back();
      clusters.back().keys.assign(begin, begin + (first == 0 ? 5 : 16));
      clusters.back().box = bounds_of(clusters.back().keys);
    }
    std::vector<const FrontierCluster*> pointers;
    for (const FrontierCluster& cluster : clusters) pointers.push_back(&cluster);
    const NumberTable parts = parts_seen(query, viewpoints, pointers);
    for (std::size_t v = 0; v < viewpoints.size(); ++v)
      for (std::size_t c = 0; c < clusters.size(); ++c) {
        const Keys seen =
            visible_from(query, clusters[c].keys, viewpoints[v].cell, viewpoints[v].yaw, Aim::kMiddle);
        const double part = static_cast<double>(seen.size()) / static_cast<double>(clusters[c].keys.size());
        EXPECT_NEAR(parts(v, c), part, 1e-12);
        partly += part > 0.0 && part < 1.0 ? 1 : 0;
      }
  }
  EXPECT_GT(partly, 20u);
}

TEST(ClusterViewpoints, AreNoneWhereNothingIsVisible) {
  Random random(62);
  const Room room(random);
  const FieldOfView view = test::camera(5.0);
  const ViewRegion region(view, kResolution);
  VoxelGrid walled = room.grid;
  KeyBox wall = kBounds;
  wall.min.x = wall.max.x = 32785;
  test::fill(walled, wall, Occupancy::kOccupied);
  const auto caster = make_grid_ray_caster(walled);
  EXPECT_TRUE(
      find_viewpoints({*caster, walled, room.graph, view, region}, room.cluster, {}).viewpoints.empty());
}

// From where a camera that looks straight ahead has a hole in the floor in view, floor hides the voxels of
// the hole but the first ones. Beams meet them all the same.
TEST(ClusterViewpoints, SeeAHoleInTheFloorAskew) {
  VoxelGrid grid(kResolution);
  const KeyBox floor = {{32750, 32750, 32768}, {32780, 32780, 32768}};
  KeyBox room = floor;
  room.min.z = 32769;
  room.max.z = 32779;
  const KeyBox hole = {{32762, 32762, 32768}, {32766, 32766, 32768}};
  test::fill(grid, room, Occupancy::kFree);
  test::fill(grid, floor, Occupancy::kOccupied);
  test::fill(grid, hole, Occupancy::kUnknown);
  FrontierCluster cluster;
  for_each_key(hole, [&](const VoxelKey& key) { cluster.keys.push_back(key); });
  test::sort(cluster.keys);
  cluster.box = hole;
  TravelCorridor corridor(Room::options(), grid.lattice(), room);
  TravelGraph graph(grid.lattice(), room, 5, 2);
  corridor.update({grid}, make_key(32760, 32760, 32774));
  graph.update(corridor, {{room}});
  FieldOfView view = test::camera(5.0);
  view.vertical = 0.8;
  const ViewRegion region(view, kResolution);
  const auto caster = make_grid_ray_caster(grid);
  const ViewpointQuery query{*caster, grid, graph, view, region, 10.0};
  EXPECT_TRUE(find_viewpoints(query, cluster, {}).viewpoints.empty());
  const auto reaches = [&](const VoxelKey& cell) { return corridor.contains(cell); };
  const std::vector<ClusterViewpoint> viewpoints = viewpoints_anywhere(query, cluster, Aim::kFace, reaches);
  ASSERT_FALSE(viewpoints.empty());
  for (const ClusterViewpoint& viewpoint : viewpoints) {
    EXPECT_EQ(viewpoint.aim, Aim::kFace);
    EXPECT_GE(viewpoint.seen, 10u);
    const auto seen_by = [&](Aim aim) {
      return visible_from(query, cluster.keys, viewpoint.cell, viewpoint.yaw, aim);
    };
    EXPECT_LT(seen_by(Aim::kMiddle).size(), 10u);
    Keys by_hand;  // nothing is in the way
    for (const VoxelKey& key : cluster.keys) {
      const VoxelKey above = make_key(key.x, key.y, key.z + 1);
      const Eigen::Vector3d up = test::offset_between(key, viewpoint.cell, kResolution);
      if (up.z() >= 0.2 * up.norm() &&
          view.contains(test::offset_between(viewpoint.cell, above, kResolution), viewpoint.yaw))
        by_hand.push_back(key);
    }
    EXPECT_EQ(seen_by(Aim::kFace), by_hand);
    EXPECT_EQ(viewpoint.seen, by_hand.size());
  }
  // They stay viewpoints as long as they show it.
  EXPECT_EQ(find_viewpoints(query, cluster, viewpoints).viewpoints.size(), viewpoints.size());
}

}  // namespace
}  // namespace frontlux::planner::detail
