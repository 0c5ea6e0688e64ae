#include "tour/tour_planning.hpp"

#include "support/views.hpp"
#include "support/voxel_keys.hpp"
#include "tour/travel_seconds.hpp"

#include <frontlux/frontier_set.hpp>

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

constexpr double kResolution = 0.2;
constexpr KeyBox kBounds{{32750, 32750, 32768}, {32800, 32800, 32779}};

// A robot in a known part of a space without obstacles.
struct OpenSpace {
  VoxelGrid grid{kResolution};
  Robot robot{"uav", {}, test::camera(5.0), {}};
  VoxelKey at = make_key(32765, 32765, 32772);
  Pose pose{grid.lattice().exact_center(at), 0.0};
  std::unique_ptr<RayCaster> caster;
  FrontierSet frontiers;
  TourPlanning planning;

  explicit OpenSpace(const TourPlanning::Options& options = {})
      : caster((test::fill(grid, {kBounds.min, make_key(32785, 32785, kBounds.max.z)}, Occupancy::kFree),
                make_grid_ray_caster(grid))),
        frontiers(grid, kBounds),
        planning({with_body()}, {&pose, 1}, grid.lattice(), kBounds, options) {}

  Robot& with_body() {
    robot.travel.extents = {0.4, 0.4, 0.4};
    robot.travel.min_height = -100.0;
    return robot;
  }
  [[nodiscard]] TravelCorridor corridor(std::span<const VoxelKey> blocked = {}) const {
    TravelCorridor corridor(robot.travel, grid.lattice(), kBounds);
    corridor.block(blocked);
    corridor.update({grid}, at);
    return corridor;
  }
  void plan(const TravelCorridor& corridor) {
    MotionState start;
    start.pose = pose;
    planning.update({0, *caster, grid, corridor, frontiers.keys(), {&start, 1}});
  }
  [[nodiscard]] std::set<ClusterId> clusters() const {
    std::set<ClusterId> ids;
    for (const TourStop& stop : planning.tour(0)) ids.insert(stop.clusters.begin(), stop.clusters.end());
    return ids;
  }
};

TEST(TourPlanning, LooksAtClustersFromWhereTheRobotCanGo) {
  OpenSpace space;
  const TravelCorridor corridor = space.corridor();
  space.plan(corridor);
  std::size_t clusters = 0;
  for (const TourStop& stop : space.planning.tour(0)) {
    EXPECT_TRUE(corridor.contains(stop.cell));
    EXPECT_EQ(stop.pose.position, space.grid.lattice().exact_center(stop.cell));
    EXPECT_GT(stop.seen, 0U);
    clusters += stop.clusters.size();
  }
  EXPECT_EQ(space.clusters().size(), clusters) << "a cluster is in two stops";
  EXPECT_GT(clusters, space.planning.tour(0).size()) << "some stops show several";
  const Keys keys = space.planning.frontiers_of(0);
  EXPECT_TRUE(std::ranges::includes(space.frontiers.keys(), keys));
  const Keys& first = space.planning.first_view(0);
  EXPECT_FALSE(first.empty());
  EXPECT_TRUE(std::ranges::includes(keys, first));
}

TEST(TourPlanning, StopsAreAmongItsCandidates) {
  OpenSpace space;
  const TravelCorridor corridor = space.corridor();
  EXPECT_TRUE(space.planning.candidates(0).empty()) << "before it has planned";
  space.plan(corridor);
  const std::vector<RenderedCell> candidates = space.planning.candidates(0);
  EXPECT_GT(candidates.size(), space.planning.tour(0).size());
  const Lattice& lattice = space.grid.lattice();
  for (const RenderedCell& candidate : candidates) {
    EXPECT_TRUE(corridor.contains(candidate.cell));
    const Eigen::Vector3d at = lattice.exact_center(candidate.cell);
    EXPECT_GE(candidate.distance, (at - space.pose.position).norm() - 1e-9);
    EXPECT_LE(candidate.distance, 1.5 * (at - space.pose.position).norm() + 1.0) << "nothing is in its way";
    // Nothing hides a frontier here, so it sees what is in its view: what it counts, and of other clusters.
    const auto in_view = std::ranges::count_if(space.frontiers.keys(), [&](const VoxelKey& key) {
      return space.robot.view.contains(lattice.exact_center(key) - at, candidate.yaw);
    });
    EXPECT_GE(candidate.gain, TourPlanning::Options{}.least_gain);
    EXPECT_LE(candidate.gain, static_cast<double>(in_view));
    EXPECT_EQ(candidate.hits, candidate.gain);
    EXPECT_EQ(candidate.standard_error, 0.0);
  }
  for (const TourStop& stop : space.planning.tour(0))
    EXPECT_TRUE(std::ranges::any_of(candidates, [&](const RenderedCell& candidate) {
      return candidate.cell == stop.cell && candidate.yaw == stop.pose.yaw;
    }));
}

// A stop from which nothing is in view would be planned again and again.
TEST(TourPlanning, AsksForAFrontierAStopAtLeast) {
  EXPECT_EQ(OpenSpace({.least_gain = 0.0}).planning.least_gain(0), 1.0);
  EXPECT_EQ(OpenSpace({.least_gain = 3.0}).planning.least_gain(0), 3.0);
}

// Where the map is large only ways between near places are measured, and far clusters share stops.
TEST(TourPlanning, LeadsToAllClustersHoweverFarTheyAre) {
  OpenSpace all, some({.measured = 1}), far({.near = 0.02, .measured = 1});
  for (OpenSpace* space : {&all, &some, &far}) space->plan(space->corridor());
  ASSERT_GT(all.clusters().size(), 5U);
  EXPECT_EQ(some.clusters(), all.clusters());
  EXPECT_EQ(far.clusters(), all.clusters());
}

// Left in the order of the shortest tour, places near by would come when the robot is far away.
TEST(TourPlanning, PutsTheStopsNearestToTheRobotFirst) {
  constexpr std::size_t kJoined = 3;
  OpenSpace all({.joined = 0}), some({.joined = kJoined});
  for (OpenSpace* space : {&all, &some}) space->plan(space->corridor());
  const TravelCorridor corridor = all.corridor();
  std::map<ClusterId, double> distances;  // [m] to each cluster's best viewpoint
  for (const TourStop& stop : all.planning.tour(0)) {
    ASSERT_EQ(stop.clusters.size(), 1U);
    distances[stop.clusters.front()] = corridor.distance(stop.cell).value();
  }
  std::size_t clusters = 0;
  double farthest = 0.0, nearest = std::numeric_limits<double>::infinity();
  for (const TourStop& stop : some.planning.tour(0))
    for (const ClusterId cluster : stop.clusters)
      if (clusters++ < kJoined)
        farthest = std::max(farthest, distances.at(cluster));
      else
        nearest = std::min(nearest, distances.at(cluster));
  ASSERT_GT(clusters, 2 * kJoined);
  EXPECT_LE(farthest, nearest);
}

// The stops of a tour: what is looked at, and from where.
std::vector<std::pair<std::vector<ClusterId>, std::pair<VoxelKey, double>>> stops_of(
    const TourPlanning::Options& options) {
  OpenSpace space(options);
  space.plan(space.corridor());
  std::vector<std::pair<std::vector<ClusterId>, std::pair<VoxelKey, double>>> stops;
  for (const TourStop& stop : space.planning.tour(0))
    stops.push_back({stop.clusters, {stop.cell, stop.pose.yaw}});
  return stops;
}

TEST(TourPlanning, WithoutZonesFarClustersAreStopsOfTheirOwn) {
  const auto single = stops_of({.near = 0.02, .joined = 0, .without = TourPart::kZones});
  EXPECT_EQ(single, stops_of({.near = 1e9, .joined = 0}));
  EXPECT_NE(single, stops_of({.near = 0.02, .joined = 0}));
}

TEST(TourPlanning, WithoutRefinementEachStopIsTheFirstOfItsViewpoints) {
  // Clusters that are not joined are stops where they are seen best, which is their first candidate.
  std::map<ClusterId, std::pair<VoxelKey, double>> best;
  for (const auto& [clusters, at] : stops_of({.joined = 0})) best.emplace(clusters.at(0), at);
  OpenSpace space({.joined = 0});
  space.plan(space.corridor());
  std::size_t others = 0;
  double most = 0.0;  // seen of a cluster
  for (const RenderedCell& candidate : space.planning.candidates(0)) {
    const bool is_first = std::ranges::any_of(
        best, [&](const auto& stop) { return stop.second == std::pair(candidate.cell, candidate.yaw); });
    if (is_first) most = candidate.gain;
    EXPECT_LE(candidate.gain, most);
    others += is_first ? 0 : 1;
  }
  EXPECT_GT(others, best.size());
  const auto single = stops_of({.refined = 0, .without = TourPart::kJoining});
  EXPECT_EQ(single.size(), best.size());
  for (const auto& [clusters, at] : single) EXPECT_EQ(at, best.at(clusters.at(0)));
  EXPECT_NE(single, stops_of({.without = TourPart::kJoining}));
  const auto first = stops_of({.without = TourPart::kRefinement});
  EXPECT_EQ(first, stops_of({.refined = 0}));
  EXPECT_NE(first, stops_of({}));
}

TEST(TourPlanning, WithoutJoiningEachClusterIsAStop) {
  const auto single = stops_of({.without = TourPart::kJoining}), joined = stops_of({});
  const auto is_one = [](const auto& stop) { return stop.first.size() == 1; };
  EXPECT_TRUE(std::ranges::all_of(single, is_one));
  EXPECT_FALSE(std::ranges::all_of(joined, is_one));
  std::set<ClusterId> clusters;
  for (const auto& stop : joined) clusters.insert(stop.first.begin(), stop.first.end());
  EXPECT_EQ(single.size(), clusters.size());
}

TEST(TourPlanning, WithoutArrivalStopsComeInTheOrderOfTheTour) {
  std::map<ClusterId, std::size_t> place;  // of each cluster in the shortest tour
  for (const auto& stop : stops_of({.joined = 0})) place.emplace(stop.first.at(0), place.size());
  const auto places = [&](const TourPlanning::Options& options) {
    std::vector<std::size_t> first;
    for (const auto& [clusters, at] : stops_of(options)) {
      first.push_back(place.at(clusters.front()));
      for (const ClusterId cluster : clusters) first.back() = std::min(first.back(), place.at(cluster));
    }
    return first;
  };
  ASSERT_LE(place.size(), TourPlanning::Options{}.joined);
  EXPECT_TRUE(std::ranges::is_sorted(places({.without = TourPart::kArrival})));
  EXPECT_FALSE(std::ranges::is_sorted(places({})));
}

TEST(TourPlanning, WithoutToursIsTheNearestStop) {
  OpenSpace all({.joined = 0}), nearest({.without = TourPart::kTours});
  const TravelCorridor corridor = all.corridor();
  for (OpenSpace* space : {&all, &nearest}) space->plan(corridor);
  const auto seconds = [&](const TourStop& stop) {
    return travel_seconds(all.robot, corridor.distance(stop.cell).value(),
                          stop.pose.position - all.pose.position, turn_between(all.pose.yaw, stop.pose.yaw));
  };
  ASSERT_GT(all.planning.tour(0).size(), 5U);
  const TourStop first = *std::ranges::min_element(all.planning.tour(0), {}, seconds);
  EXPECT_EQ(nearest.clusters(), std::set(first.clusters.begin(), first.clusters.end()));
}

// Two robots at one place, with stops of one and of several clusters.
TEST(TourPlanning, WithoutToursNobodyGoesWhereAnotherOneIsGoing) {
  for (const double near : {2.0, 0.02}) {
    const TourPlanning::Options options{.near = near, .without = TourPart::kTours};
    OpenSpace space(options);
    const std::array<Pose, 2> poses{space.pose, space.pose};
    TourPlanning both({space.robot, space.robot}, poses, space.grid.lattice(), kBounds, options);
    const TravelCorridor corridor = space.corridor();
    std::array<MotionState, 2> starts;
    for (MotionState& start : starts) start.pose = space.pose;
    const auto clusters = [&](std::size_t robot) {
      std::set<ClusterId> ids;
      for (const TourStop& stop : both.tour(robot)) ids.insert(stop.clusters.begin(), stop.clusters.end());
      return ids;
    };
    for (const std::size_t robot : {0, 1, 0, 1}) {
      both.update({robot, *space.caster, space.grid, corridor, space.frontiers.keys(), starts});
      EXPECT_TRUE(near < 1.0 || !both.tour(robot).empty()) << "a far zone may hold all that there is";
      std::vector<ClusterId> shared;
      std::ranges::set_intersection(clusters(0), clusters(1), std::back_inserter(shared));
      EXPECT_TRUE(shared.empty()) << near;
    }
  }
}

// A robot goes to see several clusters from one place. Others that plan meanwhile, and are there already,
// leave all of them to it, also when its path has led it through what it did not know when it planned.
TEST(TourPlanning, LeavesToARobotWhatItGoesToSee) {
  OpenSpace space;
  const std::array<Pose, 2> poses{space.pose, space.pose};
  TourPlanning both({space.robot, space.robot}, poses, space.grid.lattice(), kBounds, {});
  std::array<MotionState, 2> starts;
  for (MotionState& start : starts) start.pose = space.pose;
  const auto plan = [&](std::size_t robot) {
    TravelCorridor corridor(space.robot.travel, space.grid.lattice(), kBounds);
    corridor.update({space.grid}, space.grid.lattice().key(starts.at(robot).pose.position).value());
    both.update({robot, *space.caster, space.grid, corridor, space.frontiers.keys(), starts});
  };
  plan(0);
  const TourStop stop = both.tour(0).front();
  ASSERT_GT(stop.clusters.size(), 1U);
  starts[1].pose = stop.pose;
  const Eigen::Vector3d beyond = space.grid.lattice().exact_center(make_key(32795, 32765, 32772));
  for (int planning = 0; planning < 4; ++planning) {
    if (planning == 2) starts[0].pose.position = beyond;
    plan(1);
    std::set<ClusterId> kept;
    for (const TourStop& next : both.tour(0).first(std::min(stop.clusters.size(), both.tour(0).size())))
      kept.insert(next.clusters.begin(), next.clusters.end());
    EXPECT_EQ(kept, std::set(stop.clusters.begin(), stop.clusters.end())) << planning;
    EXPECT_FALSE(both.tour(1).empty());
  }
}

// All that there is is in the tour of one robot, and the other one asks for something to see.
TEST(TourPlanning, LeavesToOthersOnlyWhatTheyAreGoingTo) {
  OpenSpace space;
  const std::array<Pose, 2> poses{space.pose, space.pose};
  TourPlanning both({space.robot, space.robot}, poses, space.grid.lattice(), kBounds, {});
  std::array<MotionState, 2> starts;
  for (MotionState& start : starts) start.pose = space.pose;
  const TravelCorridor corridor = space.corridor();
  const auto plan = [&](std::size_t robot) {
    both.update({robot, *space.caster, space.grid, corridor, space.frontiers.keys(), starts});
  };
  plan(1);
  both.lose(1);  // which takes its tour, and leaves it what it knows of paths
  plan(0);
  ASSERT_GT(both.tour(0).size(), 1U);
  ASSERT_TRUE(both.tour(1).empty());
  const auto place = both.place_to_see_from(1, *space.caster, space.grid,
                                            [&](const VoxelKey& key) { return corridor.contains(key); });
  ASSERT_TRUE(place.has_value());
  EXPECT_TRUE(corridor.contains(*place));
}

// A robot beside which something turned up is in no corridor for a while. Nothing else has changed.
TEST(TourPlanning, GoesOnAfterTheRobotWasLost) {
  OpenSpace space;
  space.plan(space.corridor());
  const auto before = space.clusters();
  ASSERT_GT(before.size(), 5U);
  const TravelCorridor lost = space.corridor({&space.at, 1});
  ASSERT_EQ(lost.state(), CorridorState::kBoxNotFree);
  space.plan(lost);
  EXPECT_TRUE(space.planning.tour(0).empty());
  space.plan(space.corridor());
  EXPECT_EQ(space.clusters(), before);
}

TEST(TourPlanning, LearnsOfCellsThatAreBlocked) {
  OpenSpace space;
  space.plan(space.corridor());
  const VoxelKey beyond = make_key(32780, 32765, 32772);
  ASSERT_TRUE(space.planning.can_reach(0, beyond));
  Keys wall;  // across all that is known
  for_each_key({make_key(32774, 32750, 32768), make_key(32774, 32800, 32779)},
               [&](const VoxelKey& key) { wall.push_back(key); });
  space.planning.note_changed_voxels(0, wall);
  space.plan(space.corridor(wall));
  EXPECT_FALSE(space.planning.can_reach(0, beyond));
  EXPECT_TRUE(space.planning.can_reach(0, make_key(32770, 32765, 32772)));
}

// The floor is seen after the air above it, in a map of which the robot knows cells already.
TEST(TourPlanning, LearnsOfGroundThatIsSeenLate) {
  constexpr int kFloor = 32767;
  for (int deeper = 0; deeper < 8; ++deeper) {
    SCOPED_TRACE(deeper);
    const KeyBox bounds{make_key(32750, 32750, kFloor - deeper), make_key(32790, 32790, kFloor + 14)};
    VoxelGrid grid(0.1);
    Robot robot{"ugv", {}, test::camera(5.0), {}};
    robot.travel.motion = Motion::kGround;
    robot.travel.extents = {0.7, 0.5, 0.4};
    robot.travel.sensor_height = 0.5;
    robot.travel.step = 0.2;
    const VoxelKey at = make_key(32770, 32770, kFloor + 6), late = make_key(32781, 32770, kFloor + 6);
    test::fill(grid, {make_key(32750, 32750, kFloor + 1), make_key(32790, 32790, kFloor + 14)},
               Occupancy::kFree);
    test::fill(grid, {make_key(32750, 32750, kFloor), make_key(32776, 32790, kFloor)}, Occupancy::kOccupied);
    const Pose pose{grid.lattice().exact_center(at), 0.0};
    TourPlanning planning({robot}, {&pose, 1}, grid.lattice(), bounds, {});
    TravelCorridor corridor(robot.travel, grid.lattice(), bounds);
    Keys seen;
    const auto plan = [&] {
      corridor.update({grid, seen}, at);
      const auto caster = make_grid_ray_caster(grid);
      const FrontierSet frontiers(grid, bounds);
      MotionState start;
      start.pose = pose;
      planning.update({0, *caster, grid, corridor, frontiers.keys(), {&start, 1}});
    };
    plan();
    ASSERT_TRUE(corridor.contains(at));
    ASSERT_FALSE(planning.can_reach(0, late));
    for_each_key({make_key(32777, 32750, kFloor), make_key(32790, 32790, kFloor)},
                 [&](const VoxelKey& key) { seen.push_back(key); });
    for (const VoxelKey& key : seen) grid.set(key, Occupancy::kOccupied);
    planning.note_changed_voxels(seen);
    plan();
    ASSERT_TRUE(corridor.contains(late));
    EXPECT_TRUE(planning.can_reach(0, late));
  }
}

}  // namespace
}  // namespace frontlux::planner::detail
