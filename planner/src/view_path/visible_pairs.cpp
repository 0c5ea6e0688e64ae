#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

std::uint32_t place(std::size_t i) { return static_cast<std::uint32_t>(i); }

void check_countable(const char* what, std::size_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("visible pairs: " + std::to_string(count) + " " + what +
                                ", more than 2^32 - 1");
}

// FieldOfView::contains_at_some_yaw, which calls tan and hypot, asked only where rounding could matter.
class Reach {
 public:
  explicit Reach(const FieldOfView& view) : view_(view), squared_range_(view.max_range * view.max_range) {
    const bool cone = view.shape == FieldOfView::Shape::kCone;
    const double slope = std::tan((cone ? view.horizontal : view.vertical) / 2);
    squared_slope_ = slope * slope;
  }

  [[nodiscard]] bool holds(const Eigen::Vector3d& offset) const {
    constexpr double kRounding = 1e-12;
    if (!(offset.squaredNorm() <= squared_range_)) return false;
    const double rise = offset.z() * offset.z();
    const double limit = squared_slope_ * (offset.x() * offset.x() + offset.y() * offset.y());
    if (rise > limit * (1.0 + kRounding)) return false;
    return rise < limit * (1.0 - kRounding) || view_.contains_at_some_yaw(offset);
  }

 private:
  const FieldOfView& view_;
  double squared_range_, squared_slope_ = 0.0;
};

}  // namespace

VisiblePairs::VisiblePairs(std::size_t viewpoints, std::size_t frontiers,
                           std::span<const VisiblePair> pairs) {
  check_countable("viewpoints", viewpoints);
  check_countable("frontiers", frontiers);
  by_viewpoint_.first.assign(viewpoints + 1, 0);
  by_frontier_.first.assign(frontiers + 1, 0);
  for (const auto& [viewpoint, frontier] : pairs) {
    if (viewpoint >= viewpoints || frontier >= frontiers)
      throw std::invalid_argument("visible pairs: there is no pair of viewpoint " +
                                  std::to_string(viewpoint) + " of " + std::to_string(viewpoints) +
                                  " and frontier " + std::to_string(frontier) + " of " +
                                  std::to_string(frontiers));
    ++by_viewpoint_.first[viewpoint + 1];
    ++by_frontier_.first[frontier + 1];
  }
  for (Index* index : {&by_viewpoint_, &by_frontier_}) {
    for (std::size_t i = 1; i < index->first.size(); ++i) index->first[i] += index->first[i - 1];
    index->other.resize(pairs.size());
  }
  // Rows of viewpoints filled by one pass over the pairs, then those of frontiers by viewpoint: ascending.
  auto next = by_viewpoint_.first;
  for (const auto& [viewpoint, frontier] : pairs) by_viewpoint_.other[next[viewpoint]++] = frontier;
  next = by_frontier_.first;
  for (std::size_t i = 0; i < viewpoints; ++i) {
    const auto row =
        std::span(by_viewpoint_.other)
            .subspan(by_viewpoint_.first[i], by_viewpoint_.first[i + 1] - by_viewpoint_.first[i]);
    if (!std::is_sorted(row.begin(), row.end())) std::sort(row.begin(), row.end());
    if (const auto twice = std::adjacent_find(row.begin(), row.end()); twice != row.end())
      throw std::invalid_argument("visible pairs: viewpoint " + std::to_string(i) + " sees frontier " +
                                  std::to_string(*twice) + " twice");
    for (const std::uint32_t j : row) by_frontier_.other[next[j]++] = place(i);
  }
}

VisiblePairs visible_pairs(const RayCaster& caster, const VoxelGrid& grid, std::span<const Pose> viewpoints,
                           std::span<const VoxelKey> frontiers, const FieldOfView& view) {
  check_finite(viewpoints);
  check_countable("viewpoints", viewpoints.size());
  check_countable("frontiers", frontiers.size());
  view.check();
  const auto targets = centers(grid.lattice(), frontiers);
  const Reach reach(view);
  std::vector<VisiblePair> pairs;
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const Eigen::Vector3d from = viewpoints[i].position;
    for (std::size_t j = 0; j < targets.size(); ++j) {
      const Eigen::Vector3d offset = targets[j] - from;
      if (!reach.holds(offset)) continue;
      pairs.push_back({place(i), place(j)});
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
  for (const VoxelKey& key : keys)
    points.emplace_back(lattice.center(key.x), lattice.center(key.y), lattice.center(key.z));
  return points;
}

void check_finite(std::span<const Pose> viewpoints) {
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const auto& [position, yaw] = viewpoints[i];
    if (position.allFinite() && std::isfinite(yaw)) continue;
    throw std::invalid_argument("viewpoint " + std::to_string(i) + " is not finite: x " +
                                std::to_string(position.x()) + ", y " + std::to_string(position.y()) +
                                ", z " + std::to_string(position.z()) + ", yaw " + std::to_string(yaw));
  }
}

}  // namespace frontlux::planner
