#include "goal/viewpoint_candidates.hpp"

#include "goal/rendered_cell.hpp"
#include "mapping/box_array.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/view_region.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr int kEdge = 8;              // [voxels] of the cubes that are bounded together
constexpr std::size_t kCounted = 16;  // cells, each of another cube

// A cube, with how many of some voxels it holds.
struct Cube {
  VoxelKey corner;
  std::size_t count = 0;
};

VoxelKey corner_of(const VoxelKey& key) {
  return make_key(key.x & ~(kEdge - 1), key.y & ~(kEdge - 1), key.z & ~(kEdge - 1));
}

bool by_corner(const Cube& a, const Cube& b) { return a.corner < b.corner; }

// Sorted by corner.
std::vector<Cube> cubes_of(std::span<const VoxelKey> keys) {
  std::vector<Cube> runs;
  for (const VoxelKey& key : keys) {
    const VoxelKey corner = corner_of(key);
    if (runs.empty() || runs.back().corner != corner) runs.push_back({corner, 0});
    ++runs.back().count;
  }
  std::sort(runs.begin(), runs.end(), by_corner);
  std::vector<Cube> cubes;
  for (const Cube& run : runs)
    if (cubes.empty() || cubes.back().corner != run.corner)
      cubes.push_back(run);
    else
      cubes.back().count += run.count;
  return cubes;
}

// How many targets one yaw may show, by the sector of the horizon in which the window of that yaw starts.
class CubeView {
 public:
  explicit CubeView(const GoalQuery& query)
      : region_(query.view, query.lattice.resolution()),
        reach_(region_.reach() / kEdge + 1),
        opening_(query.bins() == 0 ? 2 * std::numbers::pi : query.view.horizontal) {
    for (int x = -reach_; x <= reach_; ++x)
      for (int y = -reach_; y <= reach_; ++y) sectors_.push_back(sectors_showing(x, y));
  }

  // The most targets that some cell of a cube may see at one yaw.
  [[nodiscard]] std::size_t most(const Cube& from, std::span<const Cube> targets) const {
    const KeyBox box = cube(from.corner, kEdge);
    const auto number = [](int key, int from_key) { return (key - from_key) / kEdge; };
    std::array<std::size_t, kSectors> steps{};  // from each sector to the next; they may wrap around
    std::size_t always = 0;
    auto target = std::partition_point(targets.begin(), targets.end(), [&](const Cube& t) {
      return number(t.corner.x, from.corner.x) < -reach_;
    });
    for (; target != targets.end(); ++target) {
      const int x = number(target->corner.x, from.corner.x), y = number(target->corner.y, from.corner.y);
      if (x > reach_) break;
      if (std::abs(y) > reach_ || !region_.may_contain_voxel(box, cube(target->corner, kEdge))) continue;
      const Sectors& showing =
          sectors_[static_cast<std::size_t>(x + reach_) * static_cast<std::size_t>(2 * reach_ + 1) +
                   static_cast<std::size_t>(y + reach_)];
      if (showing.count == kSectors) {
        always += target->count;
        continue;
      }
      const std::size_t end = showing.first + showing.count;
      steps[showing.first] += target->count;
      if (end > kSectors) steps[0] += target->count;
      if (end != kSectors) steps[end % kSectors] -= target->count;
    }
    std::size_t most = 0, here = 0;
    for (const std::size_t step : steps) most = std::max(most, here += step);
    return always + most;
  }

 private:
  static constexpr std::size_t kSectors = 24;
  struct Sectors {
    std::size_t first = 0, count = kSectors;
  };

  // Those from which a window may show a part of the cube at an offset, in cubes.
  [[nodiscard]] Sectors sectors_showing(int x, int y) const {
    if (x == 0 && y == 0) return {};
    constexpr double kWidth = 2 * std::numbers::pi / kSectors, kRounding = 1e-6;
    const double middle = std::atan2(y, x);
    double low = 0.0, high = 0.0;  // of what it spans around its middle, seen from anywhere in the other cube
    for (const int dx : {1 - kEdge, kEdge - 1})
      for (const int dy : {1 - kEdge, kEdge - 1}) {
        const double turn =
            std::remainder(std::atan2(kEdge * y + dy, kEdge * x + dx) - middle, 2 * std::numbers::pi);
        low = std::min(low, turn);
        high = std::max(high, turn);
      }
    const double first = std::floor((middle + low - kRounding - opening_) / kWidth),
                 last = std::floor((middle + high + kRounding) / kWidth);
    if (last - first + 1 >= kSectors) return {};
    const double turns = std::floor(first / kSectors);
    return {static_cast<std::size_t>(first - turns * kSectors), static_cast<std::size_t>(last - first + 1)};
  }

  ViewRegion region_;
  int reach_;  // [cubes]
  double opening_;
  std::vector<Sectors> sectors_;  // by offset along x and y
};

// Upper bounds of what cells are worth: as if each saw all that one yaw may show to some cell of its cube.
struct UpperBounds {
  std::vector<std::size_t> cube;  // of each cell
  std::size_t cubes = 0;
  std::vector<double> gain, quality;  // of each cell
};

UpperBounds upper_bounds(const GoalQuery& query, std::span<const VoxelKey> cells) {
  const CubeView view(query);
  const std::vector<Cube> targets = cubes_of(query.targets);
  std::vector<Cube> cubes = cubes_of(cells);
  for_each_index(cubes.size(), [&](std::size_t i) { cubes[i].count = view.most(cubes[i], targets); });
  UpperBounds bounds{std::vector<std::size_t>(cells.size()), cubes.size(), std::vector<double>(cells.size()),
                     std::vector<double>(cells.size())};
  for_each_index(cells.size(), [&](std::size_t i) {
    const auto cube = std::lower_bound(cubes.begin(), cubes.end(), Cube{corner_of(cells[i])}, by_corner);
    const double distance = query.distance(cells[i]);
    bounds.cube[i] = static_cast<std::size_t>(cube - cubes.begin());
    if (!query.far_enough(distance)) return;
    bounds.gain[i] = static_cast<double>(cube->count);
    bounds.quality[i] = query.quality(distance, bounds.gain[i]);
  });
  return bounds;
}

// The cells with the best bounds, each of another cube.
std::vector<VoxelKey> cells_to_count(const GoalQuery& query, std::span<const VoxelKey> cells,
                                     const UpperBounds& bounds) {
  std::vector<std::size_t> best(bounds.cubes, cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::size_t& there = best[bounds.cube[i]];
    if (there == cells.size() || bounds.quality[i] > bounds.quality[there]) there = i;
  }
  const auto end = best.begin() + static_cast<std::ptrdiff_t>(std::min(kCounted, best.size()));
  std::partial_sort(best.begin(), end, best.end(), [&](std::size_t a, std::size_t b) {
    const bool enough = query.enough(bounds.gain[a]);
    if (enough != query.enough(bounds.gain[b])) return enough;
    return bounds.quality[a] > bounds.quality[b] || (bounds.quality[a] == bounds.quality[b] && a < b);
  });
  std::vector<VoxelKey> chosen;
  for (auto i = best.begin(); i != end; ++i) chosen.push_back(cells[*i]);
  return chosen;
}

}  // namespace

std::vector<VoxelKey> spaced_cells(std::span<const VoxelKey> cells, int stride, const VoxelKey& robot,
                                   int surroundings) {
  if (stride <= 1 || cells.empty()) return {cells.begin(), cells.end()};
  const auto cube = [stride](const VoxelKey& key) {
    return make_key(key.x / stride, key.y / stride, key.z / stride);
  };
  const KeyBox bounds = bounds_of(cells), near = grown({robot, robot}, surroundings);
  BoxArray<std::uint8_t> taken({cube(bounds.min), cube(bounds.max)});
  std::vector<VoxelKey> chosen;
  for (const VoxelKey& key : cells)
    if (std::exchange(taken[cube(key)], 1) == 0 || near.contains(key)) chosen.push_back(key);
  return chosen;
}

PossibleGoals possible_goals(const GoalQuery& query, std::span<const VoxelKey> cells) {
  const UpperBounds bounds = upper_bounds(query, cells);
  const auto image = render_cells(query, cells_to_count(query, cells, bounds), all_targets(query));
  PossibleGoals possible;
  possible.counted = best_cell(query, image);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (bounds.gain[i] <= 0.0) continue;
    if (possible.counted) {
      RenderedCell at_best = *possible.counted;  // with its key, too: cells of the same quality stay in
      at_best.gain = bounds.gain[i];
      at_best.quality = bounds.quality[i];
      if (better(query, *possible.counted, at_best)) continue;
    }
    possible.cells.push_back(cells[i]);
  }
  return possible;
}

}  // namespace frontlux::planner::detail
