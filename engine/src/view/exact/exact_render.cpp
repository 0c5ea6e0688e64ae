#include "view/exact/exact_render.hpp"

#include "parallel/object_pool.hpp"
#include "parallel/parallel_sort.hpp"
#include "view/exact/sector_walker.hpp"
#include "view/exact/tiling.hpp"
#include "view/exact/view_window.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <tuple>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr int kSectors = 16;  // if there are no azimuth bins

// What lies around a column of tiles.
class Column {
 public:
  ViewWindow free, targets;  // `free` is not filled if there is no target

  void look(const ExactScene& scene, const Tiling& tiling, const WalkTables& tables,
            std::span<const Placed> column) {
    const WindowLayout& layout = tables.trie.layout();
    const std::array<int, 3> first = tiling.first_place(column.front());
    const int top = tiling.first_place(column.back())[2];
    targets.aim(layout, first, top);
    targets.fill_targets(scene.targets, scene.view, scene.walk, list_);
    sort_by_level(tables.in_view, layout.reach_z, first, top);
    if (!any()) return;
    free.aim(layout, first, top);
    free.fill_free(scene.grid, scene.walk);
  }

  [[nodiscard]] bool any() const { return !list_.empty(); }

  // Targets at a height in reach of a tile, for `PlacesInView`.
  [[nodiscard]] std::span<const std::int32_t> level(int z) const {
    const auto level = static_cast<std::size_t>(z - lowest_);
    return std::span(places_).subspan(level_begin_[level], level_begin_[level + 1] - level_begin_[level]);
  }

 private:
  void sort_by_level(const PlacesInView& in_view, int reach_z, const std::array<int, 3>& first, int top) {
    lowest_ = first[2] - reach_z;
    const auto level_of = [&](const VoxelKey& key) { return static_cast<std::size_t>(key.z - lowest_); };
    level_begin_.assign(static_cast<std::size_t>(top + reach_z - lowest_ + 2), 0);
    for (const VoxelKey& key : list_) ++level_begin_[level_of(key) + 1];
    std::partial_sum(level_begin_.begin(), level_begin_.end(), level_begin_.begin());
    next_ = level_begin_;
    places_.resize(list_.size());
    for (const VoxelKey& key : list_)
      places_[next_[level_of(key)]++] = in_view.offset(key.x - first[0], key.y - first[1]);
  }

  std::vector<VoxelKey> list_;
  int lowest_ = 0;
  std::vector<std::size_t> level_begin_, next_;  // in `places_`, by level from the lowest one on
  std::vector<std::int32_t> places_;
};

// What a task needs for columns of tiles.
class ColumnRenderer {
 public:
  ColumnRenderer(const ExactScene& scene, const Tiling& tiling, const WalkTables& tables,
                 ObjectPool<SectorWalker>& walkers)
      : scene_(scene), tiling_(tiling), tables_(tables), walkers_(walkers) {}

  // In `left`, at the `number` of each viewpoint, remain the sectors in which rays take less time.
  void render(std::span<const Placed> viewpoints, std::span<ViewQuality> values,
              std::span<std::uint32_t> bin_hits, std::span<StaleViewpoint> left) {
    around_.look(scene_, tiling_, tables_, viewpoints);
    column_.viewpoints = viewpoints;
    column_.tiles = runs(viewpoints, [](const Placed& p) { return p.order; });
    column_.by_index = scene_.azimuth_bins != 0;
    column_.sectors = column_.by_index ? scene_.azimuth_bins : kSectors;
    if (!column_.by_index) seen_.assign(viewpoints.size() * kSectors, 0);
    column_.seen = column_.by_index ? bin_hits : std::span(seen_);
    for_each_index(column_.size(), [&](std::size_t t) {
      TileCounts in_view;
      if (around_.any()) count_in_view(column_.tile(t), in_view);
      for (const Placed& placed : column_.tile(t)) {
        placed.sectors.clear(column_.seen_from(placed));
        left[placed.number].sectors = {};
        left[placed.number].in_view = in_view.at(placed.place);
      }
    });
    if (around_.any()) count_seen(left);
    for_each_index(column_.size(), [&](std::size_t t) {
      for (const Placed& placed : column_.tile(t)) {
        const auto by_sector = column_.seen_from(placed);
        const std::uint32_t seen = std::reduce(by_sector.begin(), by_sector.end());
        const std::uint32_t in_view = *left[placed.number].in_view;
        values[placed.index] = {in_view, in_view, seen, static_cast<double>(seen), 0.0};
      }
    });
  }

 private:
  void count_in_view(std::span<const Placed> tile, TileCounts& in_view) const {
    TileBits viewpoints{};
    for (const Placed& placed : tile) viewpoints.set(placed.place);
    const int z = tiling_.first_place(tile.front())[2], reach_z = tables_.trie.layout().reach_z;
    for (int dz = -reach_z; dz <= reach_z; ++dz)
      scene_.walk.add_up(tables_.in_view.level(dz), around_.level(z + dz), viewpoints, in_view);
  }

  void count_seen(std::span<StaleViewpoint> left) {
    const int lowest = tiling_.first_place(column_.viewpoints.front())[2];
    column_.free = around_.free.level(lowest);
    column_.targets = around_.targets.level(lowest);
    WalkThresholds thresholds = scene_.thresholds;
    if (scene_.azimuth_bins == 0) thresholds.walk = thresholds.part = 1;  // rays would count all sectors
    const auto sectors = tables_.trie.sectors();
    left_.resize(sectors.size());
    for_each_index(sectors.size(), [&](std::size_t s) {
      auto walker = walkers_.take(
          [&] { return std::make_unique<SectorWalker>(scene_.walk, tables_.trie, thresholds); });
      left_[s].clear();
      walker->count(column_, sectors[s], left_[s]);
      walkers_.give_back(std::move(walker));
    });
    for (std::size_t s = 0; s < sectors.size(); ++s)
      for (const Placed* placed : left_[s])
        left[placed->number].sectors |= SectorSet::of(sectors[s].bin, column_.sectors);
  }

  const ExactScene& scene_;
  const Tiling& tiling_;
  const WalkTables& tables_;
  ObjectPool<SectorWalker>& walkers_;
  Column around_;
  ViewColumn column_;
  std::vector<std::uint32_t> seen_;               // if there are no bins
  std::vector<std::vector<const Placed*>> left_;  // to rays, by sector
};

}  // namespace

std::shared_ptr<const WalkTables> RayTries::get(const ViewRegion& view, int azimuth_bins, int stride_x,
                                                int stride_y, bool make) {
  const std::lock_guard lock(mutex_);
  for (const Known& known : known_)
    if (known.stride_x == stride_x && known.stride_y == stride_y) return known.tables;
  if (!make) return nullptr;
  std::shared_ptr<const WalkTables> tables;
  // Without isolation this thread could meet its own lock in a task it takes up while it waits.
  run_isolated([&] {
    auto trie = RayTrie::make(view, azimuth_bins == 0 ? kSectors : azimuth_bins, stride_x, stride_y);
    if (!trie) return;
    PlacesInView in_view(view, trie->layout());
    tables = std::make_shared<const WalkTables>(WalkTables{std::move(*trie), std::move(in_view)});
  });
  known_.push_back({stride_x, stride_y, std::move(tables)});
  return known_.back().tables;
}

std::vector<StaleViewpoint> render_exactly(const ExactScene& scene,
                                           std::span<const StaleViewpoint> viewpoints,
                                           std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits) {
  std::vector<StaleViewpoint> left;
  if (viewpoints.empty()) return left;
  const Tiling tiling(viewpoints);
  const auto [stride_x, stride_y] = tiling.stride;
  std::vector<Placed> placed(viewpoints.size());
  for (std::size_t i = 0; i < placed.size(); ++i)
    placed[i] = tiling.place(viewpoints[i], static_cast<std::uint32_t>(i));
  parallel_sort(placed, [](const Placed& a, const Placed& b) {
    return std::tie(a.order, a.place, a.number) < std::tie(b.order, b.place, b.number);
  });

  left.assign(viewpoints.begin(), viewpoints.end());
  std::vector<Placed> dense;
  std::vector<std::size_t> columns{0};
  const std::vector<std::size_t> all_columns = runs(placed, [](const Placed& p) { return p.column(); });
  for (std::size_t c = 0; c + 1 < all_columns.size(); ++c) {
    const auto column =
        std::span<const Placed>(placed).subspan(all_columns[c], all_columns[c + 1] - all_columns[c]);
    const std::size_t tiles = runs(column, [](const Placed& p) { return p.order; }).size() - 1;
    if (column.size() < std::max(scene.thresholds.walk, tiles * scene.thresholds.part)) continue;
    dense.insert(dense.end(), column.begin(), column.end());
    columns.push_back(dense.size());
  }
  const auto tables = dense.empty() ? nullptr
                                    : scene.tries.get(scene.view, scene.azimuth_bins, stride_x, stride_y,
                                                      dense.size() >= scene.thresholds.trie);
  if (tables) {
    ObjectPool<SectorWalker> walkers;
    for_each_range(columns.size() - 1, [&](std::size_t begin, std::size_t end) {
      ColumnRenderer renderer(scene, tiling, *tables, walkers);
      for (std::size_t c = begin; c < end; ++c)
        // Without isolation this thread would start further columns while it waits, each with windows of its
        // own.
        run_isolated([&] {
          renderer.render(std::span<const Placed>(dense).subspan(columns[c], columns[c + 1] - columns[c]),
                          values, bin_hits, left);
        });
    });
  }
  std::erase_if(
      left, [](const StaleViewpoint& viewpoint) { return viewpoint.in_view && !viewpoint.sectors.any(); });
  return left;
}

}  // namespace frontlux::detail
