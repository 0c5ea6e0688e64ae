// Whole explorations of built-in worlds, every step of which is judged by what it may do and what it says.

#include "planner/exploration/team_in_world.hpp"
#include "support/plain_frontiers.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/io/robot_file.hpp>

namespace frontlux::planner {
namespace {

using test::drive_by;
using test::same;
using test::TeamInWorld;
using test::uav_and_ugv;

// Whether a body that stands still here is in voxels that are known free. One on a plane is judged by its
// width, since which layers it takes is the corridor's business.
bool body_is_free(const VoxelGrid& grid, const TravelOptions& body, const Eigen::Vector3d& at) {
  const Lattice& lattice = grid.lattice();
  Eigen::Vector3d half = body.extents / 2;
  if (body.motion == Motion::kPlane) half.z() = 0.0;
  half -= Eigen::Vector3d::Constant(1e-4).cwiseMin(half);
  const Eigen::Vector3d low = at - half, high = at + half;
  return test::is_free(grid, {lattice.key(low).value(), lattice.key(high).value()});
}

// What a run comes to.
struct Sums {
  std::size_t steps = 0, goals = 0, turned = 0, backed_off = 0, gained = 0;
  bool shared = false;                  // a step in which robots went for the same frontiers
  std::vector<std::size_t> candidates;  // the most in a step, by robot
  std::uint64_t contacts = 0;
};

// An exploration, and beside it all that its steps can be checked by.
class Watch {
 public:
  Watch(const TeamInWorld& team, const ExplorationOptions& options)
      : team_(team), robots_(team.bodies()), exploration_(options, team.empty_map()) {
    exploration_.begin(team.starts, drive_by(robots_));
  }

  Sums run(int most) {
    while (!exploration_.end() && static_cast<int>(sums_.steps) < most && !testing::Test::HasFailure())
      step();
    sums_.contacts = robots_.contacts();
    return sums_;
  }

 private:
  void step() {
    const VoxelGrid before = grid();
    const std::vector<Pose> from(exploration_.poses().begin(), exploration_.poses().end());
    const auto frontiers = test::frontiers_by_hand(before, team_.truth.bounds());
    ASSERT_TRUE(std::ranges::equal(exploration_.frontiers(), frontiers)) << "step " << sums_.steps;

    std::map<std::size_t, VoxelGrid> when;  // the map as each robot set out
    std::map<std::size_t, std::vector<Pose>> asked;
    const ExplorationStep step = exploration_.step([&](std::size_t robot, const Pose& to) {
      when.try_emplace(robot, grid());
      asked[robot].push_back(to);
      return robots_.drive(robot, to);
    });
    SCOPED_TRACE("step " + std::to_string(step.number));
    EXPECT_EQ(step.number, ++sums_.steps);
    EXPECT_EQ(step.frontiers, frontiers.size());
    EXPECT_EQ(step.abandoned, static_cast<std::size_t>(std::ranges::count_if(frontiers, [&](const auto& key) {
                return looks_[key] >= exploration_.options().max_visits;
              })));
    EXPECT_LE(step.unassigned + step.abandoned, step.frontiers);
    EXPECT_GT(step.rays, 0U);

    VoxelGrid map = before;
    std::size_t assigned = 0;
    for (std::size_t r = 0; r < step.robots.size(); ++r) {
      SCOPED_TRACE("robot " + std::to_string(r));
      const RobotStep& robot = step.robots[r];
      assigned += robot.goal.assigned;
      if (when.contains(r)) {
        EXPECT_TRUE(when.at(r) == map) << "robots move one after the other";
      }
      check_path(robot, r, before, from[r], asked[r]);
      check_gains(robot, r, before, frontiers);
      check_candidates(robot, r, before, frontiers);
      // What it changed: all that differs once the next one sets out.
      auto next = when.upper_bound(r);
      const VoxelGrid after = next == when.end() ? grid() : next->second;
      check_changes(robot, map, when.contains(r) ? after : map, frontiers);
      if (when.contains(r)) map = after;
      EXPECT_TRUE(
          same(exploration_.poses()[r], robot.travelled > 0 ? robot.planned[robot.travelled - 1] : from[r]));
    }
    for (const RobotStep& robot : step.robots)
      for (const VoxelKey& key : robot.still_unknown) ++looks_[key];
    if (exploration_.options().assign) {
      EXPECT_LE(assigned, step.frontiers - step.abandoned) << "a frontier is one robot's";
    } else if (assigned > step.frontiers) {
      sums_.shared = true;
    }
  }

  void check_path(const RobotStep& robot, std::size_t r, const VoxelGrid& before, const Pose& from,
                  const std::vector<Pose>& asked) {
    const std::vector<Pose>& path = robot.planned;
    ASSERT_LE(robot.travelled, path.size());
    ASSERT_EQ(asked.size(), robot.travelled == 0 ? 0 : robot.travelled - 1)
        << "every viewpoint is measured at";
    for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_TRUE(same(asked[i], path[i + 1]));
    double length = 0.0;
    for (std::size_t i = 1; i < robot.travelled; ++i)
      length += (path[i].position - path[i - 1].position).norm();
    EXPECT_NEAR(robot.length, length, 1e-9);
    if (robot.goal.pose) ++sums_.goals;
    if (path.empty()) return;
    EXPECT_TRUE(same(path.front(), from));
    if (!robot.goal.pose) {
      ++sums_.backed_off;
      return;
    }
    EXPECT_TRUE(same(path.back(), *robot.goal.pose));
    TravelOptions body = team_.robots[r].robot.travel;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Eigen::Vector3d a = path[i - 1].position, b = path[i].position;
      EXPECT_LE((b - a).norm(), 1.2 + 1e-9);
      constexpr int kParts = 30;
      // From a place that is not free, since the map has changed around it, the path leads out of it first.
      for (int part = i == 1 ? kParts : 0; part <= kParts; ++part)
        EXPECT_TRUE(body_is_free(before, body, a + (b - a) * part / kParts)) << "viewpoint " << i;
    }
  }

  void check_gains(const RobotStep& robot, std::size_t r, const VoxelGrid& before,
                   const std::vector<VoxelKey>& frontiers) {
    if (exploration_.options().optimize)
      EXPECT_GE(robot.gain_predicted, robot.gain_tangent);
    else
      EXPECT_EQ(robot.gain_predicted, robot.gain_tangent);
    if (robot.gain_predicted > robot.gain_tangent) ++sums_.turned;
    EXPECT_LE(robot.gain_predicted, robot.goal.assigned + robot.goal.received + robot.goal.uncovered);
    EXPECT_TRUE(std::ranges::is_sorted(robot.still_unknown));
    if (!robot.goal.pose) {
      EXPECT_TRUE(robot.still_unknown.empty());
      return;
    }
    // Frontiers in view along the path by rays one at a time on the grid; its own are among them.
    const FieldOfView& view = team_.robots[r].robot.view;
    const std::span<const Pose> path = robot.planned;
    const auto gone_to = path.first(robot.travelled).subspan(robot.travelled == 0 ? 0 : 1);
    const auto in_view = test::seen_by_hand(before, path, frontiers, view),
               in_view_of_places_gone_to = test::seen_by_hand(before, gone_to, frontiers, view);
    EXPECT_LE(robot.gain_predicted, in_view.size());
    for (const VoxelKey& key : robot.still_unknown) {
      EXPECT_TRUE(std::ranges::binary_search(in_view_of_places_gone_to, key));
      EXPECT_LT(looks_[key], exploration_.options().max_visits);
    }
  }

  // Its goal is one of them, and what was counted is within its reach.
  void check_candidates(const RobotStep& robot, std::size_t r, const VoxelGrid& before,
                        const std::vector<VoxelKey>& frontiers) {
    const TeamMember& member = exploration_.options().team[r];
    if (member.options.rule != GoalRule::kViewQuality) {
      EXPECT_TRUE(robot.image.empty());
      return;
    }
    sums_.candidates.resize(team_.robots.size());
    sums_.candidates[r] = std::max(sums_.candidates[r], robot.image.size());
    EXPECT_TRUE(std::ranges::is_sorted(robot.image, {}, &RenderedCell::cell));
    EXPECT_TRUE(robot.image.size() <= 1000 || member.robot.travel.motion == Motion::kPlane);
    EXPECT_TRUE(!robot.goal.pose ||
                std::ranges::binary_search(robot.image, robot.goal.cell, {}, &RenderedCell::cell));
    for (std::size_t i = 0; i < robot.image.size(); i += 1 + robot.image.size() / 4) {
      const RenderedCell& cell = robot.image[i];
      EXPECT_LE(cell.quality, std::exp(-member.options.lambda * cell.distance) * cell.gain + 1e-9);
      const Lattice& lattice = before.lattice();
      const auto in_reach = std::ranges::count_if(frontiers, [&](const VoxelKey& key) {
        const double distance = (lattice.exact_center(key) - lattice.exact_center(cell.cell)).norm();
        return distance <= member.robot.view.max_range + 1e-9;
      });
      if (cell.standard_error == 0.0) {
        EXPECT_LE(cell.gain, static_cast<double>(in_reach));
      }
    }
  }

  void check_changes(const RobotStep& robot, const VoxelGrid& map, const VoxelGrid& after,
                     const std::vector<VoxelKey>& frontiers) {
    std::vector<VoxelChange> expected;
    std::uint64_t gained = 0;
    for_each_key(team_.truth.bounds(), [&](const VoxelKey& key) {
      if (map.at(key) == after.at(key)) return;
      expected.push_back({key, map.at(key), after.at(key)});
      gained += static_cast<std::uint64_t>(map.at(key) == Occupancy::kUnknown &&
                                           std::ranges::binary_search(frontiers, key));
    });
    std::sort(expected.begin(), expected.end());
    EXPECT_TRUE(robot.changed == expected) << robot.changed.size() << " for " << expected.size();
    EXPECT_EQ(robot.gained, gained);
    sums_.gained += gained;
    for (const VoxelKey& key : robot.still_unknown) EXPECT_EQ(after.at(key), Occupancy::kUnknown);
  }

  [[nodiscard]] const VoxelGrid& grid() const { return exploration_.mapping().grid(); }

  const TeamInWorld& team_;
  sim::SimulatedRobots robots_;
  Exploration exploration_;
  std::map<VoxelKey, int> looks_;
  Sums sums_;
};

constexpr int kToItsEnd = 1000;

TEST(ExplorationSteps, AreAsTheySayInARoom) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  const Sums sums = Watch(team, team.options()).run(kToItsEnd);
  EXPECT_GT(sums.steps, 2U);
  EXPECT_LT(sums.steps, 60U);
  EXPECT_GT(sums.turned, 0U);
  EXPECT_GT(sums.gained, 1000U);
  EXPECT_EQ(sums.contacts, 0U);
}

TEST(ExplorationSteps, AreAsTheySayInAStorage) {
  const TeamInWorld team("storage", 2, uav_and_ugv());
  const Sums sums = Watch(team, team.options()).run(5);
  EXPECT_EQ(sums.steps, 5U);
  EXPECT_GT(sums.goals, 5U);
  for (std::size_t r = 0; r < sums.candidates.size(); ++r)
    if (team.robots[r].robot.travel.drives())
      EXPECT_GT(sums.candidates[r], 500U);
    else
      EXPECT_EQ(sums.candidates[r], 1000U) << "there are more";
  EXPECT_EQ(sums.contacts, 0U);
}

TEST(ExplorationSteps, AreAsTheySayForAnyTeam) {
  const std::filesystem::path data = FRONTLUX_DATA_DIR;
  const auto sonar = io::read_robot(data / "robots" / "sonar.json");
  const std::vector<std::vector<RobotDescription>> teams = {
      {uav_description()},
      {ugv_description()},
      {ugv_description(), uav_description(), uav_description()},
      {sonar, uav_description()},
      {sonar}};
  for (std::size_t t = 0; t < teams.size(); ++t) {
    SCOPED_TRACE("team " + std::to_string(t));
    const TeamInWorld team("room", 3, teams[t]);
    const Sums sums = Watch(team, team.options()).run(4);
    EXPECT_GT(sums.goals, 3U);
    EXPECT_GT(sums.gained, 100U);
    EXPECT_EQ(sums.contacts, 0U);
  }
}

TEST(ExplorationSteps, WithoutDistributionRobotsGoForTheSame) {
  const TeamInWorld team("room", 1, uav_and_ugv());
  ExplorationOptions options = team.options();
  options.assign = false;
  options.optimize = false;
  const Sums sums = Watch(team, options).run(3);
  EXPECT_TRUE(sums.shared);
  EXPECT_EQ(sums.turned, 0U);
}

TEST(ExplorationSteps, AreAsTheySayAsPrinted) {
  const TeamInWorld team("room", 2, {ugv_description(), uav_description(Method::kPaper)});
  const Sums sums = Watch(team, team.options(Method::kPaper)).run(5);
  EXPECT_GT(sums.goals, 4U);
  EXPECT_EQ(sums.contacts, 0U);
}

}  // namespace
}  // namespace frontlux::planner
