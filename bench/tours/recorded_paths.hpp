#pragma once

#include <frontlux/planner/recording.hpp>

#include <Eigen/Core>

#include <filesystem>
#include <vector>

namespace frontlux::bench {

/// Where one robot of a recorded run in motion went [m].
struct RecordedPath {
  /// Its start, and where it took scans.
  std::vector<Eigen::Vector3d> places;
  /// Where it looked for something and was done: of its last scans before plannings that came because its
  /// goal was reached or seen, those after which it had mapped frontiers by itself since its planning before.
  std::vector<Eigen::Vector3d> stops;
};

/// The paths of a run's robots, in the team's order.
/// @param recording  of the run
/// @param events     its events.csv, which says why robots planned
/// @throws std::runtime_error naming the file, if it cannot be read or is not of this recording
[[nodiscard]] std::vector<RecordedPath> recorded_paths(const planner::Recording& recording,
                                                       const std::filesystem::path& events);

}  // namespace frontlux::bench
