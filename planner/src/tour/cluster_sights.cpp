#include "tour/cluster_sights.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr int kLongestPause = 8;  // [plannings]

}  // namespace

// The boxes of a query. Most clusters are far from all of them, which the box around tells at once.
struct ClusterSights::Changes {
  std::span<const KeyBox> boxes;
  std::optional<KeyBox> around = {};
  int reach;  // [voxels] of the robot's view

  explicit Changes(const Query& query) : boxes(query.changes), reach(query.view.region.reach()) {
    for (const KeyBox& box : boxes) around = around ? hull(*around, box) : box;
  }
  [[nodiscard]] bool meet(const KeyBox& within) const {
    return around && intersection(*around, within) && std::ranges::any_of(boxes, [&](const KeyBox& box) {
             return intersection(box, within).has_value();
           });
  }
};

// Whether other viewpoints may be the best now. Of a cluster that the robot does not see all that a robot
// might see it from counts.
bool ClusterSights::needs_a_look(const Changes& changes, const FrontierCluster& cluster, const Sight& sight) {
  if (sight.revision != cluster.revision) return true;
  const bool is_seen = sight.depend_on && !sight.viewpoints.empty();
  return changes.meet(is_seen ? *sight.depend_on : grown(cluster.box, changes.reach));
}

// Of each node around a cluster a cell that the robot cannot get to, or a few.
void ClusterSights::note_unreached(const Query& query, const FrontierCluster& cluster, Sight& sight) {
  const TravelGraph& graph = query.view.graph;
  std::vector<VoxelKey> cells = graph.spread_cells(grown(cluster.box, query.view.region.reach()));
  std::erase_if(cells, query.reaches);
  // Of std::ranges these two would return a range, which clang 14 does not compile.
  cells.erase(
      std::unique(cells.begin(), cells.end(),
                  [&](const VoxelKey& a, const VoxelKey& b) { return graph.node(a) == graph.node(b); }),
      cells.end());
  const auto connected = std::partition(cells.begin(), cells.end(), std::not_fn(query.connects));
  sight.behind_others.assign(connected, cells.end());
  sight.beyond.assign(cells.begin(), connected);
}

// Of the viewpoints that were found those that the robot can get to.
void ClusterSights::find_reached(const Query& query, Sight& sight) {
  sight.stale = sight.stale || !sight.viewpoints.empty();
  sight.viewpoints.clear();
  std::ranges::copy_if(sight.found, std::back_inserter(sight.viewpoints),
                       [&](const ClusterViewpoint& viewpoint) { return query.reaches(viewpoint.cell); });
  // A trial all over the graph has added its own behind those that could not be reached then.
  sort_by_seen(sight.viewpoints);
  if (!sight.viewpoints.empty()) {
    sight.stale = false;
    sight.in_vain = sight.pause = 0;
    return;
  }
  sight.found_beyond =
      std::ranges::any_of(sight.found, [&](const ClusterViewpoint& v) { return !query.connects(v.cell); });
  sight.pause = std::max(0, sight.pause - 1);
  if (sight.stale && sight.faces_stale) return;
  // Others open something whenever they move: it is not looked again each time.
  if (std::ranges::none_of(sight.beyond, query.connects) &&
      (sight.pause > 0 || std::ranges::none_of(sight.behind_others, query.reaches)))
    return;
  sight.stale = sight.faces_stale = true;
  sight.beyond.clear();
  sight.behind_others.clear();
}

// Returns the clusters that it sees from none, unless nothing has changed for them.
std::vector<ClusterSights::Hidden> ClusterSights::look_from_usual_places(const Query& query) {
  std::map<ClusterId, Sight> sights;
  std::vector<std::pair<const FrontierCluster*, Sight*>> search;
  const std::optional<KeyBox> extent = std::exchange(extent_, query.view.graph.extent());
  const bool same_extent = extent_ == extent;
  const Changes changes(query);
  for (const FrontierCluster& cluster : query.clusters) {
    Sight& sight = sights[cluster.id];
    if (const auto before = sights_.find(cluster.id); before != sights_.end())
      sight = std::move(before->second);
    if (!same_extent) sight.depend_on.reset();
    if (needs_a_look(changes, cluster, sight)) search.emplace_back(&cluster, &sight);
  }
  for_each_index(search.size(), [&](std::size_t i) {
    const auto& [cluster, sight] = search[i];
    sight->revision = cluster->revision;
    auto [found, depend_on] = find_viewpoints(query.view, *cluster, sight->found);
    sight->found = std::move(found);
    sight->depend_on = depend_on;
    sight->stale = sight->faces_stale = true;
  });
  sights_ = std::move(sights);
  // Where the robot can get to may change without a change near by: what it cannot get to now it keeps.
  std::vector<Hidden> hidden;
  for (const FrontierCluster& cluster : query.clusters) {
    Sight& sight = sights_[cluster.id];
    find_reached(query, sight);
    if (sight.viewpoints.empty() && sight.stale) hidden.emplace_back(&cluster, &sight);
  }
  return hidden;
}

void ClusterSights::look_from_anywhere(const Query& query, std::span<const Hidden> hidden) {
  for_each_index(hidden.size(), [&](std::size_t i) {
    const auto& [cluster, sight] = hidden[i];
    sight->viewpoints = viewpoints_anywhere(query.view, *cluster, Aim::kMiddle, query.reaches);
    note_unreached(query, *cluster, *sight);
    sight->found.insert(sight->found.end(), sight->viewpoints.begin(), sight->viewpoints.end());
    sight->depend_on.reset();
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
  if (!sees_any()) look_from_anywhere(query, {later, hidden.end()});
}

void ClusterSights::look_at_faces(const Query& query) {
  std::vector<Hidden> hidden;
  for (const FrontierCluster& cluster : query.clusters)
    if (Sight& sight = sights_[cluster.id]; sight.viewpoints.empty() && sight.faces_stale)
      hidden.emplace_back(&cluster, &sight);
  for_each_index(hidden.size(), [&](std::size_t i) {
    const auto& [cluster, sight] = hidden[i];
    sight->viewpoints = viewpoints_anywhere(query.view, *cluster, Aim::kFace, query.reaches);
    note_unreached(query, *cluster, *sight);
    sight->faces_stale = false;
    if (sight->viewpoints.empty()) return;
    sight->found = sight->viewpoints;
    sight->depend_on.reset();
  });
}

bool ClusterSights::sees_any() const {
  return std::ranges::any_of(sights_, [](const auto& sight) { return !sight.second.viewpoints.empty(); });
}

bool ClusterSights::would_see_any() const {
  return std::ranges::any_of(sights_, [](const auto& sight) {
    return sight.second.viewpoints.empty() && sight.second.found_beyond;
  });
}

void ClusterSights::look_again() {
  for (auto& [cluster, sight] : sights_) {
    if (!sight.viewpoints.empty()) continue;
    sight.stale = sight.faces_stale = true;
    sight.in_vain = sight.pause = 0;
  }
}

std::span<const ClusterViewpoint> ClusterSights::viewpoints(ClusterId cluster) const {
  const auto sight = sights_.find(cluster);
  return sight == sights_.end() ? std::span<const ClusterViewpoint>() : sight->second.viewpoints;
}

}  // namespace frontlux::planner::detail
