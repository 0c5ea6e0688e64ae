#pragma once

#include "explore/explore_run.hpp"

#include <frontlux/planner/recording.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::app {

inline constexpr std::string_view kRecording = "run.frontlux";
/// All that a run writes into its folder.
inline constexpr auto kRunFiles =
    std::to_array<std::string_view>({kRecording, "run.json", "steps.csv", "paths.csv", "events.csv",
                                     "motion.csv", "tours.csv", "map.ot", "map.bt", kReport});

/// Whether a new run may have its folder. Removes what killed runs left there unfinished.
/// @param inputs  files that the run must not overwrite
/// @throws BadInput
void check_folder(const ExploreRun& run, std::span<const std::string> inputs);
/// The same, and makes the folder if there is none.
/// @throws BadInput
void make_folder(const ExploreRun& run, std::span<const std::string> inputs);

/// A link in the place of a file of the run: what it points to is none of the run's.
void remove_link(const std::filesystem::path& file);
/// Of the run before, which the recording replaces: all but that.
void remove_old_files(const std::filesystem::path& folder);
/// What shows a run up to a step that others follow now: its report, pictures and films.
void remove_views(const std::filesystem::path& folder);
/// Of runs that were killed.
void remove_unfinished_files(const std::filesystem::path& folder);

/// That the command with which a run goes on does so, in words.
[[nodiscard]] std::string how_to_resume(const ExploreRun& run);
/// What is left of a run that was stopped or could not go on, as the end of a message.
/// @param steps  that it has recorded
[[nodiscard]] std::string what_is_kept(const ExploreRun& run, const planner::RecordingHead& head,
                                       std::size_t steps);

}  // namespace frontlux::app
