#pragma once

#include "support/test.hpp"

#include <frontlux/planner/recording.hpp>

namespace frontlux::test {

/// What the paper's team, or its UAV alone, explores of a built-in world within so many steps, with simulated
/// sensors that do not err.
[[nodiscard]] planner::Recording explored_run(const std::string& world, int steps, bool uav_alone = false);

}  // namespace frontlux::test
