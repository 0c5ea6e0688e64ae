// The example docs/examples/explore_live.cpp with a robot that knows it by files only.

#include "planner/exploration/scan_folder.hpp"

#include <frontlux/io/robot_file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/sim/coverage.hpp>
#include <frontlux/sim/moving_robots.hpp>

#include <chrono>
#include <thread>
#include <variant>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::status_of;
using test::TeamInWorld;

struct Row {
  double time;
  Pose pose;
};

// Where the rows of a trajectory lead, straight from row to row.
Pose follow(const std::vector<Row>& rows, double time) {
  if (time <= rows.front().time) return rows.front().pose;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto& [begin, from] = rows[i - 1];
    const auto& [end, to] = rows[i];
    if (time > end || end <= begin) continue;
    const double part = (time - begin) / (end - begin);
    const double turn = std::remainder(to.yaw - from.yaw, 2 * std::numbers::pi);
    return {from.position + part * (to.position - from.position), from.yaw + part * turn};
  }
  return rows.back().pose;
}

class ExploreLive : public test::ScanFolder {
 protected:
  ExploreLive() : ScanFolder(FRONTLUX_EXPLORE_LIVE) {}

  // Waits for what the program makes of a scan; nothing if it has ended.
  [[nodiscard]] std::optional<std::vector<Row>> rows_after(const std::string& scan, pid_t child,
                                                           int& status) {
    const std::string wanted = "# " + scan + "\n";
    for (;;) {
      const bool ended = waitpid(child, &status, WNOHANG) != 0;
      std::istringstream lines(fs::exists(file_) ? content_of(file_) : "");
      std::string line;
      if (std::getline(lines, line) && line + '\n' == wanted && !ended) {
        std::vector<Row> rows;
        while (std::getline(lines, line)) {
          std::ranges::replace(line, ',', ' ');
          Row row{};
          std::istringstream(line) >> row.time >> row.pose.position.x() >> row.pose.position.y() >>
              row.pose.position.z() >> row.pose.yaw;
          rows.push_back(row);
        }
        return rows;
      }
      if (ended) return std::nullopt;
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  }

  [[nodiscard]] std::vector<RobotDescription> robot() const {
    std::vector<RobotDescription> robot(1, io::read_robot(folder_ / "robot.json"));
    robot[0].rate = 5.0;
    return robot;
  }

  struct Ride {
    int status = 0, trajectories = 0;
    double farthest = 0.0;  // [m] from its start
    std::size_t contacts = 0;
  };

  // Lets a robot follow what the program plans, until that has ended.
  [[nodiscard]] Ride explore(const TeamInWorld& team) {
    Ride ride;
    const Pose start = team.starts[0].pose;
    sim::MovingRobots robots(team.world, team.truth, team.robots, {&start, 1}, {}, 1);
    const pid_t child = begin(start, "60");
    // The robot follows the last trajectory that has begun.
    std::vector<Row> now = {{0.0, start}}, next = now;
    const auto where = [&](std::size_t, double time) {
      return MotionState{follow(time >= next.front().time ? next : now, time)};
    };
    std::vector<sim::MovingRobots::Stopped> stopped;
    for (;;) {
      const auto sensed = robots.advance(where, stopped);
      ride.farthest = std::max(ride.farthest, (sensed.pose.position - start.position).norm());
      std::ostringstream name;
      name << sensed.time << ".ply";
      answer(name.str(), sensed.scan, sensed.pose);
      const auto rows = rows_after(name.str(), child, ride.status);
      if (!rows) break;
      EXPECT_LT(sensed.time, 300.0);
      if (sensed.time >= 300.0) break;
      if (rows->empty() || rows->front().time == next.front().time) continue;
      ++ride.trajectories;
      if (sensed.time >= next.front().time) now = next;
      next = *rows;
      // It begins in the future, where the robot will be then.
      EXPECT_GT(next.front().time, sensed.time);
      EXPECT_LT((follow(now, next.front().time).position - next.front().pose.position).norm(), 0.02);
    }
    ride.contacts = robots.records()[0].contacts.size();
    return ride;
  }

  [[nodiscard]] double share_mapped(const TeamInWorld& team) const {
    return sim::measure(team.truth, make_voxel_grid(read_octree(folder_ / "scans/map.bt"))).of_observable();
  }

  fs::path file_ = folder_ / "scans/trajectory.csv";
};

TEST_F(ExploreLive, ExploresInMotionAndAgainWithoutARobot) {
  const TeamInWorld team("room", 1, robot());
  const Pose start = team.starts[0].pose;
  const Ride ride = explore(team);
  expect_success(ride.status);
  EXPECT_GT(ride.trajectories, 10);
  EXPECT_EQ(ride.contacts, 0U);
  const std::string told = content_of(folder_ / "out"), map = content_of(folder_ / "scans/map.bt");
  EXPECT_NE(told.find("\n# end: "), std::string::npos) << told;
  EXPECT_GT(share_mapped(team), 0.9);

  // The folder is a recording: without a robot, and without waiting, it gives the same.
  fs::remove(folder_ / "scans/map.bt");
  expect_success(status_of(begin(start, "0")));
  EXPECT_TRUE(content_of(folder_ / "out") == told);
  EXPECT_TRUE(content_of(folder_ / "scans/map.bt") == map);
}

// Its sensor does not see the floor on which it stands: without a start that is free around it, it would
// stay.
TEST_F(ExploreLive, ExploresWithAGroundRobot) {
  use_ground_robot();
  const TeamInWorld team("room", 1, robot());
  const Ride ride = explore(team);
  expect_success(ride.status);
  EXPECT_GT(ride.trajectories, 5);
  EXPECT_GT(ride.farthest, 2.0);
  EXPECT_GT(share_mapped(team), 0.9);
}

TEST_F(ExploreLive, SaysWhatIsMissing) {
  const Pose start{{1.05, 1.05, 1.65}, 0.0};
  const auto expect_failure = [&](const std::string& part) {
    EXPECT_EQ(test::exit_code(status_of(begin(start, "0"))), 2);
    EXPECT_NE(content_of(folder_ / "err").find(part), std::string::npos) << content_of(folder_ / "err");
  };
  expect_failure("there is no scan");
  std::ofstream(folder_ / "scans/poses.csv") << "0.5.ply,1.05,1.05,1.65,0\n";
  expect_failure("0.5.ply");
  std::ofstream(folder_ / "scans/poses.csv") << "3s.ply,1.05,1.05,1.65,0\n";
  expect_failure("3s.ply: its name is no time");
}

}  // namespace
}  // namespace frontlux::planner
