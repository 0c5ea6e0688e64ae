#pragma once

#include "routing/number_table.hpp"
#include "tour/frontier_clusters.hpp"
#include "tour/travel_graph.hpp"

#include <frontlux/field_of_view.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/view_region.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What of a frontier a line through free space has to reach.
enum class Aim : std::uint8_t {
  kMiddle,  ///< its middle
  kFace,  ///< the free voxel in front of a face that is turned towards the robot. At a low angle to a floor,
          ///< wall or ceiling neighbouring voxels block the segment to the middle, though beams meet the
          ///< frontier.
};

/// A viewpoint is as good as the best one if it sees this part of what that one sees of a cluster.
inline constexpr double kAsGood = 0.7;

/// From where a robot sees a cluster, and how much of it.
struct ClusterViewpoint {
  VoxelKey cell;         ///< of its sensor
  double yaw = 0.0;      ///< [rad] towards the middle of what it sees
  std::size_t seen = 0;  ///< frontiers of the cluster in view at this yaw, and visible through free space
  Aim aim = Aim::kMiddle;
};

/// The best first; others stay in their order.
void sort_by_seen(std::vector<ClusterViewpoint>& viewpoints);

/// What a robot's viewpoints depend on.
struct ViewpointQuery {
  const RayCaster& caster;
  const VoxelGrid& grid;
  const TravelGraph& graph;  ///< where the robot fits
  const FieldOfView& view;
  const ViewRegion& region;  ///< of the view
  double least_gain = 1.0;   ///< [frontiers] places that see fewer of a cluster are no viewpoints
};

/// What `find_viewpoints` has found.
struct FoundViewpoints {
  std::vector<ClusterViewpoint> viewpoints;
  /// If they lie on the circles: as long as the cluster, the graph's extent, the map in this box and where
  /// the robot fits in it are the same, they are.
  std::optional<KeyBox> depend_on = std::nullopt;
};

/// Some places from which a robot sees about as much of a cluster as from any, apart from each other; the
/// best first. They lie on circles around the cluster's middle or, if it sees nothing from there, where they
/// were before. None if it sees nothing from there either.
[[nodiscard]] FoundViewpoints find_viewpoints(const ViewpointQuery& query, const FrontierCluster& cluster,
                                              std::span<const ClusterViewpoint> before);

/// The same of cells all over the graph that the robot can get to.
[[nodiscard]] std::vector<ClusterViewpoint> viewpoints_anywhere(
    const ViewpointQuery& query, const FrontierCluster& cluster, Aim aim,
    const std::function<bool(const VoxelKey&)>& reaches);

/// The part of each cluster that a robot sees from each viewpoint, at its yaw; by a sample of the frontiers.
/// Viewpoints are rows, clusters are columns.
[[nodiscard]] NumberTable parts_seen(const ViewpointQuery& query,
                                     std::span<const ClusterViewpoint> viewpoints,
                                     std::span<const FrontierCluster* const> clusters);

/// The frontiers that a robot in a cell has in view at a yaw [rad], and sees through free space.
[[nodiscard]] std::vector<VoxelKey> visible_from(const ViewpointQuery& query,
                                                 std::span<const VoxelKey> frontiers, const VoxelKey& cell,
                                                 double yaw, Aim aim);

}  // namespace frontlux::planner::detail
