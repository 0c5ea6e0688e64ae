#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/goal_search.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frontlux::io {

inline constexpr std::size_t kMostRobots = 32;  ///< in a task
inline constexpr double kMostLatency = 60.0;    ///< [s]

/// How robots choose where to go.
struct FRONTLUX_EXPORT TaskMethod {
  std::optional<planner::GoalSearch> goal;  ///< none: as the paper prints it
  friend bool operator==(const TaskMethod&, const TaskMethod&) = default;
};
/// As files call it: that of its search, or "paper".
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(const TaskMethod& method);

/// A robot of a task.
struct TaskRobot {
  /// Its body, its sensor and its limits.
  planner::RobotDescription description;
  std::optional<planner::Pose> start;  ///< of its sensor; if not given, near the world's
};

/// An exploration as a file describes it. What is not given is left to who runs it.
struct Task {
  std::string name;   ///< for people
  std::string world;  ///< a file, or the name of a built-in world
  /// Of a built-in world.
  std::optional<std::uint64_t> world_seed;
  std::optional<Eigen::AlignedBox3d> box;  ///< [m] what is to be explored
  std::optional<double> resolution;        ///< [m]
  /// Of the run.
  std::optional<std::uint64_t> seed;
  std::optional<double> latency;  ///< [s]
  /// Whether robots wait for each other, as in Alg. 1.
  std::optional<bool> lockstep;
  /// How goals are chosen.
  std::optional<TaskMethod> method;
  std::optional<double> end_coverage;  ///< 0 to 1
  std::optional<double> end_time;      ///< [s]
  std::optional<std::string> team;     ///< words for robots that are known; not beside `robots`
  /// Named one by one.
  std::vector<TaskRobot> robots;
  /// Further options of the command by name, without dashes, and as they are written on its command line.
  std::vector<std::pair<std::string, std::string>> options;
};

/// Reads a task from a JSON file, and the robots' files that it names; docs/tasks.md says what each member
/// means. The world is not opened: its name is as in the file.
/// @throws std::runtime_error naming the file, the member, its value and what to do
[[nodiscard]] FRONTLUX_EXPORT Task read_task(const std::filesystem::path& file);

/// A task as a JSON object. Reading it gives the same task.
[[nodiscard]] FRONTLUX_EXPORT std::string task_text(const Task& task);

/// The robots alone, as a JSON array, and back.
[[nodiscard]] FRONTLUX_EXPORT std::string robots_text(std::span<const TaskRobot> robots);
/// @throws std::runtime_error if the text is not such an array
[[nodiscard]] FRONTLUX_EXPORT std::vector<TaskRobot> robots_of(const std::string& text);

}  // namespace frontlux::io
