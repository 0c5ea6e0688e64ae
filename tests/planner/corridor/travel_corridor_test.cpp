// Corridors against definitions applied cell by cell, and Dijkstra's algorithm.

#include "corridor/whole_voxels.hpp"
#include "planner/corridor/dijkstra.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;
using test::Random;

VoxelKey moved(const VoxelKey& k, int x, int y, int z) { return make_key(k.x + x, k.y + y, k.z + z); }
VoxelKey moved(const VoxelKey& k, const int (&by)[3]) { return moved(k, by[0], by[1], by[2]); }

const KeyBox kBounds{key_at(-13, -10, -5), key_at(14, 12, 11)};

// Free space with walls, specks and unknown pockets, on a floor with gaps.
VoxelGrid random_map(std::uint64_t seed, double resolution, int specks) {
  Random random(seed);
  VoxelGrid grid(resolution);
  for_each_key(kBounds, [&](const VoxelKey& key) {
    const Occupancy most = key.z < Lattice::kOrigin ? Occupancy::kOccupied : Occupancy::kFree;
    grid.set(key, random.one_in(key.z < Lattice::kOrigin ? 9 : specks) ? random.state() : most);
  });
  return grid;
}

// What a cell needs, voxel by voxel: its box from `low` to `high`, and a floor.
struct Rule {
  int low[3], high[3];
  int stride = 1;
  int lowest = std::numeric_limits<int>::min();  // key along z
  int ground = -1;                               // floor voxels beside the middle that must not be free
  std::vector<KeyBox> without_ground;
  std::vector<KeyBox> kept_out = {};
  int down = 0;   // layers from the cell to its floor, if it is not below the box
  int climb = 0;  // [voxels] that ground may rise and fall under the box, if it need not be flat

  [[nodiscard]] bool passable(const VoxelGrid& grid, const VoxelKey& cell, bool plane) const {
    KeyBox inside = kBounds;
    if (plane) inside.min.z = 0, inside.max.z = 65535;
    const KeyBox box{moved(cell, low), moved(cell, high)};
    const bool fits =
        all_of(box, [&](const VoxelKey& v) { return inside.contains(v) && grid.at(v) == Occupancy::kFree; });
    if (cell.z < lowest || !fits) return false;
    for (const KeyBox& box_of_others : kept_out)
      if (box_of_others.contains(cell)) return false;
    if (ground < 0) return true;
    if (climb > 0) return is_on_ground(grid, cell);
    const VoxelKey below = moved(cell, 0, 0, low[2] - 1);
    const auto is_hole = [&](const VoxelKey& v) {
      const auto floor = [&](int x, int y) { return grid.at(moved(v, x, y, 0)) == Occupancy::kOccupied; };
      return grid.at(v) == Occupancy::kFree && !(floor(-1, 0) && floor(1, 0)) &&
             !(floor(0, -1) && floor(0, 1));
    };
    const auto is = [&](Occupancy state) {
      return [&grid, state](const VoxelKey& v) { return grid.at(v) == state; };
    };
    const auto any = [](const KeyBox& floor, const auto& holds) {
      return !all_of(floor, [&](const VoxelKey& v) { return !holds(v); });
    };
    for (const KeyBox& exempt : without_ground)
      if (exempt.contains({cell.x, cell.y, exempt.min.z}))
        return !all_of(grown({below, below}, 1, 1, 0), is_hole);
    return any(grown({below, below}, 1, 1, 0), is(Occupancy::kOccupied)) &&
           !any(grown({below, below}, ground, ground, 0), is_hole);
  }
  [[nodiscard]] bool is_on_ground(const VoxelGrid& grid, const VoxelKey& cell) const;
};

// As in `Rule::passable`, of a robot that climbs a voxel: ground is what has nothing on top of it.
bool Rule::is_on_ground(const VoxelGrid& grid, const VoxelKey& cell) const {
  const auto is = [&](const VoxelKey& v, Occupancy state) {
    return kBounds.contains(v) && grid.at(v) == state;
  };
  const VoxelKey floor = moved(cell, 0, 0, -down);
  if (!kBounds.contains(floor)) return false;
  const auto has_ground = [&](const VoxelKey& v) {
    bool has = false;
    for (int z = -climb; z <= climb; ++z) has = has || is(moved(v, 0, 0, z), Occupancy::kOccupied);
    return has && kBounds.contains(v);
  };
  const auto is_open = [&](const VoxelKey& v) { return is(v, Occupancy::kFree) && !has_ground(v); };
  const auto is_hole = [&](const VoxelKey& v) {  // its steps are one voxel
    return is_open(v) && !(has_ground(moved(v, -1, 0, 0)) && has_ground(moved(v, 1, 0, 0))) &&
           !(has_ground(moved(v, 0, -1, 0)) && has_ground(moved(v, 0, 1, 0)));
  };
  const auto is_ground = [&](const VoxelKey& v) {
    return is(v, Occupancy::kOccupied) && !is(moved(v, 0, 0, 1), Occupancy::kOccupied);
  };
  for (const KeyBox& exempt : without_ground)
    if (exempt.contains(cell))
      return all_of(grown({floor, floor}, ground, ground, 0), [&](const VoxelKey& v) {
        return !is_open(v) || !is(moved(v, 0, 0, -1), Occupancy::kFree);
      });
  return all_of(grown({floor, floor}, ground, ground, 0), [&](const VoxelKey& v) { return !is_hole(v); }) &&
         !all_of(grown({floor, floor}, 1, 1, 0), [&](const VoxelKey& v) { return !is_ground(v); });
}

struct Robot {
  TravelOptions options;
  double resolution;
  Rule rule;
  VoxelKey at;
};

void expect_as_defined(const TravelCorridor& corridor, const VoxelGrid& grid, const Robot& robot) {
  const bool plane = robot.options.motion == Motion::kPlane;
  std::set<VoxelKey> open;
  for_each_key(kBounds, [&](const VoxelKey& key) {
    if (plane && key.z != robot.at.z) return;
    if (robot.rule.stride > 1 && corridor.cell_of(key) != key) return;
    if (robot.rule.passable(grid, key, plane)) open.insert(key);
  });
  const VoxelKey start = corridor.cell_of(robot.at);
  const auto expected = test::dijkstra(open, start, robot.rule.stride, robot.options.metric);
  for_each_key(kBounds, [&](const VoxelKey& key) { ASSERT_EQ(corridor.passable(key), open.contains(key)); });
  ASSERT_EQ(corridor.state() == CorridorState::kReady, open.contains(start));
  ASSERT_EQ(corridor.cells().size(), expected.size());
  auto cell = corridor.cells().begin();
  for (const auto& [key, distance] : expected) {
    ASSERT_EQ(*cell++, key);
    ASSERT_EQ(corridor.distance(key), distance / 985.0 * robot.rule.stride * robot.resolution);
    if (distance % 7 != 0) continue;
    const auto path = corridor.path_to(key);
    ASSERT_FALSE(path.empty());
    ASSERT_EQ(path.front(), start);
    ASSERT_EQ(path.back(), key);
  }
}

// Boxes by hand, from the documented rule.
std::vector<Robot> robots() {
  std::vector<Robot> robots;
  TravelOptions ugv = ugv_travel();
  ugv.without_ground = {{key_at(-2, -2, -5), key_at(2, 2, 5)}};
  robots.push_back({ugv, 0.3, {{-2, -2, -2}, {2, 2, 0}, 1, 0, 1, ugv.without_ground}, key_at(0, 0, 2)});
  TravelOptions whole = ugv;
  whole.ground_extents.reset();
  robots.push_back({whole, 0.3, {{-2, -2, -2}, {2, 2, 0}, 1, 0, 2, ugv.without_ground}, key_at(0, 0, 2)});
  robots.push_back({ugv, 0.4, {{-1, -1, -1}, {1, 1, 0}, 1, 0, 1, ugv.without_ground}, key_at(0, 0, 1)});
  ugv.extents = {0.9, 0.2, 0.9};  // as wide as three voxels, and higher than its sensor
  ugv.sensor_height = 0.3;
  ugv.ground_extents = Eigen::Vector2d(0.3, 0.3);
  ugv.metric = PathMetric::kSteps;
  Rule narrow{{-1, 0, -1}, {1, 0, 1}, 1, 0, 1, ugv.without_ground};
  ugv.require_ground = false;
  narrow.ground = -1;
  robots.push_back({ugv, 0.3, narrow, key_at(0, 0, 1)});
  ugv.extents = {0.1, 0.1, 0.1};  // far below its sensor
  ugv.sensor_height = 0.75;
  robots.push_back({ugv, 0.3, {{0, 0, -2}, {0, 0, 0}, 1, 0, -1, {}}, key_at(0, 0, 2)});
  // 1.0 x 1.0 m with their margin, and no higher than without.
  TravelOptions with_margin = robots[0].options;
  with_margin.extents = {0.7, 0.7, 0.7};
  with_margin.margin = 0.15;
  robots.push_back({with_margin, 0.3, robots[0].rule, key_at(0, 0, 2)});
  // 0.6 m of slope rise half a voxel, and so a whole one; the sensor's voxel is the third above the floor.
  TravelOptions climbing;
  climbing.motion = Motion::kGround;
  climbing.extents = {0.6, 0.2, 0.6};
  climbing.ground_extents = Eigen::Vector2d(0.6, 0.5);
  climbing.sensor_height = 0.5;
  climbing.step = 0.2;
  climbing.without_ground = {{key_at(-2, -2, 2), key_at(2, 2, 2)}};
  robots.push_back(
      {climbing, 0.2, {{-1, 0, -1}, {1, 0, 0}, 1, 0, 1, climbing.without_ground, {}, 3, 1}, key_at(0, 0, 2)});
  TravelOptions uav = uav_travel();
  robots.push_back({uav, 0.3, {{-1, -1, -1}, {1, 1, 1}, 1, 32768 + 4, -1, {}}, key_at(0, 0, 6)});
  uav.extents = {0.2, 0.1, 0.4};
  uav.margin = 0.2;  // 0.6 m, 0.5 m, 0.8 m
  robots.push_back({uav, 0.3, {{-1, -1, -1}, {1, 1, 1}, 1, 32768 + 4, -1, {}}, key_at(0, 0, 6)});
  uav = uav_travel();
  robots.push_back({uav, 0.3, {{-1, -1, -1}, {1, 1, 1}, 1, 32768 + 4, -1, {}}, key_at(0, 0, 6)});
  uav.min_height = 0.3 * 2 + 0.15;  // a centre: just high enough
  uav.extents = {0.3, 0.31, 1.0};
  robots.push_back({uav, 0.3, {{0, -1, -2}, {0, 1, 2}, 1, 32768 + 2, -1, {}}, key_at(0, 0, 5)});
  uav.metric = PathMetric::kSteps;
  uav.floor = -0.6;
  robots.push_back({uav, 0.3, {{0, -1, -2}, {0, 1, 2}, 1, 32768, -1, {}}, key_at(0, 0, 5)});
  TravelOptions nodes = uav_node_travel();
  nodes.min_height = 0.6;
  robots.push_back({nodes, 0.3, {{-2, -2, -2}, {1, 1, 1}, 4, 32768 + 2, -1, {}}, key_at(1, 1, 3)});
  nodes.node_edge = 0.9;  // four voxels again
  robots.push_back({nodes, 0.3, {{-2, -2, -2}, {1, 1, 1}, 4, 32768 + 2, -1, {}}, key_at(1, 1, 3)});
  nodes.metric = PathMetric::kSteps;
  robots.push_back({nodes, 0.5, {{-1, -1, -1}, {0, 0, 0}, 2, 32768 + 2, -1, {}}, key_at(1, 1, 3)});
  return robots;
}

// The box around the robot free, so that there is a corridor more often than not.
void clear_around(VoxelGrid& grid, const Robot& robot, const TravelCorridor& corridor) {
  const VoxelKey cell = corridor.cell_of(robot.at);
  test::fill(grid, {moved(cell, robot.rule.low), moved(cell, robot.rule.high)}, Occupancy::kFree);
}

TEST(TravelCorridor, IsWhatItsDefinitionSays) {
  std::size_t cells = 0;
  int number = 0;
  for (const Robot& robot : robots()) {
    ++number;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "robot " << number << " seed " << seed);
      VoxelGrid grid = random_map(seed, robot.resolution, seed % 2 == 0 ? 40 : 400);
      TravelCorridor corridor(robot.options, grid.lattice(), kBounds);
      clear_around(grid, robot, corridor);
      corridor.update({grid}, robot.at);
      expect_as_defined(corridor, grid, robot);
      if (testing::Test::HasFatalFailure()) return;
      cells += corridor.cells().size();
    }
  }
  EXPECT_GT(cells, 10'000U);
}

TEST(TravelCorridor, EqualsANewCorridorAfterEveryChange) {
  for (const Robot& robot : robots()) {
    Random random(7);
    VoxelGrid grid = random_map(3, robot.resolution, 300);
    TravelCorridor corridor(robot.options, grid.lattice(), kBounds);
    Robot here = robot;
    for (int step = 0; step < 25; ++step) {
      std::vector<VoxelKey> changed;
      for (int n = random.below(60); n >= 0; --n) {
        const VoxelKey key = key_at(random.below(40) - 20, random.below(40) - 20, random.below(25) - 8);
        const Occupancy state = random.one_in(3) ? random.state() : Occupancy::kFree;
        if (grid.at(key) != state || random.one_in(10)) changed.push_back(key);
        grid.set(key, state);
      }
      const auto& cells = corridor.cells();
      if (!cells.empty() && random.one_in(2)) here.at = random.pick(cells);
      if (random.one_in(10)) here.at = moved(here.at, 0, 0, random.one_in(2) ? 1 : -1);
      corridor.update({grid, changed}, here.at);
      TravelCorridor fresh(robot.options, grid.lattice(), kBounds);
      fresh.update({grid}, here.at);
      ASSERT_EQ(corridor.state(), fresh.state());
      ASSERT_TRUE(std::ranges::equal(corridor.cells(), fresh.cells()));
      for_each_key(kBounds, [&](const VoxelKey& key) {
        ASSERT_EQ(corridor.passable(key), fresh.passable(key));
        ASSERT_EQ(corridor.distance(key), fresh.distance(key));
      });
    }
  }
}

// Who follows the map looks at so many cells around what has changed.
TEST(TravelCorridor, NoVoxelDecidesBeyondItsReach) {
  for (const Robot& robot : robots()) {
    Random random(8);
    VoxelGrid grid = random_map(5, robot.resolution, 60);
    TravelCorridor corridor(robot.options, grid.lattice(), kBounds);
    const auto [x, y, z] = detail::deciding_reach(robot.options, robot.resolution);
    const auto fitting = [&] {
      std::set<VoxelKey> cells;
      for_each_key(kBounds, [&](const VoxelKey& key) {
        if (corridor.fits(key)) cells.insert(key);
      });
      return cells;
    };
    corridor.update({grid}, robot.at);
    std::set<VoxelKey> before = fitting();
    for (int step = 0; step < 60; ++step) {
      const VoxelKey changed = random.key_in(kBounds);
      grid.set(changed, random.state());
      corridor.update({grid, {&changed, 1}}, robot.at);
      const std::set<VoxelKey> now = fitting();
      std::vector<VoxelKey> different;
      std::ranges::set_symmetric_difference(before, now, std::back_inserter(different));
      const KeyBox around = grown({changed, changed}, x, y, z);
      for (const VoxelKey& cell : different) ASSERT_TRUE(around.contains(cell));
      before = now;
    }
  }
}

// Near by the same as with all cells, as far as the paths do not lead away and back.
TEST(TravelCorridor, KnowsTheSameNearBy) {
  std::size_t near = 0, none = 0;
  for (const Robot& robot : robots()) {
    Random random(9);
    VoxelGrid grid = random_map(4, robot.resolution, 60);
    TravelCorridor all(robot.options, grid.lattice(), kBounds), some(robot.options, grid.lattice(), kBounds);
    clear_around(grid, robot, all);
    all.update({grid}, robot.at);
    some.update({grid}, robot.at, CorridorExtent::kNearby);
    EXPECT_EQ(some.extent(), CorridorExtent::kNearby);
    EXPECT_EQ(some.state(), all.state());
    EXPECT_TRUE(some.cells().empty());
    for_each_key(kBounds, [&](const VoxelKey& key) {
      ASSERT_EQ(some.passable(key), all.passable(key));
      ASSERT_EQ(some.distance(key), all.distance(key)) << "all are near";
    });
    const auto anywhere = [](const VoxelKey&) { return true; };
    for (int i = 0; i < 40; ++i) {
      const VoxelKey goal = random.key_in(kBounds);
      EXPECT_EQ(some.find_path(goal, anywhere), all.contains(goal));
      EXPECT_EQ(some.path_to(goal).size(), all.path_to(goal).size());
      near += all.contains(goal) ? 1 : 0;
      none += all.contains(goal) ? 0 : 1;
    }
  }
  EXPECT_GT(near, 80U);
  EXPECT_GT(none, 80U);
}

// What lies on the far side of a robot's cell in a box, where it may come no nearer: as seen from the box's
// nearest face.
std::vector<VoxelKey> far_side(const KeyBox& box, const VoxelKey& own, bool drives) {
  const auto axis = [](const VoxelKey& key, int a) { return a == 0 ? key.x : a == 1 ? key.y : key.z; };
  int nearest = 1 << 16, along = 0, side = 0;
  for (int a = 0; a < (drives ? 2 : 3); ++a)
    for (const int s : {-1, 1}) {
      const int distance = std::abs(axis(s < 0 ? box.min : box.max, a) - axis(own, a));
      if (distance < nearest) nearest = distance, along = a, side = s;
    }
  std::vector<VoxelKey> cells;
  for_each_key(box, [&](const VoxelKey& key) {
    if (side * (axis(key, along) - axis(own, along)) < 0) cells.push_back(key);
  });
  return cells;
}

// The boxes of the last call; of those that hold the robot's own cell, what lies behind it.
TEST(TravelCorridor, KeepsOutOfBoxes) {
  std::size_t cells = 0, behind = 0;
  for (const Robot& robot : robots()) {
    Random random(5);
    VoxelGrid grid = random_map(2, robot.resolution, 400);
    TravelCorridor corridor(robot.options, grid.lattice(), kBounds);
    clear_around(grid, robot, corridor);
    corridor.update({grid}, robot.at);
    for (int step = 0; step < 6; ++step) {
      std::vector<KeyBox> boxes;
      for (int n = random.below(4); n > 0; --n) {
        const VoxelKey low = random.key_in(kBounds);
        boxes.push_back({low, moved(low, random.below(6), random.below(6), random.below(6))});
      }
      const std::size_t before = corridor.cells().size();
      corridor.keep_out_of(boxes);
      EXPECT_EQ(corridor.cells().size(), before) << "until the next update";
      corridor.update({grid}, robot.at);
      Robot expected = robot;
      const VoxelKey own = corridor.cell_of(robot.at);
      boxes.push_back(grown({own, own}, 0));
      if (step % 2 == 0)
        boxes.back() = {moved(own, -random.below(4), -random.below(4), -random.below(4)),
                        moved(own, random.below(4), random.below(4), random.below(4))};
      corridor.keep_out_of(boxes);
      corridor.update({grid}, robot.at);
      for (const KeyBox& box : boxes) {
        if (!box.contains(own)) {
          expected.rule.kept_out.push_back(box);
          continue;
        }
        for (const VoxelKey& cell : far_side(box, own, robot.options.drives())) {
          expected.rule.kept_out.push_back({cell, cell});
          ++behind;
        }
      }
      expect_as_defined(corridor, grid, expected);
      if (testing::Test::HasFatalFailure()) return;
      cells += corridor.cells().size();
    }
    const KeyBox own{corridor.cell_of(robot.at), corridor.cell_of(robot.at)};
    corridor.keep_out_of({own});
    corridor.update({grid}, robot.at);
    expect_as_defined(corridor, grid, robot);
  }
  EXPECT_GT(cells, 5'000U);
  EXPECT_GT(behind, 100U);
}

// A body with a margin is one that is larger by it, also off the middle of a cell.
TEST(TravelCorridor, MarginIsAsIfTheBodyWereLarger) {
  const Lattice lattice(0.1);
  for (const double margin : {0.0, 0.03, 0.05, 0.12}) {
    TravelOptions slim = uav_travel(), wide = uav_travel();
    slim.extents = {0.4, 0.5, 0.33};
    slim.margin = margin;
    wide.extents = slim.extents + Eigen::Vector3d::Constant(2 * margin);
    EXPECT_EQ(slim.box(), wide.extents);
    const Eigen::Vector3d reach = BodyStencil(slim, 0.1).reach(), of_wide = BodyStencil(wide, 0.1).reach();
    EXPECT_LT((reach - of_wide).norm(), 1e-12);
    EXPECT_EQ(voxels_of_cell(slim, lattice, key_at(0, 0, 9)), voxels_of_cell(wide, lattice, key_at(0, 0, 9)));
    EXPECT_EQ(body_of(slim).sizes(), slim.extents);
    TravelOptions low = ugv_travel();
    low.margin = margin;
    EXPECT_EQ(low.box(), low.extents + Eigen::Vector3d(2 * margin, 2 * margin, 0.0));
    // The body stands on the floor, its sensor at the origin.
    EXPECT_NEAR(body_of(low).min().z(), -low.sensor_height, 1e-12);
    EXPECT_NEAR(body_of(low).max().z(), low.extents.z() - low.sensor_height, 1e-12);
  }
}

TEST(TravelCorridor, HasReasonsForHavingNoCells) {
  VoxelGrid grid(0.3);
  TravelCorridor corridor(uav_travel(), grid.lattice(), kBounds);
  EXPECT_EQ(corridor.state(), CorridorState::kNotUpdated);
  EXPECT_TRUE(corridor.cells().empty());
  EXPECT_FALSE(corridor.passable(key_at(0, 0, 6)));
  EXPECT_TRUE(corridor.path_to(key_at(0, 0, 6)).empty());
  const auto state = [&](const VoxelKey& robot) {
    TravelCorridor fresh(uav_travel(), grid.lattice(), kBounds);
    fresh.update({grid}, robot);
    EXPECT_EQ(fresh.cells().empty(), fresh.state() != CorridorState::kReady);
    EXPECT_FALSE(describe(fresh.state()).empty());
    return fresh.state();
  };
  EXPECT_EQ(state(key_at(0, 0, 6)), CorridorState::kUnknown);
  grid.set(key_at(0, 0, 6), Occupancy::kOccupied);
  EXPECT_EQ(state(key_at(0, 0, 6)), CorridorState::kOccupied);
  grid.set(key_at(0, 0, 6), Occupancy::kFree);
  EXPECT_EQ(state(key_at(0, 0, 6)), CorridorState::kBoxNotFree);
  test::fill(grid, kBounds, Occupancy::kFree);
  EXPECT_EQ(state(key_at(0, 0, 6)), CorridorState::kReady);
  EXPECT_EQ(state(key_at(0, 0, 3)), CorridorState::kTooLow);
  EXPECT_EQ(state(key_at(40, 0, 6)), CorridorState::kOutside);
  EXPECT_EQ(state({0, 0, 0}), CorridorState::kOutside);
  EXPECT_EQ(state({65535, 65535, 65535}), CorridorState::kOutside);
}

TEST(TravelCorridor, WorksAtTheEndsOfTheKeyRange) {
  VoxelGrid grid(0.3);
  const KeyBox corner{{0, 0, 0}, {9, 9, 9}};
  test::fill(grid, corner, Occupancy::kFree);
  TravelOptions options = uav_travel();
  options.floor = -1e9;
  TravelCorridor corridor(options, grid.lattice(), corner);
  corridor.update({grid}, {5, 5, 5});
  EXPECT_EQ(corridor.cells().size(), 512U);
  EXPECT_EQ(corridor.cells()[0], (VoxelKey{1, 1, 1}));
  TravelCorridor ugv(ugv_travel(), grid.lattice(), corner);
  ugv.update({grid}, {5, 5, 1});  // its box would stand below the key range
  EXPECT_EQ(ugv.state(), CorridorState::kBoxNotFree);
  ugv.update({grid}, {5, 5, 2});  // and here its floor lies there
  EXPECT_EQ(ugv.state(), CorridorState::kWithoutGround);
}

TEST(TravelCorridor, RefusesOptionsThatAreNotValid) {
  const Lattice lattice(0.3);
  const auto refuses = [&](auto change, TravelOptions options) {
    change(options);
    EXPECT_REFUSED(TravelCorridor(options, lattice, kBounds));
  };
  const double nan = std::nan("");
  for (const double bad : {-1.0, 0.0, nan, 1e9})
    for (const int axis : {0, 1, 2}) refuses([&](TravelOptions& o) { o.extents[axis] = bad; }, uav_travel());
  for (const double bad : {-1.0, nan, 1e9})
    refuses([&](TravelOptions& o) { o.sensor_height = bad; }, ugv_travel());
  for (const double bad : {-0.1, nan, 1e9}) refuses([&](TravelOptions& o) { o.margin = bad; }, uav_travel());
  refuses([](TravelOptions& o) { o.ground_reach = -1; }, ugv_travel());
  refuses([](TravelOptions& o) { o.ground_extents = Eigen::Vector2d(-1, 1); }, ugv_travel());
  refuses([](TravelOptions& o) { o.node_edge = 1.2; }, ugv_travel());
  refuses([&](TravelOptions& o) { o.floor = nan; }, uav_travel());
  refuses([&](TravelOptions& o) { o.min_height = 1 / 0.0; }, uav_travel());
  for (const double bad : {-1.0, 0.5, nan, 1e9})
    refuses([&](TravelOptions& o) { o.node_edge = bad; }, uav_travel());
  TravelOptions steep = ugv_travel();
  steep.motion = Motion::kGround;
  steep.step = 0.3;
  steep.slope = 1.5;
  EXPECT_EQ(test::complaint_of([&] { TravelCorridor(steep, lattice, kBounds); }),
            "travel corridor: slope is 1.500000 rad, but has to be from 0 to 1.396263 rad");
  EXPECT_REFUSED(TravelCorridor(uav_travel(), lattice, {key_at(1, 0, 0), key_at(0, 0, 0)}));
  EXPECT_REFUSED(TravelCorridor(uav_travel(), lattice, kAllVoxels));
  TravelCorridor corridor(uav_travel(), lattice, kBounds);
  EXPECT_REFUSED(corridor.update({VoxelGrid(0.1)}, key_at(0, 0, 6)));
}

}  // namespace
}  // namespace frontlux::planner
