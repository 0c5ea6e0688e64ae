#pragma once

#include "corridor/cell_frame.hpp"

#include <frontlux/ray.hpp>

#include <functional>
#include <vector>

namespace frontlux::planner::detail {

/// The cells of a shortest path through open cells, both ends included; empty if there is none. By A*: in
/// time that grows with what lies between, not with all there is.
[[nodiscard]] std::vector<VoxelKey> shortest_path(const CellFrame& frame, PathMetric metric,
                                                  const VoxelKey& from, const VoxelKey& to,
                                                  const std::function<bool(const VoxelKey&)>& open);

}  // namespace frontlux::planner::detail
