#pragma once

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::report::detail {

/// Changed voxels, images and paths of a run, as bytes for web/src/run_data.js, which undoes this. For each
/// step and each robot:
///
///     count of chunks (cubes of 32^3 voxels that hold a change), sorted by x, then y, then z; for each:
///       x, y, z of the chunk (key / 32) as counts; count of voxels; for each, sorted by
///       l = x + 32 y + 1024 z within the chunk: (l - the l before, at first 0) * 4 + its state afterwards
///     count of rendered cells, sorted by z, y, x; if there are any:
///       greatest gain and greatest quality as f32; differences of x of all cells to the one before (at
///       first 0), those of y, those of z; of each cell gain / greatest as a byte; of each cell
///       sqrt(quality / greatest) as a byte
///     count of planned viewpoints, those travelled, and of each x, y, z, yaw as f32
///
/// Counts and differences are those of `ByteWriter`.
[[nodiscard]] std::string run_data(const planner::Recording& recording);

}  // namespace frontlux::report::detail
