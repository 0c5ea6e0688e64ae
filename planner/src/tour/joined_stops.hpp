#pragma once

#include "routing/number_table.hpp"

#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// Viewpoints that were found for some clusters, and what else each of them sees.
struct SharedViews {
  std::vector<std::size_t> found_for;  ///< the cluster of each viewpoint
  NumberTable parts;                   ///< of each cluster (column) that a viewpoint (row) sees
  std::vector<double> sizes;           ///< [frontiers] of the clusters
};

/// Clusters that a robot looks at from one place.
struct JoinedStop {
  std::vector<std::size_t> clusters;    ///< ascending
  std::vector<std::size_t> viewpoints;  ///< from which it sees them all; first the one with most in view
};

/// Puts clusters together, so that few places see them all: each time those that are left and that one
/// viewpoint sees, the one with most frontiers of them in view. A viewpoint sees a cluster if it was found
/// for it, or has about as much of it in view as any other. In the order of the stops' first clusters;
/// clusters without a viewpoint are in none.
[[nodiscard]] std::vector<JoinedStop> join_clusters(const SharedViews& views);

/// A stop for each cluster with a viewpoint, seen from those that were found for it, in their order.
/// @pre viewpoints of one cluster stand together
[[nodiscard]] std::vector<JoinedStop> single_stops(const SharedViews& views);

}  // namespace frontlux::planner::detail
