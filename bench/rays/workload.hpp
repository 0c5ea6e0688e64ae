#pragma once

#include "rays/free_voxels.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::bench {

/// Rays that are cast in one call.
struct RayBatch {
  std::vector<Ray> rays;
  UnknownPolicy unknown;
};

/// Queries taken from a map. Either segments or batches of rays.
struct Workload {
  std::string name;
  std::vector<KeySegment> segments;  ///< for `UnknownPolicy::kBlock`
  std::vector<RayBatch> batches;
  std::string skipped;  ///< why there are none, if there are none

  [[nodiscard]] std::size_t size() const;
};

inline constexpr std::array<std::string_view, 5> kWorkloads{"visible_ugv", "visible_uav", "cast_lidar",
                                                            "cast_random", "cast_single"};

/// Draws workloads from one map. What it draws depends on the map and the arguments alone. Rays are in
/// spatial order of their origins, as those of a planner or a sensor model.
class WorkloadSource {
 public:
  /// @param caster  measures how long the rays are; both must outlive this object
  WorkloadSource(const VoxelGrid& grid, const RayCaster& caster);

  /// @param name  one of `kWorkloads`
  /// @param rays  how many, about; if not given, as many as cross `kVoxelsPerPass` voxels
  [[nodiscard]] Workload make(std::string_view name, std::optional<std::size_t> rays);

  /// castRay takes some tenths of a second for them, on long rays as on short ones.
  static constexpr double kVoxelsPerPass = 6e6;

 private:
  [[nodiscard]] Workload draw(std::string_view name, std::size_t rays);
  [[nodiscard]] const VoxelIndex& frontiers();

  const VoxelGrid& grid_;
  const RayCaster& caster_;
  std::optional<VoxelIndex> frontiers_;
};

/// Mean number of voxels that a ray of the workload enters after its first.
[[nodiscard]] double mean_voxels(const Workload& workload, const RayCaster& caster, const Lattice& lattice);

}  // namespace frontlux::bench
