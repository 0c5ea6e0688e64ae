#include "tour/frontier_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
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
  constexpr std::uint32_t kUncut = ~std::uint32_t{0};
  for (const std::uint32_t piece : cube.pieces) {
    for (const VoxelKey& key : pieces_[piece].keys) piece_[key] = 0;
    pieces_[piece].keys.clear();
    free_.push_back(piece);
  }
  cube.pieces.clear();
  for (const VoxelKey& key : cube.frontiers) piece_[key] = kUncut;
  for (const VoxelKey& first : cube.frontiers) {
    if (piece_[first] != kUncut) continue;
    const std::uint32_t number = new_piece();
    cube.pieces.push_back(number);
    Keys& keys = pieces_[number].keys;
    keys.assign(1, first);
    piece_[first] = number;
    for (std::size_t i = 0; i < keys.size(); ++i)
      for_each_neighbor(VoxelKey(keys[i]), piece_.box(), [&](const VoxelKey& neighbor) {
        if (piece_[neighbor] != kUncut || cube_of(neighbor) != at) return;
        piece_[neighbor] = number;
        keys.push_back(neighbor);
      });
    std::ranges::sort(keys);
    pieces_[number].box = bounds_of(keys);
    pieces_[number].revision = next_piece_revision_++;
  }
}

// By their first keys.
std::vector<std::uint32_t> FrontierClusters::pieces_in_order() const {
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t piece = 0; piece < pieces_.size(); ++piece)
    if (!pieces_[piece].keys.empty()) pieces.push_back(piece);
  std::ranges::sort(pieces, {}, [this](std::uint32_t piece) { return pieces_[piece].keys.front(); });
  return pieces;
}

// The largest piece that touches a small one, of those of one size the first; itself if none does.
std::uint32_t FrontierClusters::piece_for(std::uint32_t small) const {
  std::uint32_t best = small;
  for (const VoxelKey& key : pieces_[small].keys)
    for_each_neighbor(key, piece_.box(), [&](const VoxelKey& neighbor) {
      const std::uint32_t other = piece_[neighbor];
      if (other == 0 || other == small || other == best) return;
      const Keys &theirs = pieces_[other].keys, &most = pieces_[best].keys;
      if (best == small || theirs.size() > most.size() ||
          (theirs.size() == most.size() && theirs.front() < most.front()))
        best = other;
    });
  return best;
}

// Of those in changed cubes and beside them.
void FrontierClusters::find_neighbors_of_small_pieces(const std::map<VoxelKey, Keys>& changed) {
  std::set<VoxelKey> around;
  for (const auto& [at, keys] : changed)
    for_each_key(grown({at, at}, 1), [&](const VoxelKey& cube) { around.insert(cube); });
  for (const VoxelKey& at : around)
    if (const auto cube = cubes_.find(at); cube != cubes_.end())
      for (const std::uint32_t piece : cube->second.pieces)
        if (pieces_[piece].keys.size() < least_) pieces_[piece].joins = piece_for(piece);
}

// The pieces in order; those that are too small together with the largest ones that they touch, up to a
// width, and beyond it once where they would be left out.
std::vector<FrontierClusters::Part> FrontierClusters::joined_pieces() const {
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
    sizes[piece] = pieces_[piece].keys.size();
    boxes[piece] = pieces_[piece].box;
  }
  const auto is_wide = [&](const KeyBox& box) {
    const int most = kWidest * edge_ - 1;
    return box.max.x - box.min.x > most || box.max.y - box.min.y > most || box.max.z - box.min.z > most;
  };
  for (const std::uint32_t piece : order) {
    if (pieces_[piece].keys.size() >= least_) continue;
    std::uint32_t a = first_of(piece), b = first_of(pieces_[piece].joins);
    if (a == b) continue;
    const KeyBox both = hull(boxes[a], boxes[b]);
    if (is_wide(both) && (sizes[a] >= least_ || is_wide(boxes[a]) || is_wide(boxes[b]))) continue;
    if (pieces_[b].keys.front() < pieces_[a].keys.front()) std::swap(a, b);
    joined_to[b] = a;
    sizes[a] += sizes[b];
    boxes[a] = both;
  }
  std::vector<std::vector<std::uint32_t>> all(pieces_.size());
  for (const std::uint32_t piece : order) all[first_of(piece)].push_back(piece);
  std::vector<Part> joined;
  for (const std::uint32_t piece : order)
    if (!all[piece].empty()) joined.push_back({std::move(all[piece]), sizes[piece]});
  return joined;
}

FrontierClusters::Keys FrontierClusters::keys_of(const Part& part) const {
  Keys keys;
  for (const std::uint32_t piece : part.pieces)
    keys.insert(keys.end(), pieces_[piece].keys.begin(), pieces_[piece].keys.end());
  std::ranges::sort(keys);
  return keys;
}

std::vector<std::uint64_t> FrontierClusters::revisions_of(const Part& part) const {
  std::vector<std::uint64_t> revisions;
  for (const std::uint32_t piece : part.pieces) revisions.push_back(pieces_[piece].revision);
  return revisions;
}

// The id of the cluster in which most of the frontiers were before, unless a larger one has it.
ClusterId FrontierClusters::name_for(const Keys& keys, const Ids& taken) {
  std::vector<std::pair<ClusterId, std::size_t>> before;  // and how many were in them
  for (const VoxelKey& key : keys) {
    const ClusterId id = cluster_[key];
    if (id == ClusterId::kNone) continue;
    const auto known = std::ranges::find(before, id, &std::pair<ClusterId, std::size_t>::first);
    if (known == before.end())
      before.emplace_back(id, 1);
    else
      ++known->second;
  }
  std::ranges::sort(before);
  std::pair best{std::size_t{0}, ClusterId::kNone};
  for (const auto& [id, count] : before)
    if (count > best.first && !taken.contains(id)) best = {count, id};
  return best.second != ClusterId::kNone ? best.second : ClusterId{next_id_++};
}

// Of pieces that were not together before, or were others.
FrontierCluster FrontierClusters::make_cluster(const Part& part, const Ids& taken) {
  FrontierCluster cluster;
  cluster.keys = keys_of(part);
  cluster.box = bounds_of(cluster.keys);
  cluster.id = name_for(cluster.keys, taken);
  return cluster;
}

// Of all pieces, the largest first. One of the same pieces as before is what it was, and keeps its id if no
// larger one has it: all of its frontiers were in it. What is too small is left out.
void FrontierClusters::make_clusters(const Exceptions& exceptions) {
  std::vector<Part> parts = joined_pieces();
  std::erase_if(parts, [&](const Part& part) {
    return part.size < least_ && !(exceptions && exceptions(keys_of(part)));
  });
  std::ranges::stable_sort(parts, [](const Part& a, const Part& b) { return a.size > b.size; });
  for (Piece& piece : pieces_) piece.cluster = ClusterId::kNone;
  std::vector<FrontierCluster> now;
  decltype(made_of_) made_of(parts.size());
  Ids taken(parts.size());
  std::vector<std::size_t> made;
  for (const Part& part : parts) {
    std::vector<std::uint64_t> revisions = revisions_of(part);
    const auto same = made_of_.find(revisions.front());
    const bool stays =
        same != made_of_.end() && same->second.revisions == revisions && !taken.contains(same->second.id);
    FrontierCluster& cluster = now.emplace_back(stays ? std::move(clusters_[places_.at(same->second.id)])
                                                      : make_cluster(part, taken));
    if (!stays) {
      made.push_back(now.size() - 1);
      const auto old = places_.find(cluster.id);
      const bool equal = old != places_.end() && clusters_[old->second].keys == cluster.keys;
      cluster.revision = equal ? clusters_[old->second].revision : next_revision_++;
    }
    taken.insert(cluster.id);
    const std::uint64_t first = revisions.front();
    made_of.emplace(first, Made{std::move(revisions), cluster.id});
    for (const std::uint32_t piece : part.pieces) pieces_[piece].cluster = cluster.id;
  }
  for (const std::size_t i : made)
    for (const VoxelKey& key : now[i].keys) cluster_[key] = now[i].id;
  std::ranges::sort(now, {}, [](const FrontierCluster& cluster) { return cluster.keys.front(); });
  clusters_ = std::move(now);
  made_of_ = std::move(made_of);
  places_.clear();
  for (std::size_t i = 0; i < clusters_.size(); ++i) places_[clusters_[i].id] = i;
}

const FrontierCluster& FrontierClusters::cluster(ClusterId id) const { return clusters_[places_.at(id)]; }

void FrontierClusters::set_least(std::size_t least, const Exceptions& exceptions) {
  least = std::max<std::size_t>(least, 1);
  const bool had_exceptions = std::exchange(has_exceptions_, static_cast<bool>(exceptions));
  if (std::exchange(least_, least) == least && had_exceptions == has_exceptions_) return;
  for (std::uint32_t piece = 1; piece < pieces_.size(); ++piece)
    if (!pieces_[piece].keys.empty() && pieces_[piece].keys.size() < least_)
      pieces_[piece].joins = piece_for(piece);
  make_clusters(exceptions);
}

void FrontierClusters::update(std::span<const VoxelKey> frontiers, const Exceptions& exceptions) {
  Keys changed;
  std::ranges::set_symmetric_difference(frontiers_, frontiers, std::back_inserter(changed));
  if (changed.empty()) return;
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
  find_neighbors_of_small_pieces(changed_in);
  make_clusters(exceptions);
}

}  // namespace frontlux::planner::detail
