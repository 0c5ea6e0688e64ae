// Explores in motion with scans that come from files, as a robot's driver would: scans go in with pose and
// time, trajectories come out. Nothing in it stops the robot.
//
//     explore_live ROBOT.json FOLDER X Y Z YAW SECONDS
//
// The robot's sensor begins at X, Y, Z [m], YAW [rad]; around a robot that drives 2.3 m have to be free
// there. Scans come as in explore_recorded: a .ply or .pcd file of points in the sensor's frame [m], x
// forward, y left, z up, and one more line `file,x,y,z,yaw` in FOLDER/poses.csv that says where it was taken.
// When it was taken is the file's name, in seconds on the robot's clock: 12.35.ply.
//
// FOLDER/trajectory.csv is what the robot is to follow, `time,x,y,z,yaw`, twenty rows a second; it is
// replaced as a whole after each scan, and its first line names that scan. Until a trajectory's first row the
// robot stays on the one before. The program ends when the exploration does, or if no scan comes for SECONDS.
// The same folder can be explored again without a robot. The map comes to FOLDER/map.bt.

#include "recorded_scan.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/planner/exploration_start.hpp>

#include <charconv>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

using namespace frontlux;
using namespace frontlux::planner;

namespace {

// [s] on the robot's clock.
double time_of(const io::RecordedPose& recorded) {
  const std::string name = std::filesystem::path(recorded.file).stem().string();
  double time = 0.0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), time);
  if (error != std::errc{} || end != name.data() + name.size())
    throw std::runtime_error(recorded.file + ": its name is no time in seconds");
  return time;
}

// Waits for the next scan. Here the driver of yours belongs.
std::optional<io::RecordedPose> next_scan(const std::filesystem::path& folder, std::size_t& taken,
                                          std::chrono::duration<double> patience) {
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    if (std::filesystem::exists(folder / "poses.csv")) {
      const auto recorded = io::read_pose_file(folder / "poses.csv");
      if (recorded.size() > taken) return recorded[taken++];
    }
    if (std::chrono::steady_clock::now() - begin >= patience) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// `time,x,y,z,yaw`, the last row where it ends.
std::string rows_of(const Trajectory& trajectory) {
  constexpr double kRate = 20.0;  // [1/s]
  std::ostringstream rows;
  rows.precision(12);
  const auto row = [&](double time) {
    const Pose pose = trajectory.at(time).pose;
    rows << time << ',' << pose.position.x() << ',' << pose.position.y() << ',' << pose.position.z() << ','
         << pose.yaw << '\n';
  };
  for (int i = 0; trajectory.begin() + i / kRate < trajectory.end(); ++i) row(trajectory.begin() + i / kRate);
  row(trajectory.end());
  return rows.str();
}

void explore(Robot robot, const std::filesystem::path& folder, const Pose& start, double seconds) {
  const Lattice lattice(0.3);
  const Eigen::Vector3d reach(20, 20, 5);  // [m] what may be explored around the start
  robot.travel.floor = start.position.z() - reach.z();
  const MappingOptions map{.resolution = lattice.resolution(),
                           .bounds = voxels_of(lattice, {start.position - reach, start.position + reach})};
  ExplorationOptions options = tour_options(lattice.resolution());
  options.team.push_back({robot, motion_goal_options(robot)});
  ContinuousExploration exploration(options, Mapping(map));

  std::size_t taken = 0;
  std::optional<io::RecordedPose> scan = next_scan(folder, taken, std::chrono::duration<double>(seconds));
  if (!scan) throw std::runtime_error(folder.string() + ": there is no scan");
  const ExplorationStart begin = start_at(lattice, robot, start, free_radius_of(robot));
  exploration.begin({&begin, 1}, time_of(*scan));
  std::string rows;
  for (; scan && !exploration.end();
       scan = next_scan(folder, taken, std::chrono::duration<double>(seconds))) {
    const double time = time_of(*scan);
    exploration.insert(0, {scan->T_world_sensor.translation(), yaw_of(scan->T_world_sensor)},
                       scan_of(*scan, folder, robot.view.max_range));
    while (const auto planned = exploration.plan(time)) {
      rows = rows_of(planned->trajectory);
      std::cout << "# planned at " << time << " s, since: " << name_of(planned->reason) << '\n' << rows;
      if (exploration.end()) break;
    }
    write_file(folder / "trajectory.csv", [&](std::ostream& out) {
      out << "# " << scan->file << '\n' << rows;
    });
    if (exploration.end()) break;
  }
  exploration.mapping().write(folder / "map.bt");
  std::cout << "# end: "
            << (exploration.end() ? describe(*exploration.end(), options, "plannings") : "no more scans")
            << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kWords = 8;
  if (argc != kWords) {
    std::cerr << "usage: explore_live ROBOT.json FOLDER X Y Z YAW SECONDS\n";
    return 2;
  }
  try {
    const auto number = [&](int i) { return std::stod(argv[i]); };
    explore(io::read_robot(argv[1]).robot, argv[2], {{number(3), number(4), number(5)}, number(6)},
            number(7));
  } catch (const std::exception& error) {
    std::cerr << "explore_live: " << error.what() << '\n';
    return 2;
  }
}
