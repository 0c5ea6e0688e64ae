#pragma once

#include "explore/run_files.hpp"
#include "explore/run_loop.hpp"
#include "setup/explore_setup.hpp"

#include <frontlux/sim/unseen.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::app {

/// Whether a robot was cut off, or the run ended by itself far from done.
[[nodiscard]] bool ends_badly(const RunSums& sums, const RunEnd& end);

/// Who might see what a team cannot get to see.
[[nodiscard]] std::string others_than(std::span<const planner::RobotDescription> robots);

/// For which robots openings are too narrow, by how much, and how much is behind; "" if for none.
[[nodiscard]] std::string narrow_openings(const sim::Unseen& unseen,
                                          std::span<const planner::RobotDescription> robots);

/// What a reader of a run's numbers must know first: that a robot was cut off, that the run ended by itself
/// far from done, that much is where only other robots see it, that a robot started far from where it was
/// asked to or failed, or that plannings took longer than the clock charges robots in motion for them.
/// @param end     none: its user has stopped it
/// @param unseen  why the rest was not seen, if that is known
[[nodiscard]] std::vector<std::string> run_warnings(const ExploreSetup& setup, const RunSums& sums,
                                                    const RunNumbers& numbers,
                                                    const std::optional<RunEnd>& end,
                                                    const std::optional<sim::Unseen>& unseen);

}  // namespace frontlux::app
