#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/goal_selection.hpp>

#include <filesystem>
#include <span>

namespace frontlux::app {

/// Writes rendered cells, a line for each: key, centre [m], distance [m], gain and its standard error,
/// quality, hits, best yaw [rad]. The file appears complete or not at all.
/// @throws std::runtime_error naming the file, if it cannot be written
void write_csv(const std::filesystem::path& file, const Lattice& lattice,
               std::span<const planner::RenderedCell> cells);

/// The same as points of a binary PLY file, coloured by quality, without the keys.
/// @throws std::runtime_error naming the file, if it cannot be written
void write_ply(const std::filesystem::path& file, const Lattice& lattice,
               std::span<const planner::RenderedCell> cells);

}  // namespace frontlux::app
