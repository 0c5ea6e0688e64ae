#include "tour/frontier_clusters.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

// Calls `visit(neighbor)` for the voxels around one that lie in a box.
template <class Visit>
void for_each_neighbor(const VoxelKey& key, const KeyBox& box, const Visit& visit) {
  if (const auto around = intersection(grown({key, key}, 1), box)) for_each_key(*around, visit);
}

}  // namespace

FrontierClusters::FrontierClusters(const KeyBox& bounds, int edge, std::size_t least)
    : edge_(std::max(edge, 1)), least_(std::max<std::size_t>(least, 1)), piece_(bounds), cluster_(bounds) {}

// The connected parts of the frontiers of each cube. Leaves their numbers in `piece_`.
std::vector<Keys> FrontierClusters::pieces(std::span<const VoxelKey> frontiers) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  for (const VoxelKey& key : frontiers) piece_[key] = kNone;
  std::vector<Keys> pieces;
  for (const VoxelKey& first : frontiers) {
    if (piece_[first] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(pieces.size() + 1);
    const VoxelKey cube = cube_of(first);
    Keys piece{first};
    piece_[first] = number;
    for (std::size_t i = 0; i < piece.size(); ++i)
      for_each_neighbor(VoxelKey(piece[i]), piece_.box(), [&](const VoxelKey& neighbor) {
        if (piece_[neighbor] != kNone || cube_of(neighbor) != cube) return;
        piece_[neighbor] = number;
        piece.push_back(neighbor);
      });
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// A piece that is too small goes to the largest one that it touches.
void FrontierClusters::join_small(std::vector<Keys>& pieces) const {
  std::vector<std::pair<std::size_t, std::size_t>> joins;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (pieces[p].size() >= least_) continue;
    std::size_t best = p;
    for (const VoxelKey& key : pieces[p])
      for_each_neighbor(key, piece_.box(), [&](const VoxelKey& neighbor) {
        if (piece_[neighbor] == 0) return;
        const std::size_t other = piece_[neighbor] - 1;
        if (pieces[other].size() > pieces[best].size() ||
            (pieces[other].size() == pieces[best].size() && other < best))
          best = other;
      });
    if (best != p) joins.emplace_back(p, best);
  }
  // From the smallest on, so that a chain of small pieces ends in one.
  std::ranges::stable_sort(joins, {}, [&](const auto& join) { return pieces[join.first].size(); });
  for (const auto& [from, to] : joins) {
    pieces[to].insert(pieces[to].end(), pieces[from].begin(), pieces[from].end());
    pieces[from].clear();
  }
}

// The id of the cluster in which most of its frontiers were before, unless a larger one has it.
void FrontierClusters::name(FrontierCluster& cluster, std::vector<std::uint32_t>& taken) {
  std::map<std::uint32_t, std::size_t> before;
  for (const VoxelKey& key : cluster.keys)
    if (cluster_[key] != 0) ++before[cluster_[key]];
  std::pair<std::size_t, std::uint32_t> best{0, 0};
  for (const auto& [id, count] : before)
    if (count > best.first && std::ranges::find(taken, id) == taken.end()) best = {count, id};
  cluster.id = best.second != 0 ? best.second : next_id_++;
  taken.push_back(cluster.id);
}

void FrontierClusters::update(std::span<const VoxelKey> frontiers) {
  std::vector<Keys> parts = pieces(frontiers);
  join_small(parts);
  for (const VoxelKey& key : frontiers) piece_[key] = 0;
  std::erase_if(parts, [&](const Keys& keys) { return keys.size() < least_; });
  for (Keys& keys : parts) std::ranges::sort(keys);
  std::ranges::stable_sort(parts, [](const Keys& a, const Keys& b) { return a.size() > b.size(); });

  std::map<std::uint32_t, FrontierCluster> before;
  for (FrontierCluster& cluster : clusters_) before[cluster.id] = std::move(cluster);
  clusters_.clear();
  std::vector<std::uint32_t> taken;
  for (Keys& keys : parts) {
    FrontierCluster cluster;
    cluster.keys = std::move(keys);
    cluster.box = bounds_of(cluster.keys);
    name(cluster, taken);
    const auto old = before.find(cluster.id);
    cluster.revision =
        old != before.end() && old->second.keys == cluster.keys ? old->second.revision : next_revision_++;
    clusters_.push_back(std::move(cluster));
  }
  for (const FrontierCluster& cluster : clusters_)
    for (const VoxelKey& key : cluster.keys) cluster_[key] = cluster.id;
  std::ranges::sort(clusters_, {}, [](const FrontierCluster& cluster) { return cluster.keys.front(); });
}

}  // namespace frontlux::planner::detail
