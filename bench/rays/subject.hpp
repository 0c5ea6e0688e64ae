#pragma once

#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace frontlux::bench {

/// What is compared: castRay, the fast caster, Embree's BVH without tables, and the walk over the grid.
inline constexpr const char *kOctomap = "octomap", *kFast = "fast", *kEmbree = "embree", *kGrid = "grid";

/// The name of `make_site` among generated maps; the others are those of `synthetic::ensure_map`.
inline constexpr const char* kSite = "site_0.05m";

/// The name of a caster and what it costs.
struct CasterCost {
  std::string caster;
  double build_seconds = 0;   ///< from the octree to the caster, the grid included
  double update_seconds = 0;  ///< after one of the map's looks, the grid not included
  std::size_t bytes = 0;      ///< in addition to the octree
};

/// A caster on one map.
struct Contender : CasterCost {
  std::unique_ptr<RayCaster> rays;
};

/// A map with every caster that is compared on it.
struct Subject {
  std::string name;
  Octree tree;
  VoxelGrid grid;
  double grid_seconds = 0;            ///< from the octree to the grid
  std::vector<Contender> contenders;  ///< octomap, fast, embree, grid
  /// That a look all around shows from some place, within 6 m or 60 voxels; the median.
  double look_voxels = 0;
  std::unique_ptr<OctreeRayCaster> drop_in;  ///< null unless the map was loaded from a file

  /// The caster of this name. @throws std::invalid_argument if there is none
  [[nodiscard]] const RayCaster& caster(const std::string& name) const;
};

/// Builds the casters with as many threads as TBB's current arena has.
[[nodiscard]] std::unique_ptr<Subject> make_subject(Octree tree, std::string name);

/// Reads a map, and builds the casters and the drop-in for single calls.
/// @throws std::runtime_error naming the file, if it cannot be read or declares more voxels than a place has
[[nodiscard]] std::unique_ptr<Subject> load_subject(const std::filesystem::path& file, std::string name);

/// @throws std::runtime_error naming the file, if its map has more known voxels than a place has
void check_is_place(const VoxelGrid& grid, const std::filesystem::path& file);

/// A map's name: its file's stem, with a number if that is taken.
[[nodiscard]] std::string unique_name(const std::filesystem::path& file, std::set<std::string>& taken);

/// The median of three builds: the first one pays for pages that the allocator keeps afterwards.
[[nodiscard]] double median_seconds(const std::function<void()>& build);

/// How a caster's costs are printed: "built in 1.0 ms, 2.0 MB"
[[nodiscard]] std::string describe(const CasterCost& cost);

/// One paragraph: size of the map, time and memory of every caster.
[[nodiscard]] std::string describe(const Subject& subject);

/// Generates a map, unless it is in the folder already, and shows its progress.
/// @return its file
/// @throws std::invalid_argument if there is no such map
/// @throws std::runtime_error naming the file, if it cannot be written
[[nodiscard]] std::filesystem::path generate_map(const std::string& name, const std::filesystem::path& cache);

}  // namespace frontlux::bench
