#include "tours/recorded_paths.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

namespace frontlux::bench {
namespace {

using planner::RecordedStep, planner::RobotStep;

constexpr std::array<std::string_view, 10> kColumns = {"time_s",     "step",           "robot",   "reason",
                                                       "goal_state", "gain_predicted", "begin_s", "end_s",
                                                       "length_m",   "planning_s"};
constexpr std::size_t kStep = 1, kReason = 3;

// A robot's name may hold commas, quoted. What is before it is counted from the left, the rest from the
// right.
std::string_view cell_of(std::string_view row, std::size_t column) {
  const bool before_name = column <= kStep;
  for (std::size_t i = 0; before_name && i < column; ++i)
    row.remove_prefix(std::min(row.find(',') + 1, row.size()));
  if (before_name) return row.substr(0, row.find(','));
  for (std::size_t i = kColumns.size() - 1; i > column; --i) row = row.substr(0, row.rfind(','));
  return row.substr(row.rfind(',') + 1);
}

// Why robots planned, by step.
std::map<std::string, std::string, std::less<>> reasons_in(const std::filesystem::path& events) {
  std::istringstream lines(read_file(events));
  std::string line, header;
  for (const std::string_view column : kColumns) header.append(header.empty() ? "" : ",").append(column);
  if (!std::getline(lines, line) || line != header)
    fail(events, "its first line is not '" + header + "'", "give the folder of a run");
  std::map<std::string, std::string, std::less<>> reasons;
  while (std::getline(lines, line)) reasons.emplace(cell_of(line, kStep), cell_of(line, kReason));
  return reasons;
}

}  // namespace

std::vector<RecordedPath> recorded_paths(const planner::Recording& recording,
                                         const std::filesystem::path& events) {
  const auto reasons = reasons_in(events);
  std::vector<RecordedPath> paths;
  for (const planner::ExplorationStart& start : recording.head.starts)
    paths.push_back({{start.pose.position}, {}});
  std::vector<std::uint64_t> gained(paths.size());  // frontiers, since the robot's last planning
  bool any = false;
  for (const RecordedStep& recorded : recording.steps)
    for (std::size_t r = 0; r < paths.size(); ++r) {
      const RobotStep& step = recorded.step.robots[r];
      for (const planner::Pose& pose : step.planned) paths[r].places.push_back(pose.position);
      gained[r] += step.gained;
      if (step.trajectory.empty()) continue;  // another one planned
      any = true;
      const std::string number = std::to_string(recorded.step.number);
      const auto reason = reasons.find(number);
      if (reason == reasons.end())
        fail(events, "it does not have step " + number + " of the recording",
             "if the run was cut off, continue it with frontlux explore --resume");
      if ((reason->second == "arrival" || reason->second == "goal_seen") && gained[r] > 0)
        paths[r].stops.push_back(paths[r].places.back());
      gained[r] = 0;
    }
  if (!any)
    fail(events, "the run's recording has no trajectories",
         "explore anew, in motion: robots in lock-step have none, nor have recordings before format 5");
  return paths;
}

}  // namespace frontlux::bench
