#pragma once

#include "explore/explore_options.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace frontlux::app {

/// How a run is carried out; none of it changes the result.
struct ExploreRun {
  std::filesystem::path folder;
  bool resume = false;                   ///< go on with the run that is there
  bool force = false;                    ///< else the folder has to be new or empty
  int threads = 0;                       ///< 0: all cores
  bool report = true;                    ///< write report.html
  std::optional<std::string> max_steps;  ///< of a run that goes on: another limit
};

/// Explores, and leaves the files of the run in its folder. Tells on standard output how it goes.
/// @throws BadInput, Interrupted
void explore(ExploreOptions options, const ExploreRun& run);

}  // namespace frontlux::app
