#include "tour/joined_stops.hpp"

#include "tour/cluster_viewpoints.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

std::vector<JoinedStop> join_clusters(const SharedViews& views) {
  const std::size_t viewpoints = views.found_for.size(), clusters = views.sizes.size();
  std::vector<double> most(clusters);
  for (std::size_t v = 0; v < viewpoints; ++v)
    for (std::size_t c = 0; c < clusters; ++c) most[c] = std::max(most[c], views.parts(v, c));
  const auto sees = [&](std::size_t v, std::size_t c) {
    const double part = views.parts(v, c);
    return views.found_for[v] == c || (part > 0.0 && part >= kAsGood * most[c]);
  };
  std::vector<bool> joined(clusters);
  std::vector<JoinedStop> stops;
  for (;;) {
    double most_seen = 0.0;  // [frontiers]
    std::size_t best = viewpoints;
    for (std::size_t v = 0; v < viewpoints; ++v) {
      double seen = 0.0;
      for (std::size_t c = 0; c < clusters; ++c)
        if (!joined[c] && sees(v, c)) seen += std::max(1.0, views.parts(v, c) * views.sizes[c]);
      if (seen <= most_seen) continue;
      most_seen = seen;
      best = v;
    }
    if (best == viewpoints) break;
    JoinedStop stop;
    for (std::size_t c = 0; c < clusters; ++c)
      if (!joined[c] && sees(best, c)) {
        joined[c] = true;
        stop.clusters.push_back(c);
      }
    stop.viewpoints.push_back(best);
    for (std::size_t v = 0; v < viewpoints; ++v)
      if (v != best && std::ranges::all_of(stop.clusters, [&](std::size_t c) { return sees(v, c); }))
        stop.viewpoints.push_back(v);
    stops.push_back(std::move(stop));
  }
  std::ranges::sort(stops, {}, [](const JoinedStop& stop) { return stop.clusters.front(); });
  return stops;
}

std::vector<JoinedStop> single_stops(const SharedViews& views) {
  std::vector<JoinedStop> stops;
  for (std::size_t v = 0; v < views.found_for.size(); ++v) {
    const std::size_t c = views.found_for[v];
    if (stops.empty() || stops.back().clusters.front() != c)
      stops.push_back({.clusters = {c}, .viewpoints = {}});
    stops.back().viewpoints.push_back(v);
  }
  return stops;
}

}  // namespace frontlux::planner::detail
