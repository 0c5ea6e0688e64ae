// Explores with scans that come from files: how a real robot takes the place of the simulator.
//
//     explore_recorded ROBOT.json FOLDER X Y Z YAW SECONDS
//
// The robot's sensor begins at X, Y, Z [m], YAW [rad]; around a robot that drives 2.3 m have to be free
// there. Where it has to go next is in FOLDER/next.csv, which the robot removes. It answers with a scan, the
// .ply or .pcd file of its points in the sensor's frame [m], x forward, y left, z up, and one more line
// `file,x,y,z,yaw` in FOLDER/poses.csv that says where the scan was taken; rays that met nothing are points
// beyond the sensor's range. The scan has to be complete before the line is there, and poses.csv to be
// replaced as a whole. A robot that could not go there answers from where it is, or not at all for SECONDS.
// What is in the folder already is taken at once: the same folder can be explored again without a robot. The
// map comes to FOLDER/map.bt.

#include "recorded_scan.hpp"

#include <frontlux/io/path_file.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/exploration_start.hpp>

#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <string>
#include <thread>

using namespace frontlux;
using namespace frontlux::planner;

namespace {

bool is_near(const io::SensorFrame& T_world_sensor, const Pose& viewpoint) {
  constexpr double kMetres = 0.05, kRadians = 0.05;
  const double turn = yaw_of(T_world_sensor) - viewpoint.yaw;
  return (T_world_sensor.translation() - viewpoint.position).norm() < kMetres &&
         std::abs(std::remainder(turn, 2 * std::numbers::pi)) < kRadians;
}

// Sends the robot to a viewpoint and waits for its scan. Here the driver of yours belongs.
/// @param answers  of the robot so far
std::optional<Scan> drive(const std::filesystem::path& folder, std::size_t& answers, const Pose& viewpoint,
                          double max_range, std::chrono::duration<double> patience) {
  const auto begin = std::chrono::steady_clock::now();
  for (bool asked = false;; asked = true) {
    if (std::filesystem::exists(folder / "poses.csv")) {
      const auto recorded = io::read_pose_file(folder / "poses.csv");
      if (recorded.size() > answers) {
        const io::RecordedPose& answer = recorded[answers++];
        if (!is_near(answer.T_world_sensor, viewpoint)) return std::nullopt;
        return scan_of(answer, folder, max_range);
      }
    }
    if (!asked) io::write_path(folder / "next.csv", {&viewpoint, 1});
    if (std::chrono::steady_clock::now() - begin >= patience) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void explore(Robot robot, const std::filesystem::path& folder, const Pose& start, double seconds) {
  const Lattice lattice(0.3);
  const Eigen::Vector3d reach(20, 20, 5);  // [m] what may be explored around the start
  robot.travel.floor = start.position.z() - reach.z();
  const MappingOptions map{.resolution = lattice.resolution(),
                           .bounds = voxels_of(lattice, {start.position - reach, start.position + reach})};
  const ExplorationStart begin = start_at(lattice, robot, start, free_radius_of(robot));

  ExplorationOptions options = exploration_options();
  options.team.push_back({robot, goal_options(robot)});
  Exploration exploration(options, Mapping(map));
  std::size_t answers = 0;
  const Drive by_files = [&](std::size_t, const Pose& viewpoint) {
    return drive(folder, answers, viewpoint, robot.view.max_range, std::chrono::duration<double>(seconds));
  };
  exploration.begin({&begin, 1}, by_files);
  while (!exploration.end()) {
    const ExplorationStep step = exploration.step(by_files);
    std::cout << "step " << step.number << ": " << step.frontiers << " frontiers, " << step.robots[0].length
              << " m, " << step.robots[0].gained << " gained\n";
  }
  exploration.mapping().write(folder / "map.bt");
  std::cout << "end: " << describe(*exploration.end(), options) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kWords = 8;
  if (argc != kWords) {
    std::cerr << "usage: explore_recorded ROBOT.json FOLDER X Y Z YAW SECONDS\n";
    return 2;
  }
  try {
    const auto number = [&](int i) { return std::stod(argv[i]); };
    explore(io::read_robot(argv[1]).robot, argv[2], {{number(3), number(4), number(5)}, number(6)},
            number(7));
  } catch (const std::exception& error) {
    std::cerr << "explore_recorded: " << error.what() << '\n';
    return 2;
  }
}
