#pragma once

#include "explore/run_files.hpp"
#include "explore/run_loop.hpp"

#include <frontlux/sim/accuracy.hpp>
#include <frontlux/sim/unseen.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::app {

struct ExploreOptions;
struct ExploreRun;
struct ExploreSetup;

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

/// What run.json holds as one line, with the run's `folder` and its `report`, which is null if there is none.
[[nodiscard]] std::string result_line(const std::string& run_json, const ExploreRun& run);

inline constexpr const char* kRunJson = "run.json";
/// The text of a run's run.json, for its report; empty if there is none.
/// @throws std::runtime_error naming the file, if it cannot be read
[[nodiscard]] std::string read_run_json(const std::filesystem::path& folder);

/// The limit of the steps of the run that wrote run.json last; nothing if that cannot be told.
[[nodiscard]] std::optional<int> last_limit(const std::filesystem::path& folder);

}  // namespace frontlux::app
