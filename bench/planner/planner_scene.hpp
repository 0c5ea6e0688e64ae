#pragma once

#include "rays/subject.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace frontlux::bench {

/// What a team's planner needs of a map. The ground robot's viewpoints are free voxels 0.75 m above the
/// lowest floor, the aerial robot's every second free voxel along each axis; both evenly thinned out.
struct PlannerScene {
  const Subject& subject;
  planner::Robot ground, aerial;
  std::vector<VoxelKey> frontiers;          ///< all frontiers of the map
  std::vector<VoxelKey> ground_cells;       ///< the largest travel corridor that was found
  std::vector<VoxelKey> aerial_cells;       ///< the same for the aerial robot
  std::vector<VoxelKey> ground_viewpoints;  ///< to render
  std::vector<VoxelKey> aerial_viewpoints;  ///< to render
  VoxelGrid scanned;                        ///< the map after one more scan of the aerial robot
  std::vector<VoxelKey> scanned_frontiers;  ///< the frontiers of `scanned`
  std::vector<VoxelKey> changed;            ///< voxels that the scan changed, sorted

  /// @throws std::runtime_error if the map has no frontiers or no free space
  PlannerScene(const Subject& subject, Adjacency adjacency, std::size_t ground_viewpoints,
               std::size_t aerial_viewpoints);

  [[nodiscard]] std::vector<planner::FrontierAgent> agents() const;
};

/// A method to render view quality.
struct Rendering {
  std::string name;  ///< of a caster, or "exact"
  const RayCaster* caster;
  ViewQualityOptions options;
};

inline constexpr const char* kExact = "exact";

/// All frontiers in view, by the rays of a caster or by the exact renderer.
/// @param azimuth_bins  0: one value for all yaws
[[nodiscard]] Rendering all_frontiers(const Subject& subject, const std::string& name, int azimuth_bins);

/// The aerial robot's yaws.
inline constexpr int kAzimuthBins = 36;

/// At most `count` of these keys, evenly chosen.
[[nodiscard]] std::vector<VoxelKey> thinned(const std::vector<VoxelKey>& keys, std::size_t count);

/// The `count` of these keys that are nearest to one in the middle of them.
[[nodiscard]] std::vector<VoxelKey> around_the_middle(std::vector<VoxelKey> keys, std::size_t count);

/// The sum of one number over all viewpoints.
template <class Number>
[[nodiscard]] double total(const ViewQualityImage& image, Number ViewQuality::*number) {
  double sum = 0;
  for (const ViewQuality& value : image.values()) sum += value.*number;
  return sum;
}

/// Number of viewpoints with different values.
[[nodiscard]] std::size_t differing(const ViewQualityImage& a, const ViewQualityImage& b);

}  // namespace frontlux::bench
