#include "tour/cluster_viewpoints.hpp"

#include "casting/visible_segments.hpp"
#include "mapping/sort_once.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/turned_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Of the range. Farther away there are places that see a cluster as well, but what a robot sees from there
// ends where its view does: going on, it would stop and start again and again.
constexpr std::array kRadii = {0.125, 0.25, 0.375, 0.5};
constexpr int kAzimuths = 16;
constexpr std::array kHeights = {0.0, -0.15, 0.15};  // of the range, above the middle
constexpr std::size_t kSample = 48;                  // frontiers that candidates are compared by
constexpr std::size_t kSmallSample = 16;  // of many candidates, or of other clusters than their own
constexpr std::size_t kKept = 6;          // viewpoints
constexpr double kApart = 0.1;            // of the range

Eigen::Vector3d middle_of(const Lattice& lattice, std::span<const VoxelKey> keys) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VoxelKey& key : keys) sum += lattice.exact_center(key);
  return sum / static_cast<double>(keys.size());
}

std::vector<VoxelKey> some_of(const std::vector<VoxelKey>& keys, std::size_t most) {
  if (keys.size() <= most) return keys;
  std::vector<VoxelKey> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(keys[(2 * i + 1) * keys.size() / (2 * most)]);
  return some;
}

std::vector<VoxelKey> cells_around(const ViewpointQuery& query, const FrontierCluster& cluster) {
  std::vector<VoxelKey> cells;
  const auto extent = query.graph.extent();
  if (!extent) return cells;
  const Eigen::Vector3d middle = middle_of(query.grid.lattice(), cluster.keys);
  const double lowest = query.grid.lattice().center(extent->min.z),
               highest = query.grid.lattice().center(extent->max.z);
  for (const double part : kRadii)
    for (int a = 0; a < kAzimuths; ++a)
      for (const double above : kHeights) {
        const double azimuth = 2 * std::numbers::pi * a / kAzimuths, radius = part * query.view.max_range;
        const Eigen::Vector3d at(middle.x() + radius * std::cos(azimuth),
                                 middle.y() + radius * std::sin(azimuth),
                                 std::clamp(middle.z() + above * query.view.max_range, lowest, highest));
        if (const auto cell = query.grid.lattice().key(at)) cells.push_back(*cell);
      }
  sort_once(cells);
  return cells;
}

// The voxel before the face that a frontier turns to a cell; none if it turns it none.
std::optional<VoxelKey> before_face(const ViewpointQuery& query, const VoxelKey& cell,
                                    const VoxelKey& frontier) {
  constexpr double kLeastCosine = 0.2;  // of the angle between the line and a face's normal
  const std::array offset = {cell.x - frontier.x, cell.y - frontier.y, cell.z - frontier.z};
  const double least = kLeastCosine * std::hypot(offset[0], offset[1], offset[2]);
  std::optional<VoxelKey> before;
  int most = 0;
  for (std::size_t axis = 0; axis < offset.size(); ++axis) {
    const int along = offset.at(axis);
    if (std::abs(along) <= most || std::abs(along) < least) continue;
    std::array<int, 3> step{};
    step.at(axis) = along > 0 ? 1 : -1;
    const auto key = offset_key(frontier, step[0], step[1], step[2]);
    if (!key || query.grid.at(*key) != Occupancy::kFree) continue;
    before = key;
    most = std::abs(along);
  }
  return before;
}

// Ends segments before the frontiers' faces.
// @return how many are left, to frontiers that turn a face
std::size_t end_before_faces(const ViewpointQuery& query, std::span<KeySegment> segments) {
  std::size_t count = 0;
  for (const auto& [from, to] : segments)
    if (const auto end = before_face(query, from, to)) segments[count++] = {from, *end};
  return count;
}

// Some voxels, at least one, of which cell after cell asks which are in its region.
class VoxelsInRegion {
 public:
  VoxelsInRegion(const ViewRegion& region, std::span<const VoxelKey> voxels)
      : region_(region), voxels_(voxels), box_{voxels.front(), voxels.front()} {
    for (const VoxelKey& key : voxels) {
      box_ = hull(box_, {key, key});
      entries_.push_back(region.entry(key.x, key.y));
    }
  }

  // Writes segments from a cell to those of the voxels that are in its region.
  // @param segments  there is a place for each voxel
  // @return how many
  std::size_t find(const VoxelKey& cell, std::span<KeySegment> segments) const {
    std::size_t count = 0;
    const auto add = [&](std::size_t voxel, bool is_in) {  // without a branch
      segments[count] = {cell, voxels_[voxel]};
      count += is_in ? 1 : 0;
    };
    const std::int16_t* const heights = region_.heights();
    const std::int32_t own = region_.entry(cell.x, cell.y);
    if (in_table(cell))
      for (std::size_t i = 0; i < voxels_.size(); ++i)
        add(i, std::abs(voxels_[i].z - cell.z) <= heights[entries_[i] - own]);
    else
      for (std::size_t i = 0; i < voxels_.size(); ++i) add(i, region_.contains(cell, voxels_[i]));
    return count;
  }

 private:
  [[nodiscard]] bool in_table(const VoxelKey& cell) const {
    const int longest = region_.reach() + ViewRegion::kMargin;
    return cell.x - box_.min.x <= longest && box_.max.x - cell.x <= longest &&
           cell.y - box_.min.y <= longest && box_.max.y - cell.y <= longest;
  }

  const ViewRegion& region_;
  std::span<const VoxelKey> voxels_;
  KeyBox box_;  // of the voxels
  std::vector<std::int32_t> entries_;
};

// What each cell sees of some frontiers.
std::vector<ClusterViewpoint> look_from(const ViewpointQuery& query, std::span<const VoxelKey> cells,
                                        std::span<const VoxelKey> targets, Aim aim) {
  constexpr std::size_t kAtOnce = 32;  // cells, whose segments stay in the cache
  std::vector<ClusterViewpoint> viewpoints(cells.size());
  const VoxelsInRegion in_region(query.region, targets);
  for_each_chunk(cells.size(), kAtOnce, [&](std::size_t first, std::size_t last) {
    std::vector<KeySegment> segments((last - first) * targets.size());
    std::vector<std::size_t> begin{0};
    for (std::size_t c = first; c < last; ++c) {
      const auto rest = std::span(segments).subspan(begin.back());
      std::size_t count = in_region.find(cells[c], rest);
      if (aim == Aim::kFace) count = end_before_faces(query, rest.first(count));
      begin.push_back(begin.back() + count);
    }
    const std::vector<std::uint8_t> visible =
        visible_segments(query.caster, std::span(segments).first(begin.back()));
    std::vector<Eigen::Vector3d> offsets;  // to what a cell sees
    for (std::size_t c = first; c < last; ++c) {
      const Eigen::Vector3d from = query.grid.lattice().exact_center(cells[c]);
      offsets.clear();
      for (std::size_t s = begin[c - first]; s < begin[c - first + 1]; ++s)
        if (visible[s] != 0) offsets.push_back(query.grid.lattice().exact_center(segments[s].to) - from);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& offset : offsets) sum += offset;
      ClusterViewpoint& viewpoint = viewpoints[c] = {.cell = cells[c], .aim = aim};
      if (offsets.empty()) continue;
      viewpoint.yaw = yaw_along(sum);
      const TurnedView view(query.view, viewpoint.yaw);
      for (const Eigen::Vector3d& offset : offsets)
        if (view.contains(offset)) ++viewpoint.seen;
    }
  });
  return viewpoints;
}

// Of some cells, compared by a sample of so many of the cluster's frontiers.
std::vector<ClusterViewpoint> best_viewpoints(const ViewpointQuery& query, const FrontierCluster& cluster,
                                              std::span<const VoxelKey> cells, std::size_t sample, Aim aim) {
  std::vector<ClusterViewpoint> all = look_from(query, cells, some_of(cluster.keys, sample), aim);
  std::erase_if(all, [](const ClusterViewpoint& viewpoint) { return viewpoint.seen == 0; });
  sort_by_seen(all);
  std::vector<VoxelKey> kept;
  const int apart = static_cast<int>(kApart * query.view.max_range / query.grid.lattice().resolution());
  for (const ClusterViewpoint& viewpoint : all) {
    if (kept.size() == kKept ||
        static_cast<double>(viewpoint.seen) < kAsGood * static_cast<double>(all.front().seen))
      break;
    const KeyBox near = grown({viewpoint.cell, viewpoint.cell}, apart);
    if (std::ranges::none_of(kept, [&](const VoxelKey& cell) { return near.contains(cell); }))
      kept.push_back(viewpoint.cell);
  }
  std::vector<ClusterViewpoint> best = look_from(query, kept, cluster.keys, aim);
  std::erase_if(best, [&](const ClusterViewpoint& viewpoint) {
    return static_cast<double>(viewpoint.seen) < query.least_gain;
  });
  sort_by_seen(best);
  return best;
}

}  // namespace

void sort_by_seen(std::vector<ClusterViewpoint>& viewpoints) {
  std::ranges::stable_sort(viewpoints, [](const auto& a, const auto& b) { return a.seen > b.seen; });
}

NumberTable parts_seen(const ViewpointQuery& query, std::span<const ClusterViewpoint> viewpoints,
                       std::span<const FrontierCluster* const> clusters) {
  std::vector<std::vector<VoxelKey>> samples;
  for (const FrontierCluster* cluster : clusters) samples.push_back(some_of(cluster->keys, kSmallSample));
  std::vector<KeySegment> segments;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // viewpoint and cluster of each segment
  for (std::size_t v = 0; v < viewpoints.size(); ++v) {
    const VoxelKey& cell = viewpoints[v].cell;
    const Eigen::Vector3d from = query.grid.lattice().exact_center(cell);
    const TurnedView view(query.view, viewpoints[v].yaw);
    const KeyBox reach = grown({cell, cell}, query.region.reach());
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (!intersection(reach, clusters[c]->box)) continue;
      for (const VoxelKey& key : samples[c]) {
        if (!view.contains(query.grid.lattice().exact_center(key) - from)) continue;
        segments.push_back({cell, key});
        pairs.emplace_back(v, c);
      }
    }
  }
  const std::vector<std::uint8_t> visible = visible_segments(query.caster, segments);
  NumberTable parts(viewpoints.size(), clusters.size());
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const auto& [v, c] = pairs[s];
    if (visible[s] != 0) parts(v, c) += 1.0 / static_cast<double>(samples[c].size());
  }
  return parts;
}

std::vector<VoxelKey> visible_from(const ViewpointQuery& query, std::span<const VoxelKey> frontiers,
                                   const VoxelKey& cell, double yaw, Aim aim) {
  const Eigen::Vector3d from = query.grid.lattice().exact_center(cell);
  const TurnedView view(query.view, yaw);
  std::vector<KeySegment> segments;
  std::vector<VoxelKey> shown;  // by each segment
  for (const VoxelKey& key : frontiers) {
    const auto end = aim == Aim::kMiddle ? key : before_face(query, cell, key);
    if (!end || !view.contains(query.grid.lattice().exact_center(*end) - from)) continue;
    segments.push_back({cell, *end});
    shown.push_back(key);
  }
  const std::vector<std::uint8_t> visible = visible_segments(query.caster, segments);
  std::vector<VoxelKey> seen;
  for (std::size_t s = 0; s < segments.size(); ++s)
    if (visible[s] != 0) seen.push_back(shown[s]);
  return seen;
}

FoundViewpoints find_viewpoints(const ViewpointQuery& query, const FrontierCluster& cluster,
                                std::span<const ClusterViewpoint> before) {
  std::vector<VoxelKey> cells = cells_around(query, cluster);
  KeyBox box = cluster.box;
  for (const VoxelKey& cell : cells) box = hull(box, {cell, cell});
  std::erase_if(cells, [&](const VoxelKey& cell) { return !query.graph.fits(cell); });
  std::vector<ClusterViewpoint> found = best_viewpoints(query, cluster, cells, kSample, Aim::kMiddle);
  if (!found.empty()) return {std::move(found), box};
  cells.clear();
  for (const ClusterViewpoint& viewpoint : before)
    if (query.graph.fits(viewpoint.cell)) cells.push_back(viewpoint.cell);
  found = best_viewpoints(query, cluster, cells, kSample, Aim::kMiddle);
  if (found.empty() && !before.empty() && before.front().aim == Aim::kFace)
    found = best_viewpoints(query, cluster, cells, kSample, Aim::kFace);
  return {std::move(found)};
}

std::vector<ClusterViewpoint> viewpoints_anywhere(const ViewpointQuery& query, const FrontierCluster& cluster,
                                                  Aim aim,
                                                  const std::function<bool(const VoxelKey&)>& reaches) {
  std::vector<VoxelKey> cells = query.graph.spread_cells(grown(cluster.box, query.region.reach()));
  std::erase_if(cells, [&](const VoxelKey& cell) {
    return !query.region.may_contain_voxel({cell, cell}, cluster.box) || !reaches(cell);
  });
  return best_viewpoints(query, cluster, cells, kSmallSample, aim);
}

}  // namespace frontlux::planner::detail
