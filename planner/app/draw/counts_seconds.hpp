#pragma once

#include <frontlux/planner/recording.hpp>

namespace frontlux::app {

/// Whether pictures of a run count seconds on its clock, and not steps: robots were in motion, where a step
/// is one robot's planning, and the clock went.
[[nodiscard]] bool counts_seconds(const planner::Recording& recording);

}  // namespace frontlux::app
