#include "tours/hindsight_tour.hpp"

#include "planner/corridor/dijkstra.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/lattice.hpp>

namespace frontlux::bench {
namespace {

using Eigen::Vector3d;
using planner::TravelOptions;
using test::Random;

constexpr double kEdge = 0.5;  // [m] of a voxel
constexpr KeyBox kBounds{{32768, 32768, 32768}, {32768 + 13, 32768 + 11, 32768 + 1}};
const Lattice kLattice(kEdge);

// A robot in the air that is as small as a voxel.
TravelOptions small_robot() {
  TravelOptions travel;
  travel.motion = planner::Motion::kSpace;
  travel.extents = Vector3d::Constant(0.4);
  travel.min_height = 0.0;
  return travel;
}

// Free and occupied voxels, and places in free ones that are connected, the start first. The path goes from
// each to the next by the corridor's cells, so that it opens none.
struct MadeUp {
  VoxelGrid map{kEdge};
  std::set<VoxelKey> free;
  std::vector<VoxelKey> cells;
  std::vector<Vector3d> places;

  MadeUp(Random& random, std::size_t stops) {
    for_each_key(kBounds, [&](const VoxelKey& key) {
      const bool is_free = !random.one_in(4);
      map.set(key, is_free ? Occupancy::kFree : Occupancy::kOccupied);
      if (is_free) free.insert(key);
    });
    VoxelKey start = random.key_in(kBounds);
    while (distances(start).size() < free.size() / 2) start = random.key_in(kBounds);
    const auto reached = distances(start);
    cells = {start};
    while (cells.size() <= stops) {
      auto next = reached.begin();
      std::advance(next, random.below(static_cast<int>(reached.size())));
      cells.push_back(next->first);
    }
    for (const VoxelKey& cell : cells)
      places.push_back(kLattice.exact_center(cell) + random.point(-0.04, 0.04));
  }

  [[nodiscard]] std::map<VoxelKey, int> distances(const VoxelKey& from) const {
    return test::dijkstra(free, from, 1, planner::PathMetric::kEuclidean);
  }
  // [m] along the corridor
  [[nodiscard]] double length_of(const std::vector<VoxelKey>& tour) const {
    int length = 0;
    for (std::size_t i = 1; i < tour.size(); ++i) length += distances(tour[i - 1]).at(tour[i]);
    return length * kEdge / test::kStepLengths[1];
  }
  // Of all orders of all stops.
  [[nodiscard]] double least_length() const {
    std::vector<std::size_t> order(cells.size() - 1);
    std::iota(order.begin(), order.end(), 1U);
    std::vector<std::vector<double>> between;
    for (const VoxelKey& a : cells) {
      const auto all = distances(a);
      between.emplace_back();
      for (const VoxelKey& b : cells) between.back().push_back(all.at(b) * kEdge / test::kStepLengths[1]);
    }
    double least = std::numeric_limits<double>::infinity();
    do {
      double length = 0.0;
      std::size_t from = 0;
      for (const std::size_t to : order) length += between[std::exchange(from, to)][to];
      least = std::min(least, length);
    } while (std::next_permutation(order.begin(), order.end()));
    return least;
  }
};

TEST(HindsightTour, IsTheShortestOfAllOrders) {
  int better = 0;  // than its own order
  for (std::uint64_t seed = 1; seed <= 28; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MadeUp made(random, 1 + seed % 7);
    const std::vector<Vector3d> stops(made.places.begin() + 1, made.places.end());
    const HindsightTour tour = hindsight_tour(small_robot(), made.map, kBounds, {&made.places[0], 1}, stops);
    // All cells once, the start first.
    ASSERT_EQ(tour.cells.front(), made.cells.front());
    const std::set<VoxelKey> wanted(made.cells.begin(), made.cells.end());
    ASSERT_EQ(std::set<VoxelKey>(tour.cells.begin(), tour.cells.end()), wanted);
    ASSERT_EQ(tour.cells.size(), wanted.size());
    // Unless its own order is shorter than that, when paths are made straight.
    EXPECT_LE(tour.length, made.least_length() + 1e-9);
    EXPECT_LE(tour.length, tour.in_order);
    if (tour.length == tour.in_order) continue;
    ++better;
    EXPECT_NEAR(made.length_of(tour.cells), made.least_length(), 1e-6);
    // Made straight, but not below the straight lines; places are up to 0.07 m from the middles.
    double straight = 0.0;
    for (std::size_t i = 1; i < tour.cells.size(); ++i)
      straight += (kLattice.exact_center(tour.cells[i]) - kLattice.exact_center(tour.cells[i - 1])).norm();
    EXPECT_LE(tour.length, made.length_of(tour.cells) + 1e-9);
    EXPECT_GE(tour.length, straight - 0.14 * static_cast<double>(stops.size()));
  }
  EXPECT_GT(better, 15);
}

// A corridor with a wall across, which the robot went through before it was seen.
TEST(HindsightTour, GoesWhereTheRobotWent) {
  VoxelGrid map(kEdge);
  for (int x = 0; x < 10; ++x)
    map.set(make_key(32768 + x, 32768, 32768), x == 5 ? Occupancy::kOccupied : Occupancy::kFree);
  const auto at = [](double x) { return Vector3d(kEdge * (x + 0.5), kEdge / 2, kEdge / 2); };
  const std::vector<Vector3d> path = {at(2), at(9), at(0)};
  // The nearer end first, then through the wall; twice in a cell is once.
  const HindsightTour tour =
      hindsight_tour(small_robot(), map, kBounds, path, std::vector{at(9), at(9.2), at(0)});
  EXPECT_EQ(tour.cells.size(), 3U);
  EXPECT_NEAR(tour.length, kEdge * (2 + 9), 1e-9);
  EXPECT_EQ(hindsight_tour(small_robot(), map, kBounds, path, {}).length, 0.0);
  const auto asked = [&](const std::vector<Vector3d>& went, const std::vector<Vector3d>& stops) {
    return [=] { static_cast<void>(hindsight_tour(small_robot(), map, kBounds, went, stops)); };
  };
  test::expect_complaint(asked({at(2)}, {at(9)}), {"hindsight tour: the stop at (4.75", "not on the path"});
  test::expect_complaint(asked({at(2), at(-9)}, {}), {"hindsight tour: the robot was at (-4.25", "bounds"});
  test::expect_complaint(asked({}, {}), {"hindsight tour: the path has no start"});
}

}  // namespace
}  // namespace frontlux::bench
