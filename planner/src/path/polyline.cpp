#include "path/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace frontlux::planner::detail {

double length_of(const Polyline& way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  return length;
}

Polyline divided(const Polyline& way, double spacing) {
  constexpr double kSlack = 1e-9;  // of the spacing
  Polyline points;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (i > 0) {
      const Eigen::Vector3d from = way[i - 1], step = way[i] - from;
      const double parts = std::max(1.0, std::ceil(step.norm() / spacing - kSlack));
      for (double k = 1.0; k < parts; ++k) {
        // Not beyond the end by a rounding: the way that was found free ends there.
        const Eigen::Vector3d point = from + step * (k / parts);
        points.emplace_back(point.cwiseMax(from.cwiseMin(way[i])).cwiseMin(from.cwiseMax(way[i])));
      }
    }
    points.push_back(way[i]);
  }
  return points;
}

Polyline shortened(Polyline way, double step, int rounds,
                   const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& is_free) {
  constexpr double kEnough = 0.999;
  double length = length_of(way);
  bool turned = false;
  for (int round = 0; round < rounds && way.size() > 2; ++round) {
    // The bends alone first: there are few of them, and most go.
    const Polyline points = round == 0 ? way : divided(way, step);
    Polyline kept = {points.front()};
    for (std::size_t at = 0; at + 1 < points.size();) {
      std::size_t next = points.size() - 1;
      while (next > at + 1 && !is_free(points[at], points[next])) --next;
      kept.push_back(points[next]);
      at = next;
    }
    std::reverse(kept.begin(), kept.end());  // cut from the other end in the next round
    turned = !turned;
    way = std::move(kept);
    const double now = length_of(way);
    if (round > 1 && now > kEnough * length) break;
    length = now;
  }
  if (turned) std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace frontlux::planner::detail
