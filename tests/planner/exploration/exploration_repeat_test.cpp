// Explorations that have to come out the same again: by every caster, on any number of threads, and when
// recorded steps are gone through.

#include "planner/exploration/team_in_world.hpp"

#include <tbb/task_arena.h>

namespace frontlux::planner {
namespace {

using test::bytes_of;
using test::drive_by;
using test::expect_same;
using test::same;
using test::TeamInWorld;
using test::uav_and_ugv;

std::optional<VoxelKey> cell_of(const Pose& pose, const Exploration& exploration) {
  return exploration.mapping().grid().lattice().key(pose.position.cast<float>());
}

std::vector<ExplorationStep> steps_of(const TeamInWorld& team, const ExplorationOptions& options, int most,
                                      std::string* map = nullptr) {
  sim::SimulatedRobots robots = team.bodies();
  Exploration exploration(options, team.empty_map());
  std::vector<ExplorationStep> steps = {exploration.begin(team.starts, drive_by(robots))};
  while (!exploration.end() && static_cast<int>(steps.size()) <= most)
    steps.push_back(exploration.step(drive_by(robots)));
  if (map != nullptr) *map = bytes_of(exploration.mapping());
  return steps;
}

TEST(ExplorationSteps, AreTheSameByEveryCasterAndNumberOfThreads) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  ExplorationOptions options = team.options();
  std::string expected_map;
  std::vector<ExplorationStep> expected;
  tbb::task_arena(2).execute([&] { expected = steps_of(team, options, 8, &expected_map); });
  using Setting = std::pair<CasterKind, int>;
  for (const auto& [caster, threads] :
       {Setting{CasterKind::kFast, 1}, Setting{CasterKind::kEmbree, 2}, Setting{CasterKind::kGrid, 2}}) {
    options.caster = caster;
    std::string map;
    std::vector<ExplorationStep> steps;
    tbb::task_arena(threads).execute([&] { steps = steps_of(team, options, 8, &map); });
    ASSERT_EQ(steps.size(), expected.size());
    for (std::size_t i = 0; i < steps.size(); ++i) expect_same(steps[i], expected[i]);
    EXPECT_TRUE(map == expected_map);
  }
}

// Goes through recorded steps again, and after each compares all that can be seen; from some of them it goes
// on by itself and has to do what the unbroken run did.
TEST(ExplorationRepeat, IsTheUnbrokenRunAtEveryStep) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  struct After {
    ExplorationStep step;
    std::string map;
    std::vector<Pose> poses;
    std::vector<VoxelKey> frontiers;
    std::optional<ExplorationEnd> end;
  };
  std::vector<After> run;
  {
    sim::SimulatedRobots robots = team.bodies();
    Exploration exploration(team.options(), team.empty_map());
    ExplorationStep step = exploration.begin(team.starts, drive_by(robots));
    while (true) {
      run.push_back({std::move(step),
                     bytes_of(exploration.mapping()),
                     {exploration.poses().begin(), exploration.poses().end()},
                     {exploration.frontiers().begin(), exploration.frontiers().end()},
                     exploration.end()});
      if (exploration.end()) break;
      step = exploration.step(drive_by(robots));
    }
  }
  ASSERT_GT(run.size(), 4U);
  const std::size_t last = run.size() - 1;
  for (const std::size_t cut : {std::size_t{0}, last / 2, last}) {
    SCOPED_TRACE("cut after step " + std::to_string(cut));
    sim::SimulatedRobots robots = team.bodies();
    Exploration exploration(team.options(), team.empty_map());
    const auto expect_state = [&](const After& after) {
      EXPECT_TRUE(bytes_of(exploration.mapping()) == after.map) << "step " << after.step.number;
      EXPECT_TRUE(same(exploration.poses(), after.poses));
      EXPECT_TRUE(std::ranges::equal(exploration.frontiers(), after.frontiers));
      EXPECT_EQ(exploration.end(), after.end);
    };
    expect_same(exploration.begin(team.starts, drive_by(robots)), run[0].step);
    for (std::size_t i = 1; i <= last; ++i) {
      if (i <= cut)
        ASSERT_TRUE(exploration.repeat(run[i].step, drive_by(robots)));
      else
        expect_same(exploration.step(drive_by(robots)), run[i].step);
      expect_state(run[i]);
    }
  }
}

// Robots that something invisible keeps out of half of the room: what they could not go through has to be
// known again as well.
TEST(ExplorationRepeat, RemembersWhereRobotsCouldNotGo) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  std::size_t refused = 0, noticed = 0;
  const auto drive_in_half = [&](sim::SimulatedRobots& robots) {
    return [&](std::size_t robot, const Pose& to) -> std::optional<Scan> {
      const Eigen::Vector3d start = team.starts[robot].pose.position;
      if (to.position.x() < start.x() - 0.7) {
        ++refused;
        return std::nullopt;
      }
      return robots.drive(robot, to);
    };
  };
  constexpr std::size_t kSteps = 4;
  std::vector<ExplorationStep> steps;
  for (std::size_t cut = kSteps; cut + 2 >= kSteps; --cut) {
    sim::SimulatedRobots robots = team.bodies();
    const Drive drive = drive_in_half(robots);
    Exploration exploration(team.options(), team.empty_map());
    exploration.begin(team.starts, drive);
    std::vector<std::set<VoxelKey>> closed(2);
    for (std::size_t i = 0; i < kSteps; ++i) {
      if (cut == kSteps) {  // the first time, unbroken
        steps.push_back(exploration.step(drive));
        for (std::size_t r = 0; r < 2; ++r) {
          const RobotStep& robot = steps.back().robots[r];
          noticed += robot.blocked.empty() ? 0 : 1;
          for (const Pose& pose : robot.planned)
            EXPECT_FALSE(closed[r].contains(*cell_of(pose, exploration))) << "goes there again";
          closed[r].insert(robot.blocked.begin(), robot.blocked.end());
        }
      } else if (i < cut) {
        ASSERT_TRUE(exploration.repeat(steps[i], drive));
      } else {
        expect_same(exploration.step(drive), steps[i]);
      }
    }
    if (cut == kSteps) {
      EXPECT_EQ(noticed, refused);
    }
  }
  EXPECT_GT(noticed, 0U);
}

TEST(ExplorationRepeat, NoticesAnotherWorld) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  const auto steps = steps_of(team, team.options(), 2);
  ASSERT_EQ(steps.size(), 3U);
  const auto repeats = [&](const ExplorationStep& step,
                           const std::function<void(std::optional<Scan>&)>& alter) {
    sim::SimulatedRobots robots = team.bodies();
    Exploration exploration(team.options(), team.empty_map());
    exploration.begin(team.starts, drive_by(robots));
    return exploration.repeat(step, [&](std::size_t robot, const Pose& to) {
      auto scan = robots.drive(robot, to);
      alter(scan);
      return scan;
    });
  };
  const auto as_it_was = [](const std::optional<Scan>&) {};
  EXPECT_TRUE(repeats(steps[1], as_it_was));
  EXPECT_FALSE(repeats(steps[2], as_it_was)) << "not its turn";
  EXPECT_FALSE(repeats(steps[1], [](std::optional<Scan>& scan) { scan.reset(); })) << "does not go there";
  EXPECT_FALSE(repeats(steps[1], [](std::optional<Scan>& scan) {
    for (float& range : scan->ranges)
      if (std::isfinite(range)) range = std::max(0.0F, range - 0.7F);
  })) << "walls are nearer";
  ExplorationStep wrong = steps[1];
  wrong.robots.pop_back();
  EXPECT_FALSE(repeats(wrong, as_it_was));
  wrong = steps[1];
  wrong.robots[0].travelled = wrong.robots[0].planned.size() + 1;
  EXPECT_FALSE(repeats(wrong, as_it_was));
  wrong = steps[1];
  wrong.robots[1].changed.pop_back();
  EXPECT_FALSE(repeats(wrong, as_it_was));
}

}  // namespace
}  // namespace frontlux::planner
