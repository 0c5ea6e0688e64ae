#include "setup/team.hpp"

#include "bad_input.hpp"
#include "text.hpp"

#include <frontlux/io/robot_file.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

namespace frontlux::app {
namespace {

using planner::Method, planner::RobotDescription;

constexpr std::size_t kMaxRobots = io::kMostRobots;

// Robots of the same name get numbers, but none that makes the name of another one.
void number_equal_names(std::span<RobotDescription> robots) {
  std::map<std::string, int> total, number;
  for (const RobotDescription& robot : robots) ++total[robot.robot.name];
  std::set<std::string> taken;
  for (const auto& [name, count] : total) taken.insert(name);
  for (RobotDescription& robot : robots) {
    const std::string name = robot.robot.name;
    if (total[name] == 1) continue;
    do {
      const std::string digits = std::to_string(++number[name]);
      robot.robot.name = name.substr(0, io::kLongestRobotName - digits.size()) + digits;
    } while (!taken.insert(robot.robot.name).second);
  }
}

}  // namespace

std::vector<RobotDescription> team_of(const std::string& word, Method method) {
  std::vector<RobotDescription> robots;
  if (word.empty()) return robots;
  for (std::string_view rest = word;; rest.remove_prefix(rest.find('+') + 1)) {
    const std::string_view part = rest.substr(0, rest.find('+'));
    std::size_t count = 1;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), count);
    const std::string_view name = part.substr(static_cast<std::size_t>(end - part.data()));
    const bool too_many = error == std::errc::result_out_of_range || count > kMaxRobots;
    if ((!too_many && error != std::errc{} && end != part.data()) || count < 1 ||
        (name != "uav" && name != "ugv"))
      throw BadInput(
          quote(word) +
          " is not a team; give uav, ugv, or several with + between them, as in uav+ugv or 2uav+ugv");
    if (too_many || robots.size() + count > kMaxRobots)
      throw BadInput(quote(word) + " is more than " + std::to_string(kMaxRobots) + " robots; give fewer");
    for (std::size_t i = 0; i < count; ++i)
      robots.push_back(name == "uav" ? planner::uav_description(method) : planner::ugv_description());
    if (rest.find('+') == std::string_view::npos) return robots;
  }
}

std::vector<RobotDescription> gather_robots(const ExploreOptions& options) {
  const Method method = options.mode;
  std::vector<RobotDescription> robots;
  try {
    robots = team_of(options.team, method);
  } catch (const BadInput& error) {
    throw BadInput(std::string("--team: ") + error.what());
  }
  // Robots in motion keep apart in time; in lock-step and on paper, by flying above those on the ground.
  if (!options.lockstep && method == Method::kDefault)
    for (RobotDescription& robot : robots)
      robot.robot = planner::in_motion(std::move(robot.robot), options.source.resolution);
  for (const io::TaskRobot& robot : options.robots) robots.push_back(robot.description);
  for (const std::string& file : options.robot_files) robots.push_back(io::read_robot(file));
  if (robots.empty()) throw BadInput("--team: there is no robot; give one here or with --robot");
  if (robots.size() > kMaxRobots)
    throw BadInput("--team: " + std::to_string(robots.size()) + " robots are too many; give at most " +
                   std::to_string(kMaxRobots));
  std::stable_partition(robots.begin(), robots.end(),
                        [](const RobotDescription& robot) { return robot.robot.travel.drives(); });
  number_equal_names(robots);
  return robots;
}

std::size_t robot_named(const std::string& name, const std::string& giver,
                        std::span<const RobotDescription> robots) {
  const auto robot = std::find_if(robots.begin(), robots.end(),
                                  [&](const RobotDescription& r) { return r.robot.name == name; });
  if (robot != robots.end()) return static_cast<std::size_t>(robot - robots.begin());
  std::string names;
  for (const RobotDescription& r : robots) names.append(names.empty() ? "" : ", ").append(r.robot.name);
  throw BadInput(giver + " is for a robot that is not in the team; its robots are " + names);
}

bool Attendance::at(double time) const {
  const bool is_late = joins && !(fails && *fails < *joins);
  const bool has_failed = fails && time >= *fails, has_joined = joins && time >= *joins;
  return is_late ? has_joined && !has_failed : has_joined || !has_failed;
}

std::vector<Attendance> attendance_of(const ExploreOptions& options,
                                      std::span<const RobotDescription> robots) {
  std::vector<Attendance> attendance(robots.size());
  const auto set = [&](const RobotTimes& times, const char* option, std::optional<double> Attendance::*time) {
    const std::string giver = std::string(option) + ": " + quote(times.word);
    for (const auto& [name, seconds] : times.each) {
      Attendance& robot = attendance[robot_named(name, giver, robots)];
      if (robot.*time) throw BadInput(giver + " names " + name + " twice");
      robot.*time = seconds;
      if (robot.fails == robot.joins)
        throw BadInput(giver + ": " + name + " fails at that time; give another time");
    }
  };
  set(options.failures, "--fail", &Attendance::fails);
  set(options.joins, "--join", &Attendance::joins);
  return attendance;
}

}  // namespace frontlux::app
