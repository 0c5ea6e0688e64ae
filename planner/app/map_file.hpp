#pragma once

#include <frontlux/octomap.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <filesystem>
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
  std::uint64_t bytes = 0;  ///< by OctoMap's own reckoning, which leaves the allocator's share out
};

[[nodiscard]] TreeSize tree_size(const MapFile& map);

[[nodiscard]] VoxelGrid make_voxel_grid(const MapFile& map);

}  // namespace frontlux::app
