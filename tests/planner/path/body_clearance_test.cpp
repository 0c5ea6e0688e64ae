// Segments and paths of the body itself: wherever in a voxel the robot is, all that its body covers is known
// to be free.

#include "planner/path/walled_space.hpp"
#include "support/random.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/path_planner.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;
using test::WalledSpace;

// With pillars.
struct Scene : WalledSpace {
  Scene(std::uint64_t seed, double resolution) : WalledSpace(24, 11, resolution) {
    test::Random random(seed);
    for (int i = 0; i < 25; ++i) {
      const int x = random.below(24), y = random.below(24), high = random.below(11);
      for (int z = 0; z <= high; ++z)
        grid.set(key_at(x, y, z), random.one_in(2) ? Occupancy::kOccupied : Occupancy::kUnknown);
    }
  }
};

// At each of three resolutions a robot on a plane and one in space, whose sensor is 0.35 m high on the plane.
template <class Check>
void for_each_robot(const Check& check) {
  for (const double resolution : {0.3, 0.2, 0.25})
    for (const bool plane : {false, true}) {
      SCOPED_TRACE(testing::Message() << (plane ? "plane" : "space") << " at " << resolution << " m");
      TravelOptions travel = plane ? ugv_travel() : uav_travel();
      travel.min_height = 0.0;
      if (plane) travel.sensor_height = 0.35;
      check(travel, resolution, plane);
      if (testing::Test::HasFatalFailure()) return;
    }
}

// The true body at a point, by its faces: how far it covers what is not known free [m], to the least depth
// along any axis. On a plane it stands on layer 0.
double depth_in_unknown(const Scene& scene, const TravelOptions& travel, const Eigen::Vector3d& at) {
  const double r = scene.grid.resolution();
  Eigen::Vector3d low = at - travel.extents / 2, high = at + travel.extents / 2;
  if (travel.motion == Motion::kPlane) {
    low.z() = 0.0;
    high.z() = travel.extents.z();
  }
  const Eigen::Vector3i first = (low / r).array().floor().cast<int>().matrix(),
                        last = (high / r).array().floor().cast<int>().matrix();
  double deepest = 0.0;
  for_each_key({key_at(first.x(), first.y(), first.z()), key_at(last.x(), last.y(), last.z())},
               [&](const VoxelKey& key) {
                 if (scene.grid.at(key) == Occupancy::kFree) return;
                 const Eigen::Vector3d middle = scene.grid.lattice().exact_center(key),
                                       half = Eigen::Vector3d::Constant(r / 2);
                 const Eigen::Vector3d shared = high.cwiseMin(middle + half) - low.cwiseMax(middle - half);
                 deepest = std::max(deepest, shared.minCoeff());
               });
  return deepest;
}

TEST(BodyClearance, ReachIsWhatTheCollisionBoxLeavesOpen) {
  const auto reach = [](const TravelOptions& travel, double resolution) {
    return BodyStencil(travel, resolution).reach();
  };
  EXPECT_EQ(reach(ugv_travel(), 0.3), Eigen::Vector3d::Zero());  // 1.5 m of voxels for 1.0 m
  EXPECT_TRUE(reach(uav_travel(), 0.3).isApprox(Eigen::Vector3d::Constant(0.1)));
  EXPECT_EQ(reach(uav_travel(), 0.2), Eigen::Vector3d::Zero());  // 1.0 m for 0.8 m
  EXPECT_EQ(reach(uav_node_travel(), 0.3), Eigen::Vector3d::Zero());
  // Five voxels of 0.2 m are just as wide as the body.
  const Eigen::Vector3d full = reach(ugv_travel(), 0.2);
  EXPECT_LT(full.x(), 0.1);
  EXPECT_GT(full.x(), 0.0999);
  EXPECT_EQ(full.z(), 0.0);
}

TEST(BodyClearance, ASegmentIsFreeIfAndOnlyIfTheBodyFitsInItsCells) {
  int free = 0, blocked_only_by_body = 0;
  for_each_robot([&](const TravelOptions& travel, double resolution, bool plane) {
    const Scene scene(static_cast<std::uint64_t>(100 * resolution), resolution);
    const TravelCorridor corridor = scene.corridor(travel, key_at(12, 12, plane ? 1 : 5));
    const Lattice& lattice = scene.grid.lattice();
    const Eigen::Vector3d d = corridor.reach();
    test::Random random(5);
    for (int i = 0; i < 6'000; ++i) {
      Eigen::Vector3d from, to;
      for (int a = 0; a < 3; ++a) {
        from[a] = random.uniform(2.0, a == 2 ? 9.0 : 22.0) * resolution;
        to[a] = from[a] + (random.one_in(4) ? 0.0 : random.uniform(-4.0, 4.0) * resolution);
      }
      if (plane) from.z() = to.z() = 0.35;
      const bool is_free = segment_is_free(corridor, lattice, from, to);
      bool middle_free = true, cells_free = true;
      for (int k = 0; k <= 60; ++k) {
        const Eigen::Vector3d at = from + (to - from) * (k / 60.0);
        const auto cell = [&](const Eigen::Vector3d& p) { return corridor.passable(lattice.key(p).value()); };
        middle_free = middle_free && cell(at);
        for (int corner = 0; corner < 8; ++corner)
          cells_free = cells_free && cell(at + Eigen::Vector3d((corner & 1) != 0 ? d.x() : -d.x(),
                                                               (corner & 2) != 0 ? d.y() : -d.y(),
                                                               (corner & 4) != 0 ? d.z() : -d.z()));
        if (is_free) {
          ASSERT_TRUE(cells_free) << at.transpose();
          // What `reach` ignores is a ten thousandth of a voxel.
          ASSERT_LE(depth_in_unknown(scene, travel, at), 1.001e-4 * resolution)
              << at.transpose() << " on the segment from " << from.transpose() << " to " << to.transpose();
        }
      }
      free += static_cast<int>(is_free);
      blocked_only_by_body += static_cast<int>(middle_free && !is_free);
      if (from == to) {
        ASSERT_EQ(is_free, cells_free);
      }
    }
    // In the middle of a passable cell there is always room.
    for (const VoxelKey& cell : corridor.cells()) {
      const Eigen::Vector3d center = lattice.exact_center(cell);
      ASSERT_TRUE(segment_is_free(corridor, lattice, center, center));
    }
  });
  EXPECT_GT(free, 1000);
  EXPECT_GT(blocked_only_by_body, 200);  // else the body was never what decided
}

TEST(BodyClearance, PlansFromAndToAnywhereInTheBody) {
  int paths = 0, escapes = 0, refused = 0;
  for_each_robot([&](const TravelOptions& travel, double resolution, bool plane) {
    const Scene scene(static_cast<std::uint64_t>(100 * resolution) + 7, resolution);
    TravelCorridor corridor(travel, scene.grid.lattice(), scene.bounds);
    test::Random random(8);
    // The robot's own cell may be anywhere that is passable.
    for (int x = 3; x < 20 && corridor.state() != CorridorState::kReady; ++x)
      corridor.update({scene.grid}, key_at(x, 12, plane ? 1 : 5));
    ASSERT_EQ(corridor.state(), CorridorState::kReady);
    const Lattice& lattice = scene.grid.lattice();
    const auto cells = corridor.cells();
    for (int i = 0; i < 60; ++i) {
      const auto somewhere = [&] {
        Pose pose{lattice.exact_center(random.pick(cells))};
        pose.position += random.point(-0.49, 0.49) * resolution;
        return pose;
      };
      const Pose start = somewhere(), goal = somewhere();
      const bool starts_free = segment_is_free(corridor, lattice, start.position, start.position);
      PathOptions options;
      options.search = i % 2 == 0 ? PathSearch::kRrt : PathSearch::kCorridor;
      options.iterations = 300;
      options.shortcut_rounds = i % 4 < 2 ? 0 : 6;
      const PathPlan plan = plan_path(corridor, lattice, start, goal, {1, 2, 3}, options);
      if (!segment_is_free(corridor, lattice, goal.position, goal.position)) {
        EXPECT_EQ(plan.outcome, PathOutcome::kGoalNotFree);
        ++refused;
        continue;
      }
      ASSERT_TRUE(plan.found()) << describe(plan.outcome);
      ++paths;
      EXPECT_EQ(plan.viewpoints.front().position, start.position);
      EXPECT_EQ(plan.viewpoints.back().position, goal.position);
      double before = depth_in_unknown(scene, travel, start.position);
      escapes += static_cast<int>(!starts_free);
      for (std::size_t k = 1; k < plan.viewpoints.size(); ++k)
        for (int part = 0; part <= 40; ++part) {
          const Eigen::Vector3d from = plan.viewpoints[k - 1].position, to = plan.viewpoints[k].position;
          const double depth = depth_in_unknown(scene, travel, from + (to - from) * (part / 40.0));
          // Out of where it should not be it only ever gets better.
          ASSERT_LE(depth, k == 1 && !starts_free ? before + 1e-9 : 1.001e-4 * resolution)
              << "case " << i << ", part " << k << " of " << plan.viewpoints.size();
          before = depth;
        }
    }
  });
  EXPECT_GT(paths, 150);
  EXPECT_GT(escapes, 10);
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace frontlux::planner
