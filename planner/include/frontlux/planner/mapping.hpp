#pragma once

#include <frontlux/export.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/planner/scan.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace octomap {
class OcTree;
}

namespace frontlux::planner {

/// The voxels that a box [m] reaches into. A face that lies on the lattice, give or take a millionth of a
/// voxel, adds no voxels beyond it; what lies outside the key range is cut off.
/// @throws std::invalid_argument if the box is empty, not a number, or outside the key range
[[nodiscard]] FRONTLUX_EXPORT KeyBox voxels_of(const Lattice& lattice, const Eigen::AlignedBox3d& box);

/// What a scan says of a voxel, as probabilities that it is occupied: `hit` if a ray ended in it, else
/// `miss`. What scans say adds up as log-odds; from one half a voxel is occupied.
struct SensorModel {
  double hit, miss;
  double least, most;  ///< the sum goes no further than that
  friend bool operator==(const SensorModel&, const SensorModel&) = default;
};

/// OctoMap's own. A hit outweighs two misses, and five misses are as much as any more: after them it takes
/// three hits to make a voxel occupied. A wall that is seen at a grazing angle, and stands within its voxels,
/// is soon called free by rays that pass in front of it.
inline constexpr SensorModel kOctomapSensorModel{.hit = 0.7, .miss = 0.4, .least = 0.1192, .most = 0.971};

/// For robots that keep away from all they saw: a hit makes any voxel occupied at once. It outweighs five
/// misses after it if the voxel was unknown before; after many misses the next one frees it again.
inline constexpr SensorModel kCautiousSensorModel{.hit = 0.7, .miss = 0.46, .least = 0.32, .most = 0.971};

/// As options and files call them.
inline constexpr std::array<std::pair<std::string_view, SensorModel>, 2> kSensorModelNames = {
    {{"octomap", kOctomapSensorModel}, {"cautious", kCautiousSensorModel}}};

/// The model with this name; none if there is no such model.
[[nodiscard]] constexpr std::optional<SensorModel> sensor_model(std::string_view name) {
  for (const auto& [known, model] : kSensorModelNames)
    if (known == name) return model;
  return std::nullopt;
}

/// The map that scans go into.
struct MappingOptions {
  double resolution = 0.3;       ///< [m] edge of a voxel
  KeyBox bounds = kAllVoxels;    ///< voxels outside are never touched; rays are followed no further than that
  double surface_depth = 0.001;  ///< [m] how far behind a measured surface a scan's end point is put, so that
                                 ///< a surface that lies on a voxel face falls into the voxel behind it
  SensorModel sensor_model = kOctomapSensorModel;  ///< what scans say of voxels
};

/// What the last insertion spent [s], by part.
struct InsertionTime {
  double rays = 0.0;    ///< finding the voxels that rays pass, and merging them
  double tree = 0.0;    ///< updating the tree
  double mirror = 0.0;  ///< sorting the changes and writing them to the grid
};

/// The probabilistic map that robots fill: an octomap::OcTree and the ternary grid that mirrors it.
///
/// A scan updates the tree exactly as OctoMap's `insertPointCloud` does without discretisation and lazy
/// evaluation: every voxel that its rays pass or end in gets one update, a hit if any ray ended there, else a
/// miss. The voxels in which rays end without a hit get none.
///
/// Every method that changes the map returns the change, with no more keys than it has to have. The keys are
/// valid until the next call of one.
///
/// Thread safety: as a standard container. Insertion spreads its rays over TBB's current arena; what comes
/// out does not depend on the number of threads.
class FRONTLUX_EXPORT Mapping {
 public:
  /// @throws std::invalid_argument naming the value, if the resolution is no length, the bounds are empty,
  /// the depth is negative or not finite, or the sensor model does not keep 0 < least < miss < 0.5 < hit <
  /// most < 1
  explicit Mapping(const MappingOptions& options);
  /// Begins with a copy of what is known already, as the map of a run before. What lies outside the bounds
  /// stays as it is there; voxels are occupied from one half on, whatever the tree's own threshold.
  /// @throws std::invalid_argument the same, or if the tree has another resolution
  Mapping(const MappingOptions& options, const octomap::OcTree& known);
  ~Mapping();
  Mapping(Mapping&&) noexcept;
  Mapping& operator=(Mapping&&) noexcept;

  /// A scan. Rays with a return end in a hit, `surface_depth` behind the surface. Rays of infinite range
  /// clear all up to `max_range`; rays of range NaN change nothing.
  /// @throws std::invalid_argument if the scan fails `check` or begins outside the key range
  MapChange insert(const Scan& scan);

  /// The end points of rays from `origin` [m], world frame, taken as they are. Points beyond `max_range` [m]
  /// clear all up to it and are no hits; points that are not finite change nothing.
  /// @throws std::invalid_argument if the origin lies outside the key range or the range is not above 0
  MapChange insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points,
                   double max_range = std::numeric_limits<double>::infinity());

  /// Marks free what a robot knows to be free without seeing it; voxels outside the bounds are left out. They
  /// become as free as one miss makes an unknown voxel, unless they are freer; sensors can still correct it.
  MapChange mark_free(std::span<const VoxelKey> voxels);

  /// The map itself. Its change detection is off, since insertion reports changes by itself.
  [[nodiscard]] const octomap::OcTree& tree() const;

  /// The same as `make_voxel_grid(tree())`, kept in step.
  [[nodiscard]] const VoxelGrid& grid() const;

  /// [m] `MappingOptions::surface_depth`.
  [[nodiscard]] double surface_depth() const;

  /// Voxels outside are never touched.
  [[nodiscard]] const KeyBox& bounds() const;

  /// Of the last insertion.
  [[nodiscard]] const InsertionTime& insertion_time() const;

  /// `write_octree` of the tree.
  void write(const std::filesystem::path& file) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
