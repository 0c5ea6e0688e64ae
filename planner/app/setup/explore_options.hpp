#pragma once

#include "read_value.hpp"
#include "world_source.hpp"

#include <frontlux/io/task_file.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/sim/moving_robots.hpp>
#include <frontlux/sim/scan_messages.hpp>
#include <frontlux/sim/sensor.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::app {

inline constexpr Range<double> kLatencies{kAboveZero.low, io::kMostLatency};          ///< [s]
inline constexpr Range<double> kScanDelays{0.0, io::kMostLatency};                    ///< [s]
inline constexpr Range<double> kTrackingErrors{0.0, sim::PoseErrors::kMostTracking};  ///< [m]
inline constexpr Range<double> kRobotTimes{0.0, 1e5};                                 ///< [s]
inline constexpr Range<int> kStepLimits{0}, kSampleCounts{1};

/// Where one robot's sensor starts.
struct StartPose {
  std::string word;  ///< as the user gives it: NAME=X,Y,Z,YAW
  std::string robot;
  planner::Pose pose;  ///< before the ground is aligned
};
/// @throws BadInput
void read(std::string_view word, StartPose& start);

/// When something happens to robots.
struct RobotTimes {
  struct Time {
    std::string robot;
    double seconds;
  };
  std::string word;  ///< as the user gives it: NAME=SECONDS[,NAME=SECONDS]...
  std::vector<Time> each;
};
/// @throws BadInput
void read(std::string_view word, RobotTimes& times);

/// Where a file was when a run began; empty: not known. Recorded byte for byte, whatever the name.
struct AbsolutePath {
  std::string text;
};

/// A run of `frontlux explore` as the user asks for it; everything that its result depends on. What is not
/// given depends on the mode, or on the goal.
struct ExploreOptions {
  std::string task;                 ///< the file that it comes from, in messages; not recorded
  std::optional<std::string> name;  ///< for people; if not given, the world's
  WorldSource source;               ///< its seed, if not given, is `seed`
  AbsolutePath world_path;          ///< of a world that is a file
  std::string team = "uav+ugv";
  std::vector<io::TaskRobot> robots;  ///< of a task; the team is empty then
  std::vector<std::string> robot_files;
  std::vector<AbsolutePath> robot_paths;
  std::vector<StartPose> poses;
  planner::Method mode = planner::Method::kDefault;
  std::optional<planner::GoalSearch> goal;
  std::optional<planner::PathSearch> search;
  std::optional<ViewQualityOptions::Renderer> renderer;
  bool assign = true, optimize = true;
  planner::TourPart tours_without = planner::TourPart::kNone;
  CasterKind caster = CasterKind::kFast;
  planner::SensorModel sensor_model = planner::kOctomapSensorModel;
  std::uint64_t seed = 1;
  std::optional<int> max_steps;
  std::optional<double> epsilon, lambda, advance, min_distance;
  std::optional<int> samples;
  bool lockstep = false;
  double latency = 0.1;  ///< [s]
  bool bumper = true;
  std::optional<double> stop_coverage, stop_time;  ///< part of the observable voxels, [s]
  sim::RangeErrors errors;
  sim::PoseErrors pose_errors;
  sim::MessageErrors message_errors;
  RobotTimes failures, joins;
};

/// Whether robots go on tours, the default in motion.
[[nodiscard]] bool makes_tours(const ExploreOptions& options);

/// The options given, by their names, of errors that only robots in motion have.
[[nodiscard]] std::vector<std::string_view> errors_in_motion(const ExploreOptions& options);

/// The options given, by their names, that would change nothing, since goals are chosen otherwise.
[[nodiscard]] std::vector<std::string_view> ignored_by_goals(const ExploreOptions& options);

/// Notes the absolute paths of the world's and the robots' files, as they are named from here.
void note_paths(ExploreOptions& options);

/// As it is recorded: a JSON object on one line, without what is not given; Unicode, whatever file names are.
[[nodiscard]] std::string json_text(const ExploreOptions& options);

/// What `json_text` made. Members that are missing keep their default.
/// @throws std::runtime_error if it is not such an object
[[nodiscard]] ExploreOptions explore_options_of(const std::string& text);

}  // namespace frontlux::app
