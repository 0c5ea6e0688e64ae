#pragma once

#include <frontlux/caster_kind.hpp>
#include <frontlux/frontier_set.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace frontlux::app {

/// A map as it lies in its file.
struct MapFile {
  std::filesystem::path path;
  Octree tree;
  std::string tree_type;    ///< as OctoMap names it
  double resolution = 0.0;  ///< [m]
};

/// @throws BadInput if the file is not a map
[[nodiscard]] MapFile read_map_file(const std::filesystem::path& path);

/// How large the tree is in memory.
struct TreeSize {
  std::uint64_t leaves = 0;
  std::uint64_t inner_nodes = 0;
  std::uint64_t bytes = 0;  ///< as OctoMap computes it, without what the allocator adds
};

[[nodiscard]] TreeSize tree_size(const MapFile& map);

/// The mirror of a map.
/// @throws BadInput if it would not fit into the memory of this machine: voxels far apart take 3 kB each
[[nodiscard]] VoxelGrid make_grid(const MapFile& map);

/// @param map   outlives the caster
/// @param grid  of the map
[[nodiscard]] std::unique_ptr<RayCaster> make_caster(const MapFile& map, const VoxelGrid& grid,
                                                     CasterKind kind);

/// How many voxels of large blocks may be searched: a few bytes of a file can stand for trillions.
/// @param some     that any map may have
/// @param by_leaf  that each of its leaves adds
[[nodiscard]] std::uint64_t most_voxels(const MapFile& map, std::uint64_t some, std::uint64_t by_leaf);

/// The known part of a map, for a robot to move in.
/// @param box  [m] the part of it that the user chooses
/// @throws BadInput if nothing is known there, or if there are far more voxels than the file has leaves for
[[nodiscard]] KeyBox robot_space(const MapFile& map, const VoxelGrid& grid,
                                 const std::optional<Eigen::AlignedBox3d>& box, planner::Motion motion);

/// The frontiers of a map within bounds.
/// @param grid  of the map
/// @return nothing if the map's large free blocks have so wide a surface that it would take too long
[[nodiscard]] std::optional<FrontierSet> find_frontiers(const MapFile& map, const VoxelGrid& grid,
                                                        const KeyBox& bounds);

}  // namespace frontlux::app
