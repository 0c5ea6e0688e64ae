#include "tour/stop_groups.hpp"

#include <frontlux/key_box.hpp>

#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// @param near      distance up to which clusters are stops of their own
// @param one_edge  distance up to which zones are of one size
std::vector<StopClusters> stops_if(std::span<const SeenCluster> seen, int zone_edge, double near,
                                   double one_edge) {
  std::vector<StopClusters> stops;
  std::map<std::tuple<int, VoxelKey, std::vector<bool>>, StopClusters> zones;
  for (const auto& [cluster, middle, by, distance, is_next] : seen) {
    if (distance <= near || (distance <= 1.0 && is_next)) {
      stops.push_back({cluster});
      continue;
    }
    int edge = zone_edge;
    for (double rest = distance; rest > one_edge; rest /= 2.0) edge *= 2;
    zones[{edge, make_key(middle.x / edge, middle.y / edge, middle.z / edge), by}].push_back(cluster);
  }
  for (auto& [zone, stop] : zones) stops.push_back(std::move(stop));
  return stops;
}

}  // namespace

std::vector<StopClusters> group_into_stops(std::span<const SeenCluster> seen, int zone_edge) {
  constexpr std::size_t kMany = 200, kVeryMany = 500;
  constexpr double kOneEdge = 4.0;  // at most up to here zones are of one size
  constexpr double kNearest = 0.1;  // up to here clusters are stops of their own in any case
  double near = 1.0, one_edge = kOneEdge;
  std::vector<StopClusters> stops = stops_if(seen, zone_edge, near, one_edge);
  while (stops.size() > kMany && one_edge > 1.0)
    stops = stops_if(seen, zone_edge, near, one_edge /= std::sqrt(2.0));
  while (stops.size() > kVeryMany && near > kNearest)
    stops = stops_if(seen, zone_edge, near /= std::sqrt(2.0), one_edge);
  return stops;
}

}  // namespace frontlux::planner::detail
