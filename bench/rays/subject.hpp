#pragma once

#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace frontlux::bench {

/// A caster and what it costs to have one.
struct Contender {
  std::string name;
  std::unique_ptr<RayCaster> caster;
  double build_seconds = 0;  ///< from the tree to the caster, with all that lies between
  std::size_t bytes = 0;     ///< beside the tree
};

/// A map with every caster that is compared on it.
struct Subject {
  std::string name;
  Octree tree;
  VoxelGrid grid;
  std::vector<Contender> contenders;         ///< octomap, grid, embree, fast
  std::unique_ptr<OctreeRayCaster> drop_in;  ///< null unless the map was loaded from a file

  [[nodiscard]] const Contender& contender(const std::string& caster) const;
};

/// Builds the casters with as many threads as TBB's current arena has.
[[nodiscard]] std::unique_ptr<Subject> make_subject(Octree tree, std::string name);

/// Reads a map, and builds the casters and the drop-in for single calls.
/// @throws std::runtime_error naming the file
[[nodiscard]] std::unique_ptr<Subject> load_subject(const std::filesystem::path& file, std::string name);

/// One paragraph: size of the map, time and memory of every caster.
[[nodiscard]] std::string describe(const Subject& subject);

}  // namespace frontlux::bench
