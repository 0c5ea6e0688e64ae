#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

void check_countable(const char* what, std::size_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("visible pairs: " + std::to_string(count) + " " + what +
                                ", more than 2^32 - 1");
}

}  // namespace

VisiblePairs::VisiblePairs(std::size_t viewpoints, std::size_t frontiers, std::span<const VisiblePair> pairs)
    : frontiers_(frontiers), first_(viewpoints + 1, 0), seen_(pairs.size()) {
  check_countable("viewpoints", viewpoints);
  check_countable("frontiers", frontiers);
  for (const auto& [viewpoint, frontier] : pairs) {
    if (viewpoint >= viewpoints || frontier >= frontiers)
      throw std::invalid_argument("visible pairs: there is no pair of viewpoint " +
                                  std::to_string(viewpoint) + " of " + std::to_string(viewpoints) +
                                  " and frontier " + std::to_string(frontier) + " of " +
                                  std::to_string(frontiers));
    ++first_[viewpoint + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  auto next = first_;
  for (const auto& [viewpoint, frontier] : pairs) seen_[next[viewpoint]++] = frontier;
  for (std::size_t i = 0; i < viewpoints; ++i) {
    const auto row = std::span(seen_).subspan(first_[i], first_[i + 1] - first_[i]);
    std::sort(row.begin(), row.end());
    if (const auto twice = std::adjacent_find(row.begin(), row.end()); twice != row.end())
      throw std::invalid_argument("visible pairs: viewpoint " + std::to_string(i) + " sees frontier " +
                                  std::to_string(*twice) + " twice");
  }
}

VisiblePairs visible_pairs(const RayCaster& caster, const VoxelGrid& grid, std::span<const Pose> viewpoints,
                           std::span<const VoxelKey> frontiers, const FieldOfView& view) {
  check_finite(viewpoints);
  check_countable("viewpoints", viewpoints.size());
  check_countable("frontiers", frontiers.size());
  view.check();
  const auto targets = centers(grid.lattice(), frontiers);
  // FieldOfView::contains_at_some_yaw, which calls tan and hypot: called only where rounding could matter.
  const double squared_range = view.max_range * view.max_range, squared_slope = view.slope() * view.slope();
  const auto in_view = [&](const Eigen::Vector3d& offset) {
    constexpr double kRounding = 1e-12;
    if (!(offset.squaredNorm() <= squared_range)) return false;
    const double rise = offset.z() * offset.z();
    const double limit = squared_slope * (offset.x() * offset.x() + offset.y() * offset.y());
    if (rise > limit * (1.0 + kRounding)) return false;
    return rise < limit * (1.0 - kRounding) || view.contains_at_some_yaw(offset);
  };
  std::vector<VisiblePair> pairs;
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const Eigen::Vector3d from = viewpoints[i].position;
    for (std::size_t j = 0; j < targets.size(); ++j) {
      if (!in_view(targets[j] - from)) continue;
      pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
      segments.push_back({from.cast<float>(), targets[j].cast<float>()});
    }
  }
  std::vector<std::uint8_t> visible(segments.size());
  caster.visible(segments, visible, UnknownPolicy::kBlock);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (visible[i] != 0) pairs[kept++] = pairs[i];
  pairs.resize(kept);
  return {viewpoints.size(), frontiers.size(), pairs};
}

std::vector<Eigen::Vector3d> centers(const Lattice& lattice, std::span<const VoxelKey> keys) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(keys.size());
  for (const VoxelKey& key : keys) points.push_back(lattice.exact_center(key));
  return points;
}

}  // namespace frontlux::planner
