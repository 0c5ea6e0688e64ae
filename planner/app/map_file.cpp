#include "map_file.hpp"

#include "bad_input.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <new>
#include <stdexcept>
#include <utility>
#include <variant>

namespace frontlux::app {

MapFile read_map_file(const std::filesystem::path& path) {
  MapFile map;
  map.path = path;
  try {
    map.tree = read_octree(path);
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  } catch (const std::bad_alloc&) {
    throw BadInput(path.string() + ": holds more nodes than fit into this machine's memory");
  }
  std::visit(
      [&](const auto& tree) {
        map.tree_type = tree->getTreeType();
        map.resolution = tree->getResolution();
      },
      map.tree);
  return map;
}

TreeSize tree_size(const MapFile& map) {
  return std::visit(
      [](const auto& tree) {
        const std::uint64_t leaves = tree->getNumLeafNodes();
        return TreeSize{leaves, tree->size() - leaves, tree->memoryUsage()};
      },
      map.tree);
}

VoxelGrid make_voxel_grid(const MapFile& map) {
  return std::visit([](const auto& tree) { return frontlux::make_voxel_grid(*tree); }, map.tree);
}

}  // namespace frontlux::app
