// The loop with robots whose every scan is made up, so that what has to happen can be told beforehand.

#include "planner/exploration/team_in_world.hpp"
#include "support/complaint.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner {
namespace {

using test::same;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

Scan one_ray(const Pose& from, float range) {
  return {from.position.cast<float>(), 10.0, {{1, 0, 0}}, {range}};
}

std::optional<Scan> see_nothing(std::size_t, const Pose& to) { return one_ray(to, kNothing); }
std::optional<Scan> do_not_go(std::size_t, const Pose&) { return std::nullopt; }

// One aerial robot in a space of 12 x 12 x 6 m of which it knows a box of 6 x 3 x 3 m.
struct Lone {
  ExplorationOptions options = exploration_options();
  KeyBox bounds = voxels_of(Lattice(0.3), {Eigen::Vector3d(-3, -3, 0), Eigen::Vector3d(9, 9, 6)});
  ExplorationStart start{{{1.05, 1.35, 1.65}, 0.0}, {}};

  Lone() {
    options.team.push_back({uav(), goal_options(uav())});
    start.known_free =
        test::keys_of(voxels_of(Lattice(0.3), {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 3, 3)}));
  }

  [[nodiscard]] Exploration begun(const Drive& drive) const {
    Exploration exploration(options, Mapping({.resolution = 0.3, .bounds = bounds}));
    exploration.begin(std::span(&start, 1), drive);
    return exploration;
  }
  // Steps until the end, which has to come.
  [[nodiscard]] std::vector<ExplorationStep> all_steps(Exploration& exploration, const Drive& drive) const {
    std::vector<ExplorationStep> steps;
    while (!exploration.end() && steps.size() < 200) steps.push_back(exploration.step(drive));
    EXPECT_TRUE(exploration.end().has_value());
    return steps;
  }
};

TEST(Exploration, BeginsWithALookAllAround) {
  const Lone lone;
  std::vector<Pose> looks;
  Exploration exploration(lone.options, Mapping({.resolution = 0.3, .bounds = lone.bounds}));
  const ExplorationStep step = exploration.begin(std::span(&lone.start, 1), [&](std::size_t, const Pose& to) {
    looks.push_back(to);
    return see_nothing(0, to);
  });
  // Four windows of 90 degrees, and it stands as it stood.
  ASSERT_EQ(looks.size(), 5U);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    EXPECT_EQ(looks[i].position, lone.start.pose.position);
    EXPECT_NEAR(std::remainder(looks[i].yaw - static_cast<double>(i) * M_PI / 2, 2 * M_PI), 0.0, 1e-9);
  }
  EXPECT_EQ(step.number, 0U);
  ASSERT_EQ(step.robots.size(), 1U);
  ASSERT_EQ(step.robots[0].changed.size(), lone.start.known_free.size());
  for (const VoxelChange& change : step.robots[0].changed)
    EXPECT_EQ(change, (VoxelChange{change.key, Occupancy::kUnknown, Occupancy::kFree}));
  ASSERT_EQ(exploration.poses().size(), 1U);
  EXPECT_TRUE(same(exploration.poses()[0], lone.start.pose));
  // Of the box of 20 x 10 x 10 voxels that stands on the bounds' floor all sides but the lower one.
  EXPECT_EQ(exploration.frontiers().size(), 2U * 20 * 10 + 2U * 10 * 10 + 20U * 10);
}

TEST(Exploration, EndsWhenTheGainStaysLow) {
  for (const int steps_in_a_row : {1, 3, 4}) {
    Lone lone;
    lone.options.epsilon = 1e9;
    lone.options.low_gain_steps = steps_in_a_row;
    Exploration exploration = lone.begun(see_nothing);
    EXPECT_FALSE(exploration.end().has_value());
    const auto steps = lone.all_steps(exploration, see_nothing);
    EXPECT_EQ(steps.size(), static_cast<std::size_t>(steps_in_a_row));
    EXPECT_EQ(exploration.end(), ExplorationEnd::kLowGain);
    for (const ExplorationStep& step : steps) EXPECT_GT(step.robots[0].gain_predicted, 0U);
  }
}

TEST(Exploration, AStepOfEnoughGainBreaksTheRow) {
  const Lone plain;
  Exploration first = plain.begun(see_nothing);
  const auto steps = plain.all_steps(first, see_nothing);
  ASSERT_GT(steps.size(), 4U);
  // The same run with any epsilon, up to where it ends; the expected gains say when.
  for (const double epsilon : {0.0, 3.0, 10.0, 40.0, 120.0, 300.0}) {
    Lone lone;
    lone.options.epsilon = epsilon;
    lone.options.low_gain_steps = 2;
    Exploration exploration = lone.begun(see_nothing);
    const auto got = lone.all_steps(exploration, see_nothing);
    int row = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_LT(row, 2) << "went on after its end";
      row = static_cast<double>(got[i].robots[0].gain_predicted) >= epsilon ? 0 : row + 1;
    }
    const bool idle = !got.back().robots[0].goal.pose.has_value();
    EXPECT_EQ(exploration.end(), idle ? ExplorationEnd::kNothingToDo : ExplorationEnd::kLowGain);
    EXPECT_TRUE(idle || row == 2);
  }
}

TEST(Exploration, SaysInWordsWhyItIsOver) {
  const ExplorationOptions options;
  EXPECT_EQ(describe(ExplorationEnd::kLowGain, options),
            "expected gain stayed below 10 frontiers 3 times in a row");
  EXPECT_EQ(describe(ExplorationEnd::kNothingToDo, options),
            "no robot gets to where it would see a frontier");
  EXPECT_EQ(describe(ExplorationEnd::kStepLimit, options), "the limit of 1000 steps is reached");
  EXPECT_EQ(describe(ExplorationEnd::kStepLimit, options, "plannings"),
            "the limit of 1000 plannings is reached");
  EXPECT_EQ(name_of(ExplorationEnd::kLowGain), "low_gain");
  EXPECT_EQ(name_of(ExplorationEnd::kCutOff), "cut_off");
}

TEST(Exploration, EndsAtItsLimitOfSteps) {
  for (const int limit : {0, 1, 2}) {
    Lone lone;
    lone.options.max_steps = limit;
    Exploration exploration = lone.begun(see_nothing);
    EXPECT_EQ(lone.all_steps(exploration, see_nothing).size(), static_cast<std::size_t>(limit));
    EXPECT_EQ(exploration.end(), ExplorationEnd::kStepLimit);
  }
}

TEST(Exploration, EndsWhenNoRobotHasAGoal) {
  Lone lone;
  lone.start.known_free.clear();  // so it cannot go anywhere
  Exploration exploration = lone.begun(see_nothing);
  const auto steps = lone.all_steps(exploration, see_nothing);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kNothingToDo);
  EXPECT_EQ(steps[0].robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_TRUE(steps[0].robots[0].planned.empty());
}

TEST(Exploration, EndsWhenNothingIsUnknown) {
  Lone lone;
  lone.start.known_free = test::keys_of(lone.bounds);
  Exploration exploration = lone.begun(see_nothing);
  const auto steps = lone.all_steps(exploration, see_nothing);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kNothingToDo);
  EXPECT_EQ(steps[0].robots[0].goal.state, GoalState::kNoFrontiers);
}

TEST(Exploration, EndsWithARobotThatDoesNotGo) {
  const Lone lone;
  Exploration exploration = lone.begun(do_not_go);
  const auto steps = lone.all_steps(exploration, do_not_go);
  EXPECT_EQ(steps.size(), 3U) << "the gain of a path that is not travelled does not count";
  EXPECT_EQ(exploration.end(), ExplorationEnd::kLowGain);
  for (const ExplorationStep& step : steps) {
    EXPECT_GT(step.robots[0].planned.size(), 1U);
    EXPECT_EQ(step.robots[0].travelled, 1U);
    EXPECT_EQ(step.robots[0].length, 0.0);
    EXPECT_TRUE(step.robots[0].still_unknown.empty());
  }
  EXPECT_TRUE(same(exploration.poses()[0], lone.start.pose));
}

// Whatever it looks at stays unknown: each frontier is abandoned after so many looks, and the run ends.
TEST(Exploration, AbandonsFrontiersThatStayUnknown) {
  for (const int visits : {1, 2, 3}) {
    Lone lone;
    lone.options.max_visits = visits;
    Exploration exploration = lone.begun(see_nothing);
    const std::vector<VoxelKey> frontiers(exploration.frontiers().begin(), exploration.frontiers().end());
    std::map<VoxelKey, int> looks;
    while (!exploration.end()) {
      ASSERT_LT(looks.size(), 10'000U);
      const auto abandoned = std::ranges::count_if(looks, [&](const auto& l) { return l.second >= visits; });
      const ExplorationStep step = exploration.step(see_nothing);
      ASSERT_LT(step.number, 100U);
      EXPECT_EQ(step.frontiers, frontiers.size());
      EXPECT_EQ(step.abandoned, static_cast<std::size_t>(abandoned));
      EXPECT_TRUE(std::ranges::is_sorted(step.robots[0].still_unknown));
      // All that the path was expected to see, less what only its first viewpoint does.
      EXPECT_LE(step.robots[0].still_unknown.size(), step.robots[0].gain_predicted);
      for (const VoxelKey& key : step.robots[0].still_unknown) {
        EXPECT_TRUE(std::ranges::binary_search(frontiers, key));
        EXPECT_LT(looks[key], visits) << "goes for an abandoned frontier";
        ++looks[key];
      }
      EXPECT_TRUE(step.robots[0].changed.empty());
      EXPECT_EQ(step.robots[0].gained, 0U);
    }
    EXPECT_GT(looks.size(), 300U);
  }
}

// At the end of its first path it finds something within its box, 0.35 m ahead: there it is in no corridor,
// and has to retreat on that path.
TEST(Exploration, BacksOffFromWhatTurnsUpBesideIt) {
  Lone lone;
  lone.options.epsilon = 1e9;  // all steps have low gain but that in which it backs off
  lone.options.low_gain_steps = 2;
  Exploration exploration = lone.begun(see_nothing);
  const Drive find = [](std::size_t, const Pose& to) { return one_ray(to, 0.35F); };

  std::vector<Pose> path;
  const ExplorationStep first = exploration.step([&](std::size_t robot, const Pose& to) {
    path.push_back(to);
    return see_nothing(robot, to);
  });
  ASSERT_GE(path.size(), 1U);
  const ExplorationStep second = exploration.step(find);
  ASSERT_TRUE(second.robots[0].goal.pose.has_value());
  ASSERT_GE(second.robots[0].travelled, 2U);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kLowGain);

  // It goes on nevertheless when asked to.
  std::vector<Pose> back;
  const ExplorationStep third = exploration.step([&](std::size_t robot, const Pose& to) {
    back.push_back(to);
    return see_nothing(robot, to);
  });
  EXPECT_EQ(third.robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_FALSE(third.robots[0].goal.pose.has_value());
  ASSERT_GT(third.robots[0].travelled, 1U);
  EXPECT_EQ(third.robots[0].travelled, third.robots[0].planned.size());
  std::vector<Pose> trail = {lone.start.pose};
  trail.insert(trail.end(), path.begin(), path.end());
  for (std::size_t i = 1; i < second.robots[0].travelled; ++i) trail.push_back(second.robots[0].planned[i]);
  for (std::size_t i = 0; i < third.robots[0].planned.size(); ++i)
    EXPECT_TRUE(same(third.robots[0].planned[i], trail[trail.size() - 1 - i])) << i;
  // Where it is now its box is free, and nowhere before.
  const VoxelGrid& grid = exploration.mapping().grid();
  const auto box_is_free = [&](const Pose& pose) {
    const VoxelKey at = grid.lattice().key(pose.position).value();
    return test::is_free(grid, grown({at, at}, 1));
  };
  for (std::size_t i = 0; i + 1 < third.robots[0].planned.size(); ++i)
    EXPECT_FALSE(box_is_free(third.robots[0].planned[i])) << i;
  EXPECT_TRUE(box_is_free(exploration.poses()[0]));
  EXPECT_TRUE(exploration.step(see_nothing).robots[0].goal.pose.has_value()) << "and from there it goes on";
}

// Beside what turned up the robot can do nothing but back off, and does not go.
TEST(Exploration, EndsWithARobotThatIsCutOff) {
  const Lone lone;
  Exploration exploration = lone.begun(see_nothing);
  exploration.step(see_nothing);
  exploration.step([](std::size_t, const Pose& to) { return one_ray(to, 0.35F); });
  ASSERT_FALSE(exploration.end().has_value());
  const auto steps = lone.all_steps(exploration, do_not_go);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kCutOff);
  EXPECT_EQ(steps.back().robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_GT(steps.back().robots[0].planned.size(), 1U) << "there is a way back";
}

TEST(Exploration, BackingOffIsNoStepOfLowGain) {
  Lone lone;
  lone.options.epsilon = 1e9;
  lone.options.low_gain_steps = 2;
  Exploration exploration = lone.begun(see_nothing);
  exploration.step([](std::size_t, const Pose& to) { return one_ray(to, 0.35F); });
  EXPECT_FALSE(exploration.end().has_value());
  const ExplorationStep back = exploration.step(see_nothing);
  ASSERT_GT(back.robots[0].travelled, 1U);
  EXPECT_FALSE(back.robots[0].goal.pose.has_value());
  EXPECT_FALSE(exploration.end().has_value());
  exploration.step(see_nothing);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kLowGain);
}

// An unknown voxel amid what is free is a frontier by itself.
TEST(Exploration, GoesForSmallClustersOnlyWhenNothingElseIsLeft) {
  std::map<int, std::size_t> assigned;
  for (const int size : {1, 2, 100'000}) {
    Lone lone;
    lone.options.min_cluster_size = size;
    const VoxelKey hole = Lattice(0.3).key(Eigen::Vector3f(4.35F, 1.35F, 1.65F)).value();
    EXPECT_EQ(std::erase(lone.start.known_free, hole), 1U);
    Exploration exploration = lone.begun(see_nothing);
    EXPECT_TRUE(std::ranges::binary_search(exploration.frontiers(), hole));
    const ExplorationStep step = exploration.step(see_nothing);
    EXPECT_TRUE(step.robots[0].goal.pose.has_value());
    EXPECT_EQ(step.frontiers, exploration.frontiers().size());
    EXPECT_EQ(step.abandoned, 0U);
    assigned[size] = step.robots[0].goal.assigned;
  }
  EXPECT_EQ(assigned[2] + 1, assigned[1]) << "the hole waits";
  EXPECT_EQ(assigned[100'000], assigned[1]) << "where all are small, none waits";
}

TEST(Exploration, RefusesWrongOptions) {
  const auto expect_refusal = [](const std::function<void(ExplorationOptions&)>& spoil, const char* part) {
    Lone lone;
    spoil(lone.options);
    test::expect_complaint([&] { static_cast<void>(lone.begun(see_nothing)); }, {part});
  };
  using O = ExplorationOptions;
  expect_refusal([](O& o) { o.team.clear(); }, "no robot");
  expect_refusal([](O& o) { o.caster = static_cast<CasterKind>(4); }, "caster");
  expect_refusal([](O& o) { o.epsilon = -1.0; }, "epsilon is -1");
  expect_refusal([](O& o) { o.tours_without = TourPart::kZones; }, "tours_without is for tours");
  expect_refusal([](O& o) { o.epsilon = std::nan(""); }, "epsilon is nan");
  expect_refusal([](O& o) { o.epsilon = HUGE_VAL; }, "epsilon is inf");
  expect_refusal([](O& o) { o.low_gain_steps = 0; }, "low_gain_steps is 0");
  expect_refusal([](O& o) { o.max_steps = -1; }, "max_steps is -1");
  expect_refusal([](O& o) { o.tours = true; }, "ContinuousExploration");
  expect_refusal([](O& o) { o.max_visits = 0; }, "max_visits is 0");
  expect_refusal([](O& o) { o.min_cluster_size = 0; }, "min_cluster_size is 0");
  expect_refusal([](O& o) { o.team[0].options.lambda = std::nan(""); }, "lambda");
  expect_refusal([](O& o) { o.team[0].robot.view.max_range = -2.0; }, "range");
}

TEST(Exploration, RefusesWrongCalls) {
  const Lone lone;
  Exploration exploration(lone.options, Mapping({.resolution = 0.3, .bounds = lone.bounds}));
  EXPECT_REFUSED(exploration.step(see_nothing));
  EXPECT_REFUSED(exploration.repeat({}, see_nothing));
  EXPECT_REFUSED(exploration.begin({}, see_nothing));
  std::vector<ExplorationStart> starts(1, lone.start);
  starts[0].pose.yaw = HUGE_VAL;
  EXPECT_REFUSED(exploration.begin(starts, see_nothing));
  exploration.begin(std::span(&lone.start, 1), see_nothing);
  EXPECT_REFUSED(exploration.begin(std::span(&lone.start, 1), see_nothing));
}

}  // namespace
}  // namespace frontlux::planner
