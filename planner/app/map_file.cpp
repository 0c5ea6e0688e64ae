#include "map_file.hpp"

#include "bad_input.hpp"
#include "text.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/planner/mapping.hpp>

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

VoxelGrid make_grid(const MapFile& map) {
  // As much again for what is made of the grid: the boxes of a ray caster, frontiers, a world's surface.
  const std::uint64_t need = 2 * std::uint64_t{voxel_grid_bytes(map.tree)}, available = available_memory();
  if (need > available)
    throw BadInput(map.path.string() + ": its " + std::to_string(tree_size(map).leaves) +
                   " leaves would take " + bytes_text(need) + " of memory where " + bytes_text(available) +
                   " are available; give a map of a coarser resolution");
  return make_voxel_grid(map.tree);
}

std::unique_ptr<RayCaster> make_caster(const MapFile& map, const VoxelGrid& grid, CasterKind kind) {
  return make_ray_caster(kind, grid, map.tree);
}

std::uint64_t most_voxels(const MapFile& map, std::uint64_t some, std::uint64_t by_leaf) {
  return some + by_leaf * tree_size(map).leaves;
}

KeyBox robot_space(const MapFile& map, const VoxelGrid& grid, const std::optional<Eigen::AlignedBox3d>& box,
                   planner::Motion motion) {
  const auto known = grid.known_bounds();
  if (!known) throw BadInput(map.path.string() + ": every voxel is unknown");
  std::optional<KeyBox> space = known;
  try {
    if (box) space = intersection(*known, planner::voxels_of(grid.lattice(), *box));
  } catch (const std::invalid_argument& error) {
    throw BadInput(std::string("--bounds: ") + error.what());
  }
  if (!space)
    throw BadInput("--bounds: no voxel within is known; choose a part of the map, see frontlux info " +
                   map.path.string());
  const bool plane = motion == planner::Motion::kPlane;
  const KeyBox layer{space->min, {space->max.x, space->max.y, space->min.z}};
  const std::uint64_t voxels = size_of(plane ? layer : *space),
                      most = most_voxels(map, std::uint64_t{1} << (plane ? 18U : 25U), 1024);
  if (voxels > most)
    throw BadInput(map.path.string() + ": the robot's space would have " + std::to_string(voxels) +
                   " voxels, but a map of " + std::to_string(tree_size(map).leaves) +
                   " leaves may have at most " + std::to_string(most) +
                   "; choose a part of it with --bounds");
  return *space;
}

std::optional<FrontierSet> find_frontiers(const MapFile& map, const VoxelGrid& grid, const KeyBox& bounds) {
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
  // Of real maps a leaf has some ten; a large free block alone may have as many as any map.
  const std::uint64_t most_frontiers = most_voxels(map, std::uint64_t{1} << 24, 64);
  try {
    return FrontierSet(grid, bounds, Adjacency::kFaces, most_frontiers);
  } catch (const std::length_error&) {
    return std::nullopt;
  }
}

}  // namespace frontlux::app
