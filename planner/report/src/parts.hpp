#pragma once

#include <frontlux/report/report.hpp>
#include <frontlux/report/robot_colors.hpp>

#include <span>
#include <string>
#include <string_view>

namespace frontlux::report::detail {

/// The page that web/build.mjs makes, with two marks that a report replaces by its title and its runs.
[[nodiscard]] std::string_view page();

inline constexpr std::string_view kTitleMark = "@@frontlux-title@@";
inline constexpr std::string_view kRunsMark = "@@frontlux-runs@@";

/// Text in UTF-8, with the replacement character for bytes that are not.
[[nodiscard]] std::string unicode_of(const std::string& bytes);

/// Everything about a run except voxels, images and paths, as a JSON object: what it was, and the numbers of
/// each step. Numbers that are not finite become null, bytes that are not UTF-8 the replacement character.
[[nodiscard]] std::string run_facts(const ReportedRun& run, const std::string& version);

/// The robots' colours of data/palette.json.
[[nodiscard]] std::span<const ColorPair> aerial_colors();
[[nodiscard]] std::span<const ColorPair> ground_colors();

/// Changed voxels, images, paths, tours, trajectories and assigned frontiers of a run, as bytes that
/// web/src/run_data.js reads. Of a robot with more than 400 images, only every second one is in it, or every
/// third one, and so on. For each step and each robot:
///
///     count of chunks (cubes of 32^3 voxels that hold a change), sorted by x, then y, then z; for each:
///       x, y, z of the chunk (key / 32) as counts; count of voxels; for each, sorted by
///       l = x + 32 y + 1024 z within the chunk: (l - the l before, at first 0) * 4 + its state afterwards
///     count of rendered cells, sorted by z, y, x; if there are any:
///       greatest gain and greatest quality as f32; differences of x of all cells to the one before (at
///       first 0), those of y, those of z; of each cell gain / greatest as a byte; of each cell
///       sqrt(quality / greatest) as a byte
///     count of planned viewpoints, those travelled, and of each x, y, z, yaw as f32
///     count of stops of the planned tour, and of each x, y, z, yaw as f32, clusters and frontiers in view
///     count of points of the trajectory, and of each x, y, z as f32
///     count of frontiers that have become the robot's own or ceased to be: differences of x, of y, of z
///
/// A count takes seven bits a byte, the lowest first; the top bit says that another byte follows. A
/// difference d is written as the count 2 d, or -2 d - 1 if negative. f32 is a float, lowest byte first.
[[nodiscard]] std::string run_data(const planner::Recording& recording);

}  // namespace frontlux::report::detail
