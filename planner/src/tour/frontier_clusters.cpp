#include "tour/frontier_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <unordered_set>
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
void FrontierClusters::cut(Cube& cube, const VoxelKey& at, Changes& changes) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  for (const std::uint32_t piece : cube.pieces) {
    for (const VoxelKey& key : pieces_[piece].keys) piece_[key] = 0;
    changes.groups.push_back(pieces_[piece].group);
    changes.clusters.push_back(pieces_[piece].cluster);
    std::erase(groups_.at(pieces_[piece].group), piece);
    pieces_[piece] = {};
    free_.push_back(piece);
  }
  cube.pieces.clear();
  for (const VoxelKey& key : cube.frontiers) piece_[key] = kNone;
  for (const VoxelKey& first : cube.frontiers) {
    if (piece_[first] != kNone) continue;
    const std::uint32_t number = new_piece();
    cube.pieces.push_back(number);
    Keys& keys = pieces_[number].keys;
    keys.assign(1, first);
    piece_[first] = number;
    for (std::size_t i = 0; i < keys.size(); ++i)
      for_each_neighbor(VoxelKey(keys[i]), piece_.box(), [&](const VoxelKey& neighbor) {
        if (piece_[neighbor] != kNone || cube_of(neighbor) != at) return;
        piece_[neighbor] = number;
        keys.push_back(neighbor);
      });
    std::ranges::sort(keys);
    pieces_[number].box = bounds_of(keys);
    pieces_[number].revision = next_piece_revision_++;
    changes.groups.push_back(pieces_[number].group = next_group_++);
    groups_[pieces_[number].group] = {number};
  }
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
void FrontierClusters::find_neighbors_of_small_pieces(const std::map<VoxelKey, Keys>& changed,
                                                      Changes& changes) {
  std::set<VoxelKey> around;
  for (const auto& [at, keys] : changed)
    for_each_key(grown({at, at}, 1), [&](const VoxelKey& cube) { around.insert(cube); });
  for (const VoxelKey& at : around)
    if (const auto cube = cubes_.find(at); cube != cubes_.end())
      for (const std::uint32_t piece : cube->second.pieces) {
        if (!is_small(piece)) continue;
        pieces_[piece].joins = piece_for(piece);
        changes.groups.push_back(pieces_[piece].group);
      }
}

// The pieces of some groups, and of those that they have to do with now, by their first keys.
std::vector<std::uint32_t> FrontierClusters::take_groups(std::vector<std::uint32_t> names) {
  std::vector<std::uint32_t> pieces;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto group = groups_.extract(names[i]);
    if (group.empty()) continue;  // taken already
    for (const std::uint32_t piece : group.mapped()) {
      pieces.push_back(piece);
      if (is_small(piece)) names.push_back(pieces_[pieces_[piece].joins].group);
    }
  }
  std::ranges::sort(pieces, {}, [this](std::uint32_t piece) { return pieces_[piece].keys.front(); });
  return pieces;
}

// Finds the groups of pieces that are in none.
void FrontierClusters::group(std::span<const std::uint32_t> pieces) {
  for (const std::uint32_t piece : pieces) {
    pieces_[piece].group = next_group_++;
    groups_[pieces_[piece].group] = {piece};
  }
  for (const std::uint32_t piece : pieces) {
    if (!is_small(piece)) continue;
    std::uint32_t more = pieces_[piece].group, less = pieces_[pieces_[piece].joins].group;
    if (more == less) continue;
    if (groups_.at(more).size() < groups_.at(less).size()) std::swap(more, less);
    const Group moved = std::move(groups_.extract(less).mapped());
    for (const std::uint32_t other : moved) pieces_[other].group = more;
    Group& all = groups_.at(more);
    all.insert(all.end(), moved.begin(), moved.end());
  }
}

// The pieces of groups; those that are too small together with the largest ones that they touch, up to a
// width, and beyond it once where they would be left out. What is too small all the same is left out.
// @param order  by their first keys
std::vector<FrontierClusters::Part> FrontierClusters::joined_pieces(
    std::span<const std::uint32_t> order) const {
  std::vector<std::uint32_t> joined_to(pieces_.size());  // itself: the first piece of a cluster
  const auto first_of = [&](std::uint32_t piece) {
    while (joined_to[piece] != piece) piece = joined_to[piece];
    return piece;
  };
  std::vector<std::size_t> sizes(pieces_.size());  // of the clusters, by their first pieces
  std::vector<KeyBox> boxes(pieces_.size());       // around them
  for (const std::uint32_t piece : order) {
    joined_to[piece] = piece;
    sizes[piece] = pieces_[piece].keys.size();
    boxes[piece] = pieces_[piece].box;
  }
  const auto is_wide = [&](const KeyBox& box) {
    const int most = kWidest * edge_ - 1;
    return box.max.x - box.min.x > most || box.max.y - box.min.y > most || box.max.z - box.min.z > most;
  };
  for (const std::uint32_t piece : order) {
    if (!is_small(piece)) continue;
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
    if (!all[piece].empty() && sizes[piece] >= least_)
      joined.push_back({std::move(all[piece]), sizes[piece]});
  return joined;
}

std::vector<std::uint64_t> FrontierClusters::revisions_of(const Part& part) const {
  std::vector<std::uint64_t> revisions;
  for (const std::uint32_t piece : part.pieces) revisions.push_back(pieces_[piece].revision);
  return revisions;
}

// Larger clusters get their names first, of those of one size the one with the first frontier.
bool FrontierClusters::is_before(const Part& a, const Part& b) const {
  if (a.size != b.size) return a.size > b.size;
  return pieces_[a.pieces.front()].keys.front() < pieces_[b.pieces.front()].keys.front();
}

// Who gets which id, in the order of `is_before`. Clusters that have nothing to do with a change keep theirs,
// unless a larger one takes it: then it is their turn, too.
class FrontierClusters::Naming {
 public:
  // @param parts    that are to have names
  // @param changed  ids of the clusters that do not keep theirs just so
  Naming(FrontierClusters& clusters, std::vector<Part> parts, std::vector<std::uint32_t> changed)
      : clusters_(clusters), changed_(changed.begin(), changed.end()) {
    for (Part& part : parts) waiting_.insert(std::move(part));
  }

  [[nodiscard]] bool is_done() const { return waiting_.empty(); }
  [[nodiscard]] Part next() { return std::move(waiting_.extract(waiting_.begin()).value()); }

  // Whether a cluster before a part has the id.
  [[nodiscard]] bool is_taken(std::uint32_t id, const Part& part) const {
    if (taken_.contains(id)) return true;
    const auto now = clusters_.made_of_.find(id);
    return now != clusters_.made_of_.end() && !changed_.contains(id) &&
           clusters_.is_before(now->second.part, part);
  }
  void take(std::uint32_t id) {
    taken_.insert(id);
    const auto now = clusters_.made_of_.find(id);
    if (now != clusters_.made_of_.end() && changed_.insert(id).second) waiting_.insert(now->second.part);
  }
  void make(FrontierCluster cluster, Made of, bool is_new) {
    take(cluster.id);
    made_.push_back({std::move(cluster), std::move(of), is_new});
  }

  [[nodiscard]] const std::unordered_set<std::uint32_t>& changed() const { return changed_; }
  struct MadeCluster {
    FrontierCluster cluster;
    Made of;
    bool is_new;  // not one of the same pieces as before
  };
  [[nodiscard]] std::vector<MadeCluster>& made() { return made_; }

 private:
  struct Before {
    const FrontierClusters* clusters;
    bool operator()(const Part& a, const Part& b) const { return clusters->is_before(a, b); }
  };
  FrontierClusters& clusters_;
  std::set<Part, Before> waiting_{Before{&clusters_}};
  std::unordered_set<std::uint32_t> changed_, taken_;
  std::vector<MadeCluster> made_;
};

// Of pieces that were not together before, or were others. Its id is that of the cluster in which most of the
// frontiers were before, unless a larger one has it.
FrontierCluster FrontierClusters::make_cluster(const Part& part, Naming& naming) {
  FrontierCluster cluster;
  cluster.box = pieces_[part.pieces.front()].box;
  for (const std::uint32_t piece : part.pieces) {
    const Keys& keys = pieces_[piece].keys;
    cluster.keys.insert(cluster.keys.end(), keys.begin(), keys.end());
    cluster.box = hull(cluster.box, pieces_[piece].box);
  }
  std::ranges::sort(cluster.keys);
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
    if (count > best.first && !naming.is_taken(id, part)) best = {count, id};
  cluster.id = best.second != 0 ? best.second : next_id_++;
  const std::uint32_t place = cluster.id < places_.size() ? places_[cluster.id] : kNoPlace;
  const bool equal = place != kNoPlace && clusters_[place].keys == cluster.keys;
  cluster.revision = equal ? clusters_[place].revision : next_revision_++;
  return cluster;
}

// Of the groups that have changed. A cluster of the same pieces as before is what it was, and keeps its id if
// no larger one has it: all of its frontiers were in it.
void FrontierClusters::make_clusters(Changes changes) {
  const std::vector<std::uint32_t> pieces = take_groups(std::move(changes.groups));
  group(pieces);
  for (const std::uint32_t piece : pieces) changes.clusters.push_back(pieces_[piece].cluster);
  Naming naming(*this, joined_pieces(pieces), std::move(changes.clusters));
  while (!naming.is_done()) {
    Part part = naming.next();
    std::vector<std::uint64_t> revisions = revisions_of(part);
    const std::uint32_t id = pieces_[part.pieces.front()].cluster;
    const auto before = made_of_.find(id);
    const bool stays =
        before != made_of_.end() && before->second.revisions == revisions && !naming.is_taken(id, part);
    FrontierCluster cluster = stays ? std::move(clusters_[places_[id]]) : make_cluster(part, naming);
    naming.make(std::move(cluster), {std::move(part), std::move(revisions)}, !stays);
  }
  for (const std::uint32_t piece : pieces) pieces_[piece].cluster = 0;
  replace_clusters(naming);
}

// The clusters that have changed by those that are made of their pieces and others.
void FrontierClusters::replace_clusters(Naming& naming) {
  std::erase_if(clusters_,
                [&](const FrontierCluster& cluster) { return naming.changed().contains(cluster.id); });
  for (const std::uint32_t id : naming.changed()) {
    made_of_.erase(id);
    if (id < places_.size()) places_[id] = kNoPlace;
  }
  const std::size_t kept = clusters_.size();
  for (auto& [cluster, of, is_new] : naming.made()) {
    for (const std::uint32_t piece : of.part.pieces) pieces_[piece].cluster = cluster.id;
    if (is_new)
      for (const VoxelKey& key : cluster.keys) cluster_[key] = cluster.id;
    made_of_[cluster.id] = std::move(of);
    clusters_.push_back(std::move(cluster));
  }
  const auto first_key = [](const FrontierCluster& cluster) { return cluster.keys.front(); };
  const auto middle = clusters_.begin() + static_cast<std::ptrdiff_t>(kept);
  std::ranges::sort(middle, clusters_.end(), {}, first_key);
  std::ranges::inplace_merge(clusters_, middle, {}, first_key);
  places_.resize(next_id_, kNoPlace);
  for (std::uint32_t i = 0; i < clusters_.size(); ++i) places_[clusters_[i].id] = i;
  // What was in a cluster that is still the same is in it now.
  std::vector<std::uint8_t> is_same(next_id_);
  for (const FrontierCluster& cluster : clusters_) is_same[cluster.id] = 1;
  for (const std::uint32_t id : naming.changed())
    if (id < is_same.size()) is_same[id] = 0;
  is_same[0] = 0;
  for (std::size_t i = 0; i < frontiers_.size(); ++i)
    if (is_same[cluster_of_frontier_[i]] == 0) cluster_of_frontier_[i] = cluster_of(frontiers_[i]);
}

const FrontierCluster& FrontierClusters::cluster(std::uint32_t id) const { return clusters_[places_.at(id)]; }

void FrontierClusters::set_least(std::size_t least) {
  least = std::max<std::size_t>(least, 1);
  if (std::exchange(least_, least) == least) return;
  Changes all;
  for (std::uint32_t piece = 1; piece < pieces_.size(); ++piece) {
    if (pieces_[piece].keys.empty()) continue;
    if (is_small(piece)) pieces_[piece].joins = piece_for(piece);
    all.groups.push_back(pieces_[piece].group);
  }
  make_clusters(std::move(all));
}

// Those that were there before are in the clusters where they were, until these change.
// @return those that were not, and those that are not any more
FrontierClusters::Keys FrontierClusters::set_frontiers(std::span<const VoxelKey> frontiers) {
  Keys changed;
  std::vector<std::uint32_t> clusters(frontiers.size());
  std::size_t before = 0;
  for (std::size_t i = 0; i < frontiers.size(); ++i) {
    while (before < frontiers_.size() && frontiers_[before] < frontiers[i])
      changed.push_back(frontiers_[before++]);
    if (before < frontiers_.size() && frontiers_[before] == frontiers[i])
      clusters[i] = cluster_of_frontier_[before++];
    else
      changed.push_back(frontiers[i]);
  }
  changed.insert(changed.end(), frontiers_.begin() + static_cast<std::ptrdiff_t>(before), frontiers_.end());
  if (changed.empty()) return changed;
  frontiers_.assign(frontiers.begin(), frontiers.end());
  cluster_of_frontier_ = std::move(clusters);
  return changed;
}

void FrontierClusters::update(std::span<const VoxelKey> frontiers) {
  const Keys changed = set_frontiers(frontiers);
  if (changed.empty()) return;
  std::map<VoxelKey, Keys> changed_in;  // each cube
  for (const VoxelKey& key : changed) changed_in[cube_of(key)].push_back(key);
  Changes changes;
  for (const auto& [at, keys] : changed_in) {
    Cube& cube = cubes_[at];
    Keys now;
    std::ranges::set_symmetric_difference(cube.frontiers, keys, std::back_inserter(now));
    cube.frontiers = std::move(now);
    cut(cube, at, changes);
    if (cube.frontiers.empty()) cubes_.erase(at);
  }
  find_neighbors_of_small_pieces(changed_in, changes);
  make_clusters(std::move(changes));
}

}  // namespace frontlux::planner::detail
