#include "map_file.hpp"

#include "bad_input.hpp"

#include <frontlux/key_box.hpp>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <new>
#include <stdexcept>
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

std::unique_ptr<RayCaster> make_caster(const MapFile& map, const VoxelGrid& grid, CasterKind kind) {
  return std::visit([&](const auto& tree) { return make_ray_caster(kind, grid, *tree); }, map.tree);
}

std::uint64_t most_voxels(const MapFile& map, std::uint64_t some, std::uint64_t by_leaf) {
  return some + by_leaf * tree_size(map).leaves;
}

std::optional<planner::FrontierSet> find_frontiers(const MapFile& map, const VoxelGrid& grid,
                                                   const KeyBox& bounds) {
  const std::uint64_t most = most_voxels(map, std::uint64_t{1} << 27, std::uint64_t{1} << 15);
  constexpr int kBrickEdge = 1 << Brick::kLog2;
  std::uint64_t around = 0;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick != nullptr || state != Occupancy::kFree || block.log2_edge <= Brick::kLog2) return;
    const KeyBox free = cube(block.corner, 1 << block.log2_edge);
    const auto all = intersection(grown(free, kBrickEdge), bounds), inside = intersection(free, bounds);
    if (all) around += size_of(*all) - (inside ? size_of(*inside) : 0);
  });
  if (around > most) return std::nullopt;
  return planner::FrontierSet(grid, bounds);
}

}  // namespace frontlux::app
