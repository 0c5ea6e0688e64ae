#pragma once

#include <frontlux/planner/recording.hpp>

#include <filesystem>
#include <span>
#include <string>

namespace frontlux::report {

/// A run and what to call it.
struct ReportedRun {
  std::string name;                               ///< for people; any text
  const planner::Recording* recording = nullptr;  ///< not null; lives as long as the report is being made
  /// The run.json of `frontlux explore`, for what the recording does not hold: times at rest, clearances,
  /// what bumpers did, why places stayed unseen, how right the map is. Left out if it is empty or a `misfit`.
  std::string run_json = {};
};

/// Why a run.json tells nothing about a recording: it is damaged, or of another run or another end; empty if
/// it does, or is empty.
[[nodiscard]] std::string misfit(const std::string& run_json, const planner::Recording& recording);

/// Writes runs into one HTML file that shows them in a browser: replay in 3-D, charts, tables. The file needs
/// nothing else, asks no host for anything, and appears complete or not at all. The same runs give the same
/// bytes.
/// @param runs     at least one; the first is the one that the others are compared with
/// @param version  of the program that writes it, for people
/// @throws std::invalid_argument if there is no run, or a recording has no robots or steps
/// @throws std::runtime_error naming the file, if it cannot be written
void write_report(const std::filesystem::path& file, std::span<const ReportedRun> runs,
                  const std::string& version);

}  // namespace frontlux::report
