#include "tour/travel_graph.hpp"

#include "corridor/path_search.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"
#include "tour/graph_distances.hpp"

#include <array>

namespace frontlux::planner::detail {
namespace {

using test::Random;
using Keys = std::vector<VoxelKey>;

constexpr double kResolution = 0.2;
constexpr KeyBox kBounds{{32760, 32760, 32768}, {32795, 32790, 32779}};

TravelOptions flying_cube() {
  TravelOptions options;
  options.extents = {0.2, 0.2, 0.2};
  options.min_height = -100.0;
  return options;
}

// Free space with random walls, which have random doors.
VoxelGrid random_rooms(Random& random) {
  VoxelGrid grid(kResolution);
  test::fill(grid, kBounds, Occupancy::kFree);
  for (int i = 0; i < 6; ++i) {
    KeyBox wall = kBounds;
    const VoxelKey at = random.key_in(kBounds);
    if (random.one_in(2))
      wall.min.x = wall.max.x = at.x;
    else
      wall.min.y = wall.max.y = at.y;
    test::fill(grid, wall, Occupancy::kOccupied);
  }
  for (int i = 0; i < 8; ++i)
    if (const auto door = intersection(grown({random.key_in(kBounds), random.key_in(kBounds)}, 0), kBounds);
        door)
      test::fill(grid, intersection(cube(door->min, 3), kBounds).value(), Occupancy::kFree);
  return grid;
}

VoxelKey free_key(Random& random, const VoxelGrid& grid) {
  for (;;)
    if (const VoxelKey key = random.key_in(kBounds); grid.at(key) == Occupancy::kFree) return key;
}

void expect_same(const TravelGraph& a, const TravelGraph& b) {
  ASSERT_EQ(a.size(), b.size());
  for_each_key(kBounds, [&](const VoxelKey& key) { EXPECT_EQ(a.node(key), b.node(key)); });
  EXPECT_EQ(a.spread_cells(kBounds), b.spread_cells(kBounds));
  if (a.size() > 0) {
    EXPECT_EQ(a.distances(0), b.distances(0));
  }
}

TEST(TravelGraph, ConnectsWhatTheCorridorConnects) {
  Random random(51);
  for (int round = 0; round < 30; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    const VoxelKey robot = free_key(random, grid);
    corridor.update({grid}, robot);
    TravelGraph graph(grid.lattice(), kBounds, 1 + random.below(9), 3);
    graph.update(corridor, {{kBounds}});
    const auto from = graph.node(robot);
    ASSERT_TRUE(from);
    const std::vector<double> distances = graph.distances(*from);
    for_each_key(kBounds, [&](const VoxelKey& key) {
      const auto node = graph.node(key);
      EXPECT_EQ(node.has_value(), corridor.fits(key));
      EXPECT_EQ(node && distances[*node] != TourProblem::kNever, corridor.contains(key));
    });
  }
}

TEST(TravelGraph, KnowsAboutHowFarItIs) {
  Random random(52);
  double sum = 0.0, exact_sum = 0.0;
  for (int round = 0; round < 20; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    const VoxelKey robot = free_key(random, grid);
    corridor.update({grid}, robot);
    constexpr int kEdge = 4;
    TravelGraph graph(grid.lattice(), kBounds, kEdge, 2);
    graph.update(corridor, {{kBounds}});
    const std::vector<double> distances = graph.distances(graph.node(robot).value());
    constexpr double kCube = kEdge * kResolution * 1.7321;  // [m] its diagonal
    for (const VoxelKey& cell : corridor.cells()) {
      const double exact = corridor.distance(cell).value(), about = distances[graph.node(cell).value()];
      EXPECT_LT(about, 1.5 * exact + 2 * kCube);
      EXPECT_GT(about, 0.6 * exact - 2 * kCube);
      sum += about;
      exact_sum += exact;
    }
  }
  EXPECT_NEAR(sum / exact_sum, 1.0, 0.15);
}

TEST(TravelGraph, MeasuresTheNearestNodesOnly) {
  Random random(56);
  std::size_t fewer = 0;
  for (int round = 0; round < 30; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    corridor.update({grid}, free_key(random, grid));
    TravelGraph graph(grid.lattice(), kBounds, 2 + random.below(4), 2);
    graph.update(corridor, {{kBounds}});
    const auto from = static_cast<std::uint32_t>(random.below(static_cast<int>(graph.size())));
    const auto count = static_cast<std::size_t>(1 + random.below(60));
    const std::vector<double> all = graph.distances(from);
    // From others before, so that nothing is left of their search.
    std::vector<TravelGraph::Near> places{
        {0, {}}, {static_cast<std::uint32_t>(all.size() - 1), {}}, {from, {}}};
    graph.measure(places, count);
    const auto& near = places.back().distances;
    const auto number = [&](TravelGraph::Name name) {
      std::uint32_t node = 0;
      while (graph.name_of(node) != name) ++node;
      return node;
    };
    double farthest = 0.0;
    std::vector<bool> is_near(all.size());
    for (const TravelGraph::Distance& distance : near) {
      EXPECT_EQ(distance.length, all[number(distance.to)]);
      farthest = std::max(farthest, distance.length);
      is_near[number(distance.to)] = true;
    }
    const auto reached = all.size() - static_cast<std::size_t>(std::ranges::count(all, TourProblem::kNever));
    EXPECT_GE(near.size(), std::min(count, reached));
    for (std::size_t node = 0; node < all.size(); ++node) EXPECT_TRUE(is_near[node] || all[node] >= farthest);
    fewer += near.size() < reached ? 1 : 0;
    // No way is shorter by way of a third node.
    for (const auto& [middle, length] : near) {
      const std::vector<double> on = graph.distances(number(middle));
      for (std::size_t node = 0; node < all.size(); ++node) EXPECT_LE(all[node], length + on[node] + 1e-9);
    }
  }
  EXPECT_GT(fewer, 10U);
}

TEST(TravelGraph, EqualsANewOneAfterChanges) {
  Random random(53);
  VoxelGrid grid = random_rooms(random);
  const VoxelKey robot = make_key(32770, 32770, 32772);
  grid.set(robot, Occupancy::kFree);
  TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
  corridor.update({grid}, robot);
  TravelGraph kept(grid.lattice(), kBounds, 5, 2);
  kept.update(corridor, {{kBounds}});
  std::size_t same = 0, others = 0, gone = 0;  // ways before and after a change
  for (int round = 0; round < 40; ++round) {
    std::vector<TravelGraph::Near> before;
    std::vector<TravelGraph::Name> names;
    for (std::uint32_t node = 0; node < kept.size(); node += 3) {
      before.push_back({node, {}});
      names.push_back(kept.name_of(node));
    }
    const std::size_t count = std::array{12, 40, 10'000}.at(static_cast<std::size_t>(round % 3));
    kept.measure(before, count);
    Keys changed;
    std::vector<KeyBox> boxes;
    for (int i = 0; i < 1 + random.below(4); ++i) {
      const KeyBox box = *intersection(cube(random.key_in(kBounds), 1 + random.below(4)), kBounds);
      const Occupancy state = random.one_in(2) ? Occupancy::kFree : Occupancy::kOccupied;
      test::fill(grid, box, state);
      for_each_key(box, [&](const VoxelKey& key) { changed.push_back(key); });
      boxes.push_back(grown(box, 1));
    }
    grid.set(robot, Occupancy::kFree);
    changed.push_back(robot);
    boxes.push_back({robot, robot});
    corridor.update({grid, changed}, robot);
    kept.update(corridor, boxes);
    TravelGraph anew(grid.lattice(), kBounds, 5, 2);
    anew.update(corridor, {{kBounds}});
    expect_same(kept, anew);
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::uint32_t node = 0;
      while (node < anew.size() && anew.name_of(node) != names[i]) ++node;
      const bool has_changed = std::ranges::any_of(
          before[i].distances,
          [&](const TravelGraph::Distance& distance) { return kept.has_changed(distance.to); });
      if (node == anew.size()) {
        EXPECT_TRUE(has_changed);
        ++gone;
        continue;
      }
      TravelGraph::Near expected{node, {}}, mended{node, before[i].distances};
      anew.measure({&expected, 1}, count);
      kept.measure({&mended, 1}, count);
      EXPECT_EQ(mended.distances, expected.distances);
      if (!has_changed) {
        EXPECT_EQ(before[i].distances, expected.distances);
      }
      ++(before[i].distances == expected.distances ? same : others);
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(same, 50U);
  EXPECT_GT(others, 500U);
  EXPECT_GT(gone, 5U);
}

TEST(GraphDistances, OfAllPairsAreThoseOfEachPair) {
  Random random(57);
  std::size_t near = 0, far = 0;
  for (int round = 0; round < 10; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    corridor.update({grid}, free_key(random, grid));
    GraphDistances distances(grid.lattice(), TravelGraph(grid.lattice(), kBounds, 4, 2), 40);
    distances.update(corridor, {{kBounds}});
    Keys measured;
    std::vector<std::optional<VoxelKey>> cells;
    for (int i = 0; i < 25; ++i) {
      cells.emplace_back();
      if (random.one_in(8)) continue;
      cells.back() = free_key(random, grid);
      measured.push_back(*cells.back());
    }
    distances.measure_from(measured);
    const NumberTable all = distances.between(cells);
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const bool both = cells[i] && cells[j];
        EXPECT_EQ(all(i, j), both ? distances.between(*cells[i], *cells[j]) : TourProblem::kNever);
        ++(all(i, j) == TourProblem::kNever ? far : near);
      }
  }
  EXPECT_GT(near, 100U);
  EXPECT_GT(far, 100U);
}

TEST(TravelGraph, SpreadsCellsOverAllParts) {
  Random random(54);
  std::size_t places = 0, some = 0, fewer = 0;
  for (int round = 0; round < 20; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    corridor.update({grid}, free_key(random, grid));
    const int edge = 2 + random.below(7), spacing = 1 + random.below(4);
    TravelGraph graph(grid.lattice(), kBounds, edge, spacing);
    graph.update(corridor, {{kBounds}});
    const KeyBox box = hull(cube(random.key_in(kBounds), 1), cube(random.key_in(kBounds), 1));
    const Keys cells = graph.spread_cells(box);
    // Those of the whole map that lie in the box.
    const Keys all = graph.spread_cells(kBounds);
    Keys inside = all;
    std::erase_if(inside, [&](const VoxelKey& cell) { return !box.contains(cell); });
    EXPECT_EQ(cells, inside);
    some += cells.empty() ? 0 : 1;
    fewer += cells.size() < all.size() ? 1 : 0;
    EXPECT_TRUE(std::ranges::all_of(all, [&](const VoxelKey& cell) { return graph.node(cell).has_value(); }));
    // Each place of the map is near a cell of its part.
    for_each_key(kBounds, [&](const VoxelKey& key) {
      const auto node = graph.node(key);
      if (!node) return;
      ++places;
      const KeyBox near = grown({key, key}, spacing - 1);
      EXPECT_TRUE(std::ranges::any_of(
          all, [&](const VoxelKey& cell) { return near.contains(cell) && graph.node(cell) == node; }));
    });
  }
  EXPECT_GT(places, 20'000U);
  EXPECT_GT(some, 15U);
  EXPECT_GT(fewer, 15U);
}

// The nodes that have cells beside those of each node.
std::vector<std::set<std::uint32_t>> touching_nodes(const TravelGraph& graph) {
  std::vector<std::set<std::uint32_t>> touching(graph.size());
  for_each_key(kBounds, [&](const VoxelKey& key) {
    const auto node = graph.node(key);
    for (int axis = 0; axis < 3; ++axis) {
      const auto next = graph.node(*offset_key(key, axis == 0, axis == 1, axis == 2));
      if (!node || !next || node == next) continue;
      touching[*node].insert(*next);
      touching[*next].insert(*node);
    }
  });
  return touching;
}

TEST(TravelGraph, FindsTheCellsAroundAPath) {
  Random random(55);
  std::size_t fewer = 0;
  for (int round = 0; round < 30; ++round) {
    const VoxelGrid grid = random_rooms(random);
    TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
    const VoxelKey robot = free_key(random, grid);
    corridor.update({grid}, robot);
    TravelGraph graph(grid.lattice(), kBounds, 4, 2);
    graph.update(corridor, {{kBounds}});
    const VoxelKey goal = random.pick(corridor.cells());
    const std::vector<double> lengths = graph.distances(graph.node(robot).value());
    const auto nodes = graph.around_path(lengths, graph.node(goal).value());
    const auto back = graph.path_back(lengths, graph.node(goal).value());
    EXPECT_EQ(back.front(), graph.node(goal));
    EXPECT_EQ(back.back(), graph.node(robot));
    const auto touching = touching_nodes(graph);
    for (std::size_t i = 0; i < back.size(); ++i) {
      EXPECT_TRUE(std::ranges::binary_search(nodes, back[i]));
      EXPECT_TRUE(std::ranges::includes(nodes, touching[back[i]]));
      EXPECT_EQ(graph.node(graph.middle_cell(back[i])), back[i]);
      if (i > 0) {
        EXPECT_LT(lengths[back[i]], lengths[back[i - 1]]);
      }
    }
    fewer += nodes.size() < graph.size() ? 1 : 0;
    const CellFrame frame{kBounds.min,
                          {kBounds.max.x - kBounds.min.x + 1, kBounds.max.y - kBounds.min.y + 1,
                           kBounds.max.z - kBounds.min.z + 1}};
    const auto path = shortest_path(frame, PathMetric::kEuclidean, robot, goal, [&](const VoxelKey& cell) {
      return corridor.passable(cell) && std::ranges::binary_search(nodes, graph.node(cell).value());
    });
    EXPECT_FALSE(path.empty());
  }
  EXPECT_GT(fewer, 15U);
}

// Where another robot is does not matter: it will go on.
TEST(TravelGraph, DoesNotCareForOtherRobots) {
  VoxelGrid grid(kResolution);
  test::fill(grid, kBounds, Occupancy::kFree);
  const VoxelKey robot = kBounds.min;
  TravelCorridor corridor(flying_cube(), grid.lattice(), kBounds);
  KeyBox wall = kBounds;
  wall.min.x = wall.max.x = 32775;
  corridor.keep_out_of({wall});
  corridor.update({grid}, robot);
  TravelGraph graph(grid.lattice(), kBounds, 5, 2);
  graph.update(corridor, {{kBounds}});
  EXPECT_FALSE(corridor.contains(kBounds.max));
  EXPECT_LT(graph.distances(graph.node(robot).value())[graph.node(kBounds.max).value()], 20.0);
}

}  // namespace
}  // namespace frontlux::planner::detail
