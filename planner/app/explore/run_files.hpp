#pragma once

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace frontlux::sim {
class GroundTruth;
}

namespace frontlux::app {

class JsonObject;

/// A step with what it made known, as it is to be recorded.
/// @param before  the step before, or null for the first
[[nodiscard]] planner::RecordedStep with_known_voxels(planner::ExplorationStep step,
                                                      const planner::RecordedStep* before,
                                                      const sim::GroundTruth& truth);

/// The tables of a run, steps.csv and paths.csv, which grow with every step, and its sums.
class RunFiles {
 public:
  /// Begins both tables anew.
  /// @throws std::runtime_error naming the file, if it cannot be written; so does `add`
  RunFiles(const std::filesystem::path& folder, const planner::RecordingHead& head);

  void add(const planner::RecordedStep& step);

  [[nodiscard]] double observable() const { return observable_; }  ///< 0 to 1, at the end of the last step
  [[nodiscard]] double bounding() const { return bounding_; }
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  [[nodiscard]] const std::vector<double>& travelled() const { return travelled_; }  ///< [m] of each robot
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] double planning_mean() const;  ///< [s] of a step
  [[nodiscard]] double planning_max() const { return planning_max_; }

  /// The members of run.json that tell what came out.
  void add_sums(JsonObject& json) const;

 private:
  void write(std::ofstream& file, const char* name, const std::string& rows);

  std::filesystem::path folder_;
  const planner::RecordingHead& head_;
  std::ofstream steps_file_, paths_file_;
  double observable_ = 0.0, bounding_ = 0.0, planning_sum_ = 0.0, planning_max_ = 0.0;
  std::uint64_t collisions_ = 0, held_back_ = 0, steps_ = 0;
  std::vector<double> travelled_, seconds_;
};

}  // namespace frontlux::app
