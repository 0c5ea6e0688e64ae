#pragma once

#include "explore/run_loop.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/accuracy.hpp>
#include <frontlux/sim/unseen.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::app {

struct ExploreOptions;
struct ExploreRun;
struct ExploreSetup;

/// A step with the voxels that it made known, as it is recorded.
/// @param before  the step before, or null for the first
[[nodiscard]] planner::RecordedStep with_known_voxels(planner::ExplorationStep step,
                                                      const planner::RecordedStep* before,
                                                      const sim::GroundTruth& truth);

/// What a run comes to, summed over its steps.
struct RunSums {
  double observable = 0.0, bounding = 0.0;  ///< mapped fractions, 0 to 1, at the end of the last step
  std::uint64_t steps = 0;                  ///< without the look around at the start
  std::uint64_t collisions = 0;
  std::vector<double> seconds;        ///< by planner::Phase
  std::vector<double> travelled;      ///< [m] of each robot
  std::vector<double> planning = {};  ///< [s] of each step

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

/// [s] when this part of the observable voxels was mapped; nothing if it was not.
[[nodiscard]] std::optional<double> time_to(const RunNumbers& numbers, std::uint64_t observable, double part);

/// The mapped part of the observable voxels, 0 to 1, on average over the run's time.
[[nodiscard]] double mean_coverage(const RunNumbers& numbers, std::uint64_t observable);

/// What came out of a run.
struct RunResult {
  const RunSums& sums;
  const RunNumbers& numbers;
  std::string end;                           ///< why it ended, in one word
  const std::vector<std::string>& warnings;  ///< what its reader has to know, see `run_warnings`
  const std::optional<sim::Unseen>& unseen;  ///< why, if it ended by itself
  sim::Accuracy accuracy;                    ///< of the map
  double seconds = 0.0;                      ///< that it took
};

/// Writes run.json: what was asked for and what came out.
/// @return its bytes
/// @throws std::runtime_error naming the file, if it cannot be written
std::string write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                           const RunResult& result);

inline constexpr const char* kReport = "report.html";
/// Where a run's report is.
[[nodiscard]] std::filesystem::path report_of(const ExploreRun& run);

/// What run.json holds as one line, with the run's `folder` and its `report`, which is null if there is none.
[[nodiscard]] std::string result_line(const std::string& run_json, const ExploreRun& run);

inline constexpr const char* kRunJson = "run.json";
/// The text of a run's run.json, for its report; empty if there is none.
/// @throws std::runtime_error naming the file, if it cannot be read
[[nodiscard]] std::string read_run_json(const std::filesystem::path& folder);

/// The limit of the steps of the run that wrote run.json last; nothing if that cannot be told.
[[nodiscard]] std::optional<int> last_limit(const std::filesystem::path& folder);

}  // namespace frontlux::app
