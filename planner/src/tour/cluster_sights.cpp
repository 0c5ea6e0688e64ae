#include "tour/cluster_sights.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr int kLongestPause = 8;  // [plannings]

}  // namespace

// Returns the clusters that it sees from none, unless nothing has changed for them.
std::vector<ClusterSights::Hidden> ClusterSights::look_from_usual_places(const Query& query) {
  std::map<std::uint32_t, Sight> sights;
  std::vector<std::pair<const FrontierCluster*, Sight*>> search;
  const auto near = [&](const FrontierCluster& cluster) {
    const KeyBox around = grown(cluster.box, query.view.region.reach());
    return std::ranges::any_of(query.changes,
                               [&](const KeyBox& box) { return intersection(box, around).has_value(); });
  };
  for (const FrontierCluster& cluster : query.clusters) {
    Sight& sight = sights[cluster.id];
    if (const auto before = sights_.find(cluster.id); before != sights_.end())
      sight = std::move(before->second);
    if (sight.revision != cluster.revision || near(cluster)) search.emplace_back(&cluster, &sight);
  }
  for_each_index(search.size(), [&](std::size_t i) {
    const auto& [cluster, sight] = search[i];
    sight->revision = cluster->revision;
    sight->found = find_viewpoints(query.view, *cluster, sight->found);
    sight->stale = true;
  });
  sights_ = std::move(sights);
  // Where the robot can get to may change without a change near by: what it cannot get to now it keeps.
  std::vector<Hidden> hidden;
  for (const FrontierCluster& cluster : query.clusters) {
    Sight& sight = sights_[cluster.id];
    sight.stale = sight.stale || !sight.viewpoints.empty();
    sight.viewpoints.clear();
    std::ranges::copy_if(sight.found, std::back_inserter(sight.viewpoints),
                         [&](const ClusterViewpoint& viewpoint) { return query.reaches(viewpoint.cell); });
    if (!sight.viewpoints.empty()) {
      sight.stale = false;
      sight.in_vain = sight.pause = 0;
      continue;
    }
    sight.pause = std::max(0, sight.pause - 1);
    if (sight.stale) hidden.emplace_back(&cluster, &sight);
  }
  return hidden;
}

void ClusterSights::look_from_anywhere(const Query& query, std::span<const Hidden> hidden) {
  for_each_index(hidden.size(), [&](std::size_t i) {
    const auto& [cluster, sight] = hidden[i];
    sight->viewpoints = viewpoints_anywhere(query.view, *cluster, query.reaches);
    sight->found.insert(sight->found.end(), sight->viewpoints.begin(), sight->viewpoints.end());
    sight->stale = false;
    sight->in_vain = sight->viewpoints.empty() ? std::min(sight->in_vain + 1, 30) : 0;
    sight->pause = sight->in_vain == 0 ? 0 : std::min(1 << sight->in_vain, kLongestPause);
  });
}

void ClusterSights::update(const Query& query) {
  std::vector<Hidden> hidden = look_from_usual_places(query);
  if (!query.can_move) return;
  const auto later = std::stable_partition(hidden.begin(), hidden.end(),
                                           [](const Hidden& h) { return h.second->pause == 0; });
  look_from_anywhere(query, {hidden.begin(), later});
  const auto is_seen = [](const auto& sight) { return !sight.second.viewpoints.empty(); };
  if (std::ranges::none_of(sights_, is_seen)) look_from_anywhere(query, {later, hidden.end()});
}

void ClusterSights::look_again() {
  for (auto& [cluster, sight] : sights_) {
    if (!sight.viewpoints.empty()) continue;
    sight.stale = true;
    sight.in_vain = sight.pause = 0;
  }
}

std::span<const ClusterViewpoint> ClusterSights::viewpoints(std::uint32_t cluster) const {
  const auto sight = sights_.find(cluster);
  return sight == sights_.end() ? std::span<const ClusterViewpoint>() : sight->second.viewpoints;
}

}  // namespace frontlux::planner::detail
