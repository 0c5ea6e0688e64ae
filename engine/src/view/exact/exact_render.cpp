#include "view/exact/exact_render.hpp"

#include "parallel/object_pool.hpp"
#include "parallel/parallel_sort.hpp"
#include "view/exact/view_window.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr int kSectors = 16;  // if there are no azimuth bins

// A viewpoint in order of tiles: by column of tiles, then by height, then by place in the tile.
struct Placed {
  std::uint64_t order;
  std::uint32_t place;
  std::uint32_t index;
  std::uint32_t number;  // among those that are sorted
  SectorSet sectors;     // that are stale

  [[nodiscard]] std::uint64_t column() const { return order >> 16U; }
};

// Where tiles lie.
struct Tiling {
  std::array<int, 3> corner{};
  std::array<int, 2> stride{1, 1};
  static constexpr int kLevels = 32;  // of viewpoints in a column of tiles

  explicit Tiling(std::span<const StaleViewpoint> viewpoints) {
    const VoxelKey first = cell_of_code(viewpoints.front().code);
    corner = {first.x, first.y, first.z};
    std::array<int, 2> apart{};
    for (const StaleViewpoint& viewpoint : viewpoints) {
      const VoxelKey key = cell_of_code(viewpoint.code);
      apart = {std::gcd(apart[0], key.x - first.x), std::gcd(apart[1], key.y - first.y)};
      corner = {std::min<int>(corner[0], key.x), std::min<int>(corner[1], key.y),
                std::min<int>(corner[2], key.z)};
    }
    for (std::size_t a = 0; a < 2; ++a)
      while (stride[a] < ViewTile::kMaxStride && apart[a] % (2 * stride[a]) == 0) stride[a] *= 2;
  }

  [[nodiscard]] Placed place(const StaleViewpoint& viewpoint, std::uint32_t number) const {
    const VoxelKey key = cell_of_code(viewpoint.code);
    const int column = (key.x - corner[0]) / stride[0], row = (key.y - corner[1]) / stride[1];
    const int level = key.z - corner[2];
    const auto digits = [](int part) { return static_cast<std::uint64_t>(part); };
    return {digits(level / kLevels) << 48U | digits(row / ViewTile::kRows) << 32U |
                digits(column / ViewTile::kColumns) << 16U | digits(level % kLevels),
            TileBits::place(column % ViewTile::kColumns, row % ViewTile::kRows), viewpoint.index, number,
            viewpoint.sectors};
  }

  // Voxel of a tile's first place.
  [[nodiscard]] std::array<int, 3> first_place(const Placed& placed) const {
    const auto digits = [&](unsigned shift) { return static_cast<int>(placed.order >> shift & 0xFFFFU); };
    return {corner[0] + digits(16) * ViewTile::kColumns * stride[0],
            corner[1] + digits(32) * ViewTile::kRows * stride[1],
            corner[2] + digits(48) * kLevels + digits(0)};
  }
};

template <class Key>
std::vector<std::size_t> runs(std::span<const Placed> placed, const Key& key) {
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (i == 0 || key(placed[i]) != key(placed[i - 1])) begins.push_back(i);
  begins.push_back(placed.size());
  return begins;
}

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

// What a task needs for its tiles.
class TileWalker {
 public:
  TileWalker(const ExactScene& scene, const Tiling& tiling, const WalkTables& tables)
      : scene_(scene),
        tiling_(tiling),
        trie_(tables.trie),
        places_in_view_(tables.in_view),
        reached_(trie_.depth() + 1),
        groups_(trie_.groups().size()) {
    groups_.front().words.fill(~std::uint64_t{0});
  }

  // In `left`, at the `number` of each viewpoint, remain the sectors in which rays take less time.
  void render(const Column& column, std::span<const Placed> tile, std::span<ViewQuality> values,
              std::span<std::uint32_t> bin_hits, std::span<StaleViewpoint> left) {
    in_view_.clear();
    seen_.clear();
    for (const Placed& placed : tile) {
      placed.sectors.clear(bins_of(placed, bin_hits));
      left[placed.number].sectors = {};
    }
    if (column.any()) look(column, tile, bin_hits, left);
    for (const Placed& placed : tile) {
      const auto bins = bins_of(placed, bin_hits);
      const std::uint32_t in_view = in_view_.at(placed.place);
      const std::uint32_t seen =
          bins.empty() ? seen_.at(placed.place) : std::reduce(bins.begin(), bins.end());
      left[placed.number].in_view = in_view;
      values[placed.index] = {in_view, in_view, seen, static_cast<double>(seen), 0.0};
    }
  }

 private:
  [[nodiscard]] std::span<std::uint32_t> bins_of(const Placed& placed,
                                                 std::span<std::uint32_t> bin_hits) const {
    const auto bins = static_cast<std::size_t>(scene_.azimuth_bins);
    return bin_hits.subspan(placed.index * bins, bins);
  }
  void look(const Column& column, std::span<const Placed> tile, std::span<std::uint32_t> bin_hits,
            std::span<StaleViewpoint> left) {
    TileBits viewpoints{};
    for (const Placed& placed : tile) viewpoints.set(placed.place);
    const int z = tiling_.first_place(tile.front())[2], reach_z = trie_.layout().reach_z;
    for (int dz = -reach_z; dz <= reach_z; ++dz)
      scene_.walk.add_up(places_in_view_.level(dz), column.level(z + dz), viewpoints, in_view_);

    const std::byte *const targets = column.targets.level(z), *const free = column.free.level(z);
    for (const RayTrie::Sector& sector : trie_.sectors()) {
      const TileBits concerned = scene_.azimuth_bins == 0 ? viewpoints : find_stale(tile, sector.bin, left);
      if (!concerned.any()) continue;
      const TileRows rows = TileRows::with(concerned);
      if (!scene_.walk.find_groups(trie_, sector, targets, concerned, rows, groups_)) continue;
      scene_.walk.count(trie_, sector, free, targets, groups_, concerned, rows, reached_, seen_);
      if (scene_.azimuth_bins == 0) continue;
      for (const Placed* placed : stale_)
        bins_of(*placed, bin_hits)[static_cast<std::size_t>(sector.bin)] = seen_.at(placed->place);
      seen_.clear();
    }
  }

  // The viewpoints for which a sector is to be walked: none if those are so few that it is left to rays.
  TileBits find_stale(std::span<const Placed> tile, int bin, std::span<StaleViewpoint> left) {
    const SectorSet sector = SectorSet::of(bin, scene_.azimuth_bins);
    stale_.clear();
    TileBits places{};
    for (const Placed& placed : tile)
      if (placed.sectors.contains(sector)) {
        stale_.push_back(&placed);
        places.set(placed.place);
      }
    if (stale_.size() >= scene_.thresholds.tile) return places;
    for (const Placed* placed : stale_) left[placed->number].sectors |= sector;
    return {};
  }

  const ExactScene& scene_;
  const Tiling& tiling_;
  const RayTrie& trie_;
  const PlacesInView& places_in_view_;
  TileCounts in_view_, seen_;
  std::vector<TileBits> reached_, groups_;
  std::vector<const Placed*> stale_;
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
    return a.order < b.order || (a.order == b.order && a.number < b.number);
  });

  left.assign(viewpoints.begin(), viewpoints.end());
  std::vector<Placed> dense;
  const std::vector<std::size_t> tiles = runs(placed, [](const Placed& p) { return p.order; });
  for (std::size_t t = 0; t + 1 < tiles.size(); ++t)
    if (tiles[t + 1] - tiles[t] >= scene.thresholds.tile)
      for (std::size_t i = tiles[t]; i < tiles[t + 1]; ++i) dense.push_back(placed[i]);
  const auto tables = dense.empty() ? nullptr
                                    : scene.tries.get(scene.view, scene.azimuth_bins, stride_x, stride_y,
                                                      dense.size() >= scene.thresholds.trie);
  if (tables) {
    const std::vector<std::size_t> columns = runs(dense, [](const Placed& p) { return p.column(); });
    ObjectPool<TileWalker> walkers;
    for_each_range(columns.size() - 1, [&](std::size_t begin, std::size_t end) {
      Column around;
      for (std::size_t c = begin; c < end; ++c) {
        const auto column = std::span<const Placed>(dense).subspan(columns[c], columns[c + 1] - columns[c]);
        around.look(scene, tiling, *tables, column);
        // Without isolation this thread would start further columns while it waits, each with windows of its
        // own.
        run_isolated([&] {
          const std::vector<std::size_t> tiles_there = runs(column, [](const Placed& p) { return p.order; });
          for_each_index(tiles_there.size() - 1, [&](std::size_t t) {
            auto walker = walkers.take([&] { return std::make_unique<TileWalker>(scene, tiling, *tables); });
            walker->render(around, column.subspan(tiles_there[t], tiles_there[t + 1] - tiles_there[t]),
                           values, bin_hits, left);
            walkers.give_back(std::move(walker));
          });
        });
      }
    });
  }
  std::erase_if(
      left, [](const StaleViewpoint& viewpoint) { return viewpoint.in_view && !viewpoint.sectors.any(); });
  return left;
}

}  // namespace frontlux::detail
