#pragma once

#include "setup/explore_options.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace frontlux::app {

/// How a run is carried out; none of it changes the result.
struct ExploreRun {
  std::filesystem::path folder;
  bool resume = false;                              ///< continue the run that is there
  bool force = false;                               ///< else the folder has to be new or empty
  int threads = 0;                                  ///< 0: all cores
  bool report = true;                               ///< write report.html
  bool quiet = false;                               ///< print neither progress nor result
  bool json = false;                                ///< print the result as a JSON object
  bool make_parents = false;                        ///< of the folder
  std::optional<int> max_steps;                     ///< of a resumed run: another limit
  std::optional<std::string> world = std::nullopt;  ///< of a resumed run: where its world's file is now
};

inline constexpr const char* kReport = "report.html";
/// Where a run's report is.
[[nodiscard]] std::filesystem::path report_of(const ExploreRun& run);

/// Explores, and writes the files of the run into its folder. Prints its progress and its result.
/// @throws BadInput, Interrupted
void explore(ExploreOptions options, const ExploreRun& run);

}  // namespace frontlux::app
