// The example docs/examples/explore_recorded.cpp with a robot that knows it by files only.

#include "planner/exploration/scan_folder.hpp"

#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/sim/coverage.hpp>

#include <chrono>
#include <thread>
#include <variant>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::status_of;
using test::TeamInWorld;

class ExploreRecorded : public test::ScanFolder {
 protected:
  ExploreRecorded() : ScanFolder(FRONTLUX_EXPLORE_RECORDED) {}

  [[nodiscard]] std::vector<RobotDescription> robot() const {
    return {io::read_robot(folder_ / "robot.json")};
  }

  // Lets the robot go where next.csv says, until the program has ended. Returns its status.
  [[nodiscard]] int explore(sim::SimulatedRobots& robots, const Pose& start) {
    const pid_t child = begin(start, "60");
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (!fs::exists(folder_ / "scans/next.csv")) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      const auto next = io::read_pose_list(folder_ / "scans/next.csv");
      fs::remove(folder_ / "scans/next.csv");
      EXPECT_EQ(next.size(), 1U);
      const Pose& to = next.front().pose;
      answer("scan" + std::to_string(++scans_) + ".ply", robots.drive(0, to).value(), to);
      farthest_ = std::max(farthest_, (to.position - start.position).norm());
    }
    return status;
  }

  [[nodiscard]] double share_mapped(const TeamInWorld& team) const {
    return sim::measure(team.truth, make_voxel_grid(read_octree(folder_ / "scans/map.bt"))).of_observable();
  }

  int scans_ = 0;
  double farthest_ = 0.0;  // [m] from its start
};

TEST_F(ExploreRecorded, ExploresWithFilesAndAgainWithoutARobot) {
  const TeamInWorld team("room", 1, robot());
  sim::SimulatedRobots robots = team.bodies();
  const Pose start = team.starts[0].pose;
  expect_success(explore(robots, start));
  const std::string told = content_of(folder_ / "out"), map = content_of(folder_ / "scans/map.bt");
  EXPECT_NE(told.find("\nend: "), std::string::npos) << told;
  EXPECT_GT(scans_, 10);
  EXPECT_EQ(robots.contacts(), 0U);

  // What it mapped is the room: nearly all of it, and free space where there is free space.
  EXPECT_GT(share_mapped(team), 0.9);

  // The folder is a recording: without a robot, and without waiting, it gives the same.
  fs::remove(folder_ / "scans/map.bt");
  expect_success(status_of(begin(start, "0")));
  EXPECT_EQ(content_of(folder_ / "out"), told);
  EXPECT_TRUE(content_of(folder_ / "scans/map.bt") == map);
}

// Its sensor does not see the floor on which it stands: without a start that is free around it, it would
// stay.
TEST_F(ExploreRecorded, ExploresWithAGroundRobot) {
  use_ground_robot();
  const TeamInWorld team("room", 1, robot());
  sim::SimulatedRobots robots = team.bodies();
  expect_success(explore(robots, team.starts[0].pose));
  EXPECT_GT(farthest_, 2.0);
  EXPECT_GT(share_mapped(team), 0.9);
}

TEST_F(ExploreRecorded, EndsWithoutAnAnswer) {
  const Pose start{{1.05, 1.05, 1.65}, 0.0};
  expect_success(status_of(begin(start, "0")));
  EXPECT_NE(content_of(folder_ / "out").find("end: "), std::string::npos);
  // The first place that it would have the robot look from is where the robot is.
  const auto next = io::read_pose_list(folder_ / "scans/next.csv");
  ASSERT_EQ(next.size(), 1U);
  EXPECT_TRUE(test::same(next[0].pose, start));

  std::ofstream(folder_ / "scans/poses.csv") << "scan1.ply,1.05,1.05,1.65,0\n";
  EXPECT_EQ(test::exit_code(status_of(begin(start, "0"))), 2);
  EXPECT_NE(content_of(folder_ / "err").find("scan1.ply"), std::string::npos);
}

}  // namespace
}  // namespace frontlux::planner
