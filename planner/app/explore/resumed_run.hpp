#pragma once

#include "explore/explore_run.hpp"
#include "setup/explore_options.hpp"

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::app {

/// The recording of the run to resume.
/// @throws BadInput if there is none, it cannot be read, or its folder cannot be written to
[[nodiscard]] planner::Recording read_run(const ExploreRun& run);

/// What the run was asked for, with the limit of its steps as it is now.
/// @throws BadInput
[[nodiscard]] ExploreOptions options_of(const planner::Recording& recorded, const ExploreRun& run);

/// Where the world of a recorded run is now.
/// @throws BadInput
[[nodiscard]] std::string find_world(const ExploreOptions& options, const ExploreRun& run);

/// @param now         what the run would begin with
/// @param most_steps  it may take
/// @throws BadInput if the world is another one now, or more steps are recorded already
void check_continues(const planner::Recording& recorded, const planner::RecordingHead& now, int most_steps,
                     const ExploreRun& run);

}  // namespace frontlux::app
