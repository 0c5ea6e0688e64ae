#include "view/view_render.hpp"

#include "parallel/object_pool.hpp"
#include "parallel/parallel_sort.hpp"
#include "view/rank_draw.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr std::size_t kEnoughSegments = 4096;  // for a batch: 16 pieces of a caster, and still in the cache

// The targets around a tile, in order of the index, and as arrays for the test of what is in view.
struct Surroundings {
  VoxelKey corner;                        // of the tile
  std::vector<std::uint32_t> cubes;       // numbers in the index
  std::vector<std::uint32_t> cube_begin;  // of each in the arrays, and the end of the last
  std::vector<VoxelKey> keys;
  std::vector<std::int32_t> entries;  // of the view's tables, from the corner
  std::vector<std::int16_t> heights;  // above the corner

  // Those in some sectors of some voxel of the tile; perhaps some others.
  void list(const ViewScene& scene, const KeyBox& tile, SectorSet sectors) {
    const ViewRegion& view = scene.view;
    const TargetIndex& targets = scene.targets;
    corner = tile.min;
    targets.list_cubes(view, tile, cubes);
    if (sectors != SectorSet::all())
      std::erase_if(cubes, [&](std::uint32_t c) {
        return !sectors.meets(scene.azimuth_bins.sectors_of(tile, targets.cubes()[c].box));
      });
    cube_begin.assign(1, 0);
    for (const std::uint32_t c : cubes) cube_begin.push_back(cube_begin.back() + targets.cubes()[c].size());
    keys.resize(cube_begin.back());
    entries.resize(keys.size());
    heights.resize(keys.size());
    for (std::size_t c = 0; c < cubes.size(); ++c)
      std::copy_n(targets.keys().begin() + targets.cubes()[cubes[c]].begin, targets.cubes()[cubes[c]].size(),
                  keys.begin() + cube_begin[c]);
    for (std::size_t t = 0; t < keys.size(); ++t) {
      entries[t] = view.entry(keys[t].x - corner.x, keys[t].y - corner.y);
      heights[t] = static_cast<std::int16_t>(keys[t].z - corner.z);
    }
  }
};

// What a task needs for its tiles.
class TileRenderer {
 public:
  void render(const ViewScene& scene, std::span<const StaleViewpoint> tile, std::span<ViewQuality> values,
              std::span<std::uint32_t> bin_hits) {
    SectorSet sectors;
    for (const StaleViewpoint& viewpoint : tile)
      sectors |= viewpoint.in_view ? viewpoint.sectors : SectorSet::all();
    surroundings_.list(scene, cube_of_code(tile.front().code), sectors);
    for (const StaleViewpoint& viewpoint : tile) {
      draw(scene, viewpoint);
      if (segments_.size() >= kEnoughSegments) finish(scene, values, bin_hits);
    }
  }

  // Casts what has gathered.
  void finish(const ViewScene& scene, std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits) {
    visible_.resize(
        segments_.size());  // perhaps 0: viewpoints without targets have their answers written too
    // Without isolation this thread would start further tiles while it waits, each with a batch of its own.
    run_isolated([&] { scene.caster.visible(segments_, visible_, UnknownPolicy::kBlock); });
    const auto bins = static_cast<std::size_t>(scene.options.azimuth_bins);
    std::size_t begin = 0;
    for (const Drawn& drawn : drawn_) {
      ViewQuality& value = values[drawn.index];
      const std::size_t end = begin + drawn.in_view;
      std::uint32_t hits = 0;
      if (bins == 0) {
        for (std::size_t s = begin; s < end; ++s) hits += visible_[s];
      } else {
        const auto counts = bin_hits.subspan(drawn.index * bins, bins);
        drawn.sectors.clear(counts);
        for (std::size_t s = begin; s < end; ++s) counts[scene.azimuth_bins[entries_[s]]] += visible_[s];
        hits = std::reduce(counts.begin(), counts.end());
      }
      value = estimate(drawn, hits, scene.options.estimator);
      begin = end;
    }
    segments_.clear();
    entries_.clear();
    drawn_.clear();
  }

 private:
  struct Drawn {
    std::uint32_t index;
    SectorSet sectors;
    std::uint32_t population, count;
    std::uint32_t in_view;  // of those that were drawn, in these sectors
  };

  static ViewQuality estimate(const Drawn& drawn, std::uint32_t hits,
                              ViewQualityOptions::Estimator estimator) {
    ViewQuality value{drawn.population, drawn.count, hits, 0.0, 0.0};
    if (drawn.count == 0) return value;
    const bool unbiased = estimator == ViewQualityOptions::Estimator::kUnbiased;
    value.gain = unbiased ? static_cast<double>(drawn.population) * hits / drawn.count : hits;
    value.standard_error = value.standard_error_of(hits, estimator);
    return value;
  }

  void draw(const ViewScene& scene, const StaleViewpoint& viewpoint) {
    const VoxelKey from = cell_of_code(viewpoint.code);
    const VoxelRandom random(scene.options.seed, from);
    const auto samples = static_cast<std::uint32_t>(scene.options.samples);
    const std::int32_t origin =
        scene.view.entry(from.x - surroundings_.corner.x, from.y - surroundings_.corner.y);
    const int bins = scene.options.azimuth_bins;
    const auto add = [&](std::uint32_t target) {
      if (bins != 0) {
        const std::int32_t entry = surroundings_.entries[target] - origin;
        if (!viewpoint.sectors.contains(SectorSet::of(scene.azimuth_bins[entry], bins))) return;
        entries_.push_back(entry);
      }
      segments_.push_back({from, surroundings_.keys[target]});
    };
    const std::size_t begin = segments_.size();
    std::uint32_t population = 0, count = 0;
    if (scene.options.sampling == ViewQualityOptions::Sampling::kFeasible) {
      population = list_in_view(scene.view, from, origin);
      if (viewpoint.in_view) {
        for (const std::uint32_t target : std::span(in_view_).first(population)) add(target);
        population = count = *viewpoint.in_view;
      } else {
        const auto& ranks = ranks_.draw(population, samples, random);
        count = static_cast<std::uint32_t>(ranks.size());
        for (const std::uint32_t rank : ranks) add(in_view_[rank]);
      }
    } else {
      population = list_buckets(scene, from);
      const auto& ranks = ranks_.draw(population, samples, random);
      count = static_cast<std::uint32_t>(ranks.size());
      auto bucket = buckets_.begin();
      for (const std::uint32_t rank : ranks) {
        while (rank >= bucket->rank_end) ++bucket;
        const std::uint32_t target = bucket->target_end - (bucket->rank_end - rank);
        if (scene.view.contains(from, surroundings_.keys[target])) add(target);
      }
    }
    drawn_.push_back({viewpoint.index, viewpoint.sectors, population, count,
                      static_cast<std::uint32_t>(segments_.size() - begin)});
  }

  // Writes every target and advances only past those in view: no branch to mispredict.
  std::uint32_t list_in_view(const ViewRegion& view, const VoxelKey& from, std::int32_t origin) {
    const Surroundings& near = surroundings_;
    in_view_.resize(near.keys.size());
    const std::int16_t* limits = view.heights() - origin;
    const std::int32_t* entries = near.entries.data();
    const std::int16_t* heights = near.heights.data();
    const int level = from.z - near.corner.z;
    const auto size = static_cast<std::uint32_t>(near.keys.size());
    std::uint32_t* out = in_view_.data();
    for (std::uint32_t t = 0; t < size; ++t) {
      const int up = std::abs(heights[t] - level);
      *out = t;
      out += up <= limits[entries[t]] ? 1 : 0;
    }
    return static_cast<std::uint32_t>(out - in_view_.data());
  }

  // The cubes that may be in view from this voxel, and not only from its tile.
  std::uint32_t list_buckets(const ViewScene& scene, const VoxelKey& from) {
    const Surroundings& near = surroundings_;
    buckets_.clear();
    std::uint32_t population = 0;
    for (std::size_t c = 0; c < near.cubes.size(); ++c) {
      if (!scene.view.may_contain_point({from, from}, scene.targets.cubes()[near.cubes[c]].box)) continue;
      population += near.cube_begin[c + 1] - near.cube_begin[c];
      buckets_.push_back({population, near.cube_begin[c + 1]});
    }
    return population;
  }

  struct Bucket {
    std::uint32_t rank_end, target_end;
  };

  Surroundings surroundings_;
  RankDraw ranks_;
  std::vector<std::uint32_t> in_view_;
  std::vector<Bucket> buckets_;
  std::vector<KeySegment> segments_;
  std::vector<std::int32_t> entries_;  // of the view's tables, one for each segment
  std::vector<Drawn> drawn_;
  std::vector<std::uint8_t> visible_;
};

}  // namespace

std::vector<Viewpoint> sort_viewpoints(std::span<const VoxelKey> viewpoints) {
  std::vector<Viewpoint> sorted(viewpoints.size());
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    sorted[i] = {cell_code(viewpoints[i]), static_cast<std::uint32_t>(i)};
  parallel_sort(sorted, [](const Viewpoint& a, const Viewpoint& b) {
    return a.code < b.code || (a.code == b.code && a.index < b.index);
  });
  return sorted;
}

void render_views(const ViewScene& scene, std::span<const StaleViewpoint> viewpoints,
                  std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits) {
  const std::vector<std::size_t> tiles = tiles_of(viewpoints);
  ObjectPool<TileRenderer> renderers;
  for_each_range(tiles.size() - 1, [&](std::size_t begin, std::size_t end) {
    auto renderer = renderers.take([] { return std::make_unique<TileRenderer>(); });
    for (std::size_t t = begin; t < end; ++t)
      renderer->render(scene, viewpoints.subspan(tiles[t], tiles[t + 1] - tiles[t]), values, bin_hits);
    renderer->finish(scene, values, bin_hits);
    renderers.give_back(std::move(renderer));
  });
}

}  // namespace frontlux::detail
