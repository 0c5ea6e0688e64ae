#include "tour/frontier_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

constexpr int kWidest = 3;  // cubes along an axis, of small pieces together

// Of a cube in which a plane holds twice the least frontiers of a cluster: in smaller ones all pieces would
// be small, and make one with all that they touch.
int least_edge(std::size_t least) {
  return static_cast<int>(std::ceil(std::sqrt(2.0 * static_cast<double>(least))));
}

// Calls `visit(neighbor)` for the voxels around one that lie in a box.
template <class Visit>
void for_each_neighbor(const VoxelKey& key, const KeyBox& box, const Visit& visit) {
  if (const auto around = intersection(grown({key, key}, 1), box)) for_each_key(*around, visit);
}

}  // namespace

FrontierClusters::FrontierClusters(const KeyBox& bounds, int edge, std::size_t least)
    : edge_(std::max(edge, least_edge(std::max<std::size_t>(least, 1)))),
      least_(std::max<std::size_t>(least, 1)),
      piece_(bounds),
      cluster_(bounds) {}

std::uint32_t FrontierClusters::new_piece() {
  if (!free_.empty()) {
    const std::uint32_t number = free_.back();
    free_.pop_back();
    return number;
  }
  pieces_.emplace_back();
  return static_cast<std::uint32_t>(pieces_.size() - 1);
}

// Finds the connected parts of a cube's frontiers anew.
void FrontierClusters::cut(Cube& cube, const VoxelKey& at) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  for (const std::uint32_t piece : cube.pieces) {
    for (const VoxelKey& key : pieces_[piece]) piece_[key] = 0;
    pieces_[piece].clear();
    free_.push_back(piece);
  }
  cube.pieces.clear();
  for (const VoxelKey& key : cube.frontiers) piece_[key] = kNone;
  for (const VoxelKey& first : cube.frontiers) {
    if (piece_[first] != kNone) continue;
    const std::uint32_t number = new_piece();
    cube.pieces.push_back(number);
    Keys& piece = pieces_[number];
    piece.assign(1, first);
    piece_[first] = number;
    for (std::size_t i = 0; i < piece.size(); ++i)
      for_each_neighbor(VoxelKey(piece[i]), piece_.box(), [&](const VoxelKey& neighbor) {
        if (piece_[neighbor] != kNone || cube_of(neighbor) != at) return;
        piece_[neighbor] = number;
        piece.push_back(neighbor);
      });
    std::ranges::sort(piece);
  }
}

// By their first keys.
std::vector<std::uint32_t> FrontierClusters::pieces_in_order() const {
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t piece = 0; piece < pieces_.size(); ++piece)
    if (!pieces_[piece].empty()) pieces.push_back(piece);
  std::ranges::sort(pieces, {}, [this](std::uint32_t piece) { return pieces_[piece].front(); });
  return pieces;
}

// The largest piece that touches a small one, of those of one size the first; itself if none does.
std::uint32_t FrontierClusters::piece_for(std::uint32_t small) const {
  std::uint32_t best = small;
  for (const VoxelKey& key : pieces_[small])
    for_each_neighbor(key, piece_.box(), [&](const VoxelKey& neighbor) {
      const std::uint32_t other = piece_[neighbor];
      if (other == 0 || other == small || other == best) return;
      const Keys &theirs = pieces_[other], &most = pieces_[best];
      if (best == small || theirs.size() > most.size() ||
          (theirs.size() == most.size() && theirs.front() < most.front()))
        best = other;
    });
  return best;
}

// The pieces in order, sorted; those that are too small together with the largest ones that they touch, up to
// a width, and beyond it once where they would be left out. What is too small all the same is left out.
std::vector<Keys> FrontierClusters::joined_pieces() const {
  std::vector<std::uint32_t> joined_to(pieces_.size());  // itself: the first piece of a cluster
  std::iota(joined_to.begin(), joined_to.end(), 0U);
  const auto first_of = [&](std::uint32_t piece) {
    while (joined_to[piece] != piece) piece = joined_to[piece];
    return piece;
  };
  const std::vector<std::uint32_t> order = pieces_in_order();
  std::vector<std::size_t> sizes(pieces_.size());  // of the clusters, by their first pieces
  std::vector<KeyBox> boxes(pieces_.size());       // around them
  for (const std::uint32_t piece : order) {
    sizes[piece] = pieces_[piece].size();
    boxes[piece] = bounds_of(pieces_[piece]);
  }
  const auto is_wide = [&](const KeyBox& box) {
    const int most = kWidest * edge_ - 1;
    return box.max.x - box.min.x > most || box.max.y - box.min.y > most || box.max.z - box.min.z > most;
  };
  for (const std::uint32_t piece : order) {
    if (pieces_[piece].size() >= least_) continue;
    std::uint32_t a = first_of(piece), b = first_of(piece_for(piece));
    if (a == b) continue;
    const KeyBox both = hull(boxes[a], boxes[b]);
    if (is_wide(both) && (sizes[a] >= least_ || is_wide(boxes[a]) || is_wide(boxes[b]))) continue;
    if (pieces_[b].front() < pieces_[a].front()) std::swap(a, b);
    joined_to[b] = a;
    sizes[a] += sizes[b];
    boxes[a] = both;
  }
  std::vector<Keys> all(pieces_.size());
  for (const std::uint32_t piece : order) {
    Keys& keys = all[first_of(piece)];
    keys.insert(keys.end(), pieces_[piece].begin(), pieces_[piece].end());
  }
  std::vector<Keys> joined;
  for (const std::uint32_t piece : order)
    if (all[piece].size() >= least_) joined.push_back(std::move(all[piece]));
  for (Keys& keys : joined) std::ranges::sort(keys);
  return joined;
}

// The id of the cluster in which most of its frontiers were before, unless a larger one has it.
void FrontierClusters::name(FrontierCluster& cluster, std::set<std::uint32_t>& taken) {
  std::vector<std::pair<std::uint32_t, std::size_t>> before;  // ids and how many were in them
  for (const VoxelKey& key : cluster.keys) {
    const std::uint32_t id = cluster_[key];
    if (id == 0) continue;
    const auto known = std::ranges::find(before, id, &std::pair<std::uint32_t, std::size_t>::first);
    if (known == before.end())
      before.emplace_back(id, 1);
    else
      ++known->second;
  }
  std::ranges::sort(before);
  std::pair<std::size_t, std::uint32_t> best{0, 0};
  for (const auto& [id, count] : before)
    if (count > best.first && !taken.contains(id)) best = {count, id};
  cluster.id = best.second != 0 ? best.second : next_id_++;
  taken.insert(cluster.id);
}

void FrontierClusters::update(std::span<const VoxelKey> frontiers) {
  Keys changed;
  std::ranges::set_symmetric_difference(frontiers_, frontiers, std::back_inserter(changed));
  frontiers_.assign(frontiers.begin(), frontiers.end());
  std::map<VoxelKey, Keys> changed_in;  // each cube
  for (const VoxelKey& key : changed) changed_in[cube_of(key)].push_back(key);
  for (const auto& [at, keys] : changed_in) {
    Cube& cube = cubes_[at];
    Keys now;
    std::ranges::set_symmetric_difference(cube.frontiers, keys, std::back_inserter(now));
    cube.frontiers = std::move(now);
    cut(cube, at);
    if (cube.frontiers.empty()) cubes_.erase(at);
  }

  std::vector<Keys> parts = joined_pieces();
  std::ranges::stable_sort(parts, [](const Keys& a, const Keys& b) { return a.size() > b.size(); });
  std::map<std::uint32_t, FrontierCluster> before;
  for (FrontierCluster& cluster : clusters_) before[cluster.id] = std::move(cluster);
  clusters_.clear();
  std::set<std::uint32_t> taken;
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
