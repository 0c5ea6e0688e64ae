// A robot whose stop is far away plans the first part of its way.

#include "exploration/exploration_state.hpp"
#include "planner/exploration/team_in_world.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::key_at;

constexpr double kResolution = 0.3;

// A tube of 180 x 2.4 x 2.4 m, open at its far end: there is what there is to see.
struct Tube {
  static constexpr KeyBox kInside{key_at(0, 0, 0), key_at(599, 7, 7)};
  ExplorationState state;
  ExplorationStep step;

  /// @param extent  how much the robot is to know of its corridor: in a larger map it is less
  explicit Tube(CorridorExtent extent) : state(options(), Mapping({kResolution, bounds(extent)})) {
    const ExplorationStart begin{at(10), {}};
    state.start_from({&begin, 1});
    for_each_key(kInside, [&](const VoxelKey& key) { state.changed.push_back(key); });
    state.mapping.mark_free(state.changed);
    for_each_key(grown(kInside, 1), [&](const VoxelKey& key) {
      if (kInside.contains(key) || key.x > kInside.max.x || !bounds(extent).contains(key)) return;
      const Eigen::Vector3f middle = state.lattice().exact_center(key).cast<float>();
      state.mapping.insert(middle, {&middle, 1});
      state.changed.push_back(key);
    });
    std::ranges::sort(state.changed);
    state.conservative_map.emplace(state.mapping.grid());
    state.frontiers.update(state.change());
    step = state.new_step();
    go_to(10);
  }
  static KeyBox bounds(CorridorExtent extent) {
    const int beside = extent == CorridorExtent::kAllCells ? 1 : 20;
    return {key_at(-1, -beside, -beside), key_at(610, 7 + beside, 7 + beside)};
  }
  static ExplorationOptions options() {
    ExplorationOptions options = exploration_options();
    options.team.push_back({uav(), goal_options(uav())});
    options.tours = true;
    return options;
  }
  static Pose at(int x) { return {Lattice(kResolution).exact_center(key_at(x, 4, 4)), 0.0}; }
  void go_to(int x) {
    state.poses[0] = at(x);
    state.update_views(step);
  }
  [[nodiscard]] double ahead() const {
    const VoxelKey cell = state.ahead[0].value();
    EXPECT_FALSE(state.path_corridor(0).path_to(cell).empty());
    return state.lattice().exact_center(cell).x() - state.poses[0].position.x();
  }
};

class FarStop : public testing::TestWithParam<CorridorExtent> {};

TEST_P(FarStop, IsGoneForInParts) {
  constexpr double kMost = 80.0, kNode = 2.0;  // [m] edge of a node of the graph
  Tube tube(GetParam());
  MotionState start;
  start.pose = tube.state.poses[0];
  tube.state.plan_tours(0, {&start, 1}, tube.step);
  ASSERT_EQ(tube.state.path_corridor(0).extent(), GetParam());
  const Goal goal = tube.step.robots[0].goal;
  ASSERT_TRUE(goal.pose);
  EXPECT_GT(goal.pose->position.x(), Tube::at(560).position.x());
  EXPECT_GT(goal.distance, 160.0) << "of the whole way";
  EXPECT_NEAR(tube.ahead(), kMost, 2 * kNode);
  // It keeps its stop, and is farther on.
  for (const int x : {200, 350, 550}) {
    tube.go_to(x);
    tube.step.robots[0].goal = goal;
    EXPECT_TRUE(tube.state.keep_stop(0, tube.step));
    const double rest = goal.pose->position.x() - tube.state.poses[0].position.x();
    if (rest > kMost + kNode) {
      EXPECT_NEAR(tube.ahead(), kMost, 2 * kNode);
    } else {
      EXPECT_FALSE(tube.state.ahead[0]);
      EXPECT_FALSE(tube.state.path_corridor(0).path_to(goal.cell).empty());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Extents, FarStop,
                         testing::Values(CorridorExtent::kAllCells, CorridorExtent::kNearby),
                         [](const auto& extent) {
                           return extent.param == CorridorExtent::kAllCells ? "AllCells" : "Nearby";
                         });

}  // namespace
}  // namespace frontlux::planner::detail
