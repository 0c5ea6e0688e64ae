#pragma once

#include "explore/explore_run.hpp"
#include "explore/explore_setup.hpp"
#include "explore/run_files.hpp"

#include <string>

namespace frontlux::app {

/// Writes run.json: what was asked for and what came out.
/// @param end      why the run ended, in one word
/// @param seconds  that it took
/// @throws std::runtime_error naming the file, if it cannot be written
void write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                    const RunSums& sums, const std::string& end, double seconds);

}  // namespace frontlux::app
