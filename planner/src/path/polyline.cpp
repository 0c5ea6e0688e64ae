#include "path/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace frontlux::planner::detail {

double length_of(const Polyline& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

Polyline divided(const Polyline& path, double spacing) {
  constexpr double kSlack = 1e-9;  // of the spacing
  Polyline points;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      const Eigen::Vector3d from = path[i - 1], step = path[i] - from;
      const double parts = std::max(1.0, std::ceil(step.norm() / spacing - kSlack));
      for (double k = 1.0; k < parts; ++k) {
        // Rounding must not move the point beyond the end, where the checked path ends.
        const Eigen::Vector3d point = from + step * (k / parts);
        points.emplace_back(point.cwiseMax(from.cwiseMin(path[i])).cwiseMin(from.cwiseMax(path[i])));
      }
    }
    points.push_back(path[i]);
  }
  return points;
}

Polyline shortened(Polyline path, double step, int rounds, const SegmentCheck& is_free) {
  constexpr double kEnough = 0.999;
  double length = length_of(path);
  bool reversed = false;
  for (int round = 0; round < rounds && path.size() > 2; ++round) {
    // First only the bends: there are few of them, and most are cut.
    const Polyline points = round == 0 ? path : divided(path, step);
    Polyline kept = {points.front()};
    for (std::size_t at = 0; at + 1 < points.size();) {
      std::size_t next = points.size() - 1;
      while (next > at + 1 && !is_free(points[at], points[next])) --next;
      kept.push_back(points[next]);
      at = next;
    }
    std::reverse(kept.begin(), kept.end());  // cut from the other end in the next round
    reversed = !reversed;
    path = std::move(kept);
    const double now = length_of(path);
    if (round > 1 && now > kEnough * length) break;
    length = now;
  }
  if (reversed) std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace frontlux::planner::detail
