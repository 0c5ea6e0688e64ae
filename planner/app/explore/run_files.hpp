#pragma once

#include "explore/run_loop.hpp"

#include <frontlux/planner/recording.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace frontlux::app {

/// What a run comes to, summed over its steps.
struct RunSums {
  double observable = 0.0, bounding = 0.0;  ///< mapped fractions, 0 to 1, at the end of the last step
  std::uint64_t steps = 0;                  ///< without the look around at the start
  std::vector<double> seconds;              ///< by planner::Phase
  std::vector<double> travelled;            ///< [m] of each robot
  std::vector<double> planning = {};        ///< [s] of each step in which somebody planned

  [[nodiscard]] double planning_mean() const;                   ///< [s] of a step
  [[nodiscard]] double planning_percentile(double part) const;  ///< [s] at a part of the sorted steps, 0 to 1
};

/// The tables of a run, which grow with every step, and its sums.
class RunFiles {
 public:
  /// Begins the tables anew.
  /// @throws std::runtime_error naming the file, if it cannot be written; so does `add`
  RunFiles(const std::filesystem::path& folder, const planner::RecordingHead& head);

  void add(const planner::RecordedStep& step);
  void add(const MotionRows& rows);

  [[nodiscard]] const RunSums& sums() const { return sums_; }

 private:
  void write(std::ofstream& file, const char* name, const std::string& rows);

  std::filesystem::path folder_;
  const planner::RecordingHead& head_;
  std::ofstream steps_file_, paths_file_, events_file_, motion_file_, tours_file_;
  RunSums sums_;
};

}  // namespace frontlux::app
