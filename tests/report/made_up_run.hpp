#pragma once

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::test {

/// A recording of a UGV and a UAV that are driven through a built-in world from place to place, without a
/// planner: what their sensors see is real, goals and gains are made up. The same arguments give the same.
[[nodiscard]] planner::Recording made_up_run(const std::string& world, int steps);

}  // namespace frontlux::test
