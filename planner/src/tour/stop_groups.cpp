#include "tour/stop_groups.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Clusters of one zone that the same robots see make one stop.
struct Zone {
  int edge;  // [voxels]
  VoxelKey at;
  const std::vector<bool>* by;
  std::uint32_t cluster;
  [[nodiscard]] auto key() const { return std::tie(edge, at, *by); }
};

// @param near      distance up to which clusters are stops of their own
// @param one_edge  distance up to which zones are of one size
std::vector<StopClusters> stops_if(std::span<const SeenCluster> seen, int zone_edge, double near,
                                   double one_edge) {
  std::vector<StopClusters> stops;
  std::vector<Zone> zones;  // of each cluster
  for (const auto& [cluster, middle, by, distance, is_next] : seen) {
    if (distance <= near || (distance <= 1.0 && is_next)) {
      stops.push_back({cluster});
      continue;
    }
    int edge = zone_edge;
    for (double rest = distance; rest > one_edge; rest /= 2.0) edge *= 2;
    zones.push_back({edge, make_key(middle.x / edge, middle.y / edge, middle.z / edge), &by, cluster});
  }
  std::ranges::stable_sort(zones, {}, &Zone::key);
  for (std::size_t i = 0; i < zones.size(); ++i) {
    if (i == 0 || zones[i].key() != zones[i - 1].key()) stops.emplace_back();
    stops.back().push_back(zones[i].cluster);
  }
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
