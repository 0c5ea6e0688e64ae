#include "view/changed_boxes.hpp"
#include "view/exact/exact_render.hpp"
#include "view/hidden_changes.hpp"
#include "view/view_render.hpp"

#include <frontlux/file.hpp>
#include <frontlux/parallel.hpp>
#include <frontlux/view_quality.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux {

// What the image before knows of a viewpoint.
struct detail::Kept {
  static constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t index = kNothing;
  SectorSet stale = SectorSet::all();  // what is not right any more; without bins all or none
  bool again = true;  // to be rendered; perhaps with no sector, if only what is in view may have changed
};

namespace {

using detail::Kept;
using detail::SectorSet;
using detail::StaleViewpoint;
using detail::Viewpoint;

void check_count(std::size_t viewpoints) {
  if (viewpoints > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("view quality: " + std::to_string(viewpoints) +
                                " viewpoints, but at most 2^32 - 1 can be numbered");
}

std::shared_ptr<const std::vector<Viewpoint>> sorted(std::span<const VoxelKey> viewpoints) {
  return std::make_shared<const std::vector<Viewpoint>>(detail::sort_viewpoints(viewpoints));
}

// For each of the sorted viewpoints.
std::vector<Kept> find_kept(std::span<const Viewpoint> now, std::span<const Viewpoint> before,
                            const ViewRegion& view, std::span<const KeyBox> changed,
                            const detail::AzimuthBins* bins) {
  std::vector<Kept> kept(now.size());
  const std::vector<std::size_t> tiles = detail::tiles_of(now);
  for_each_range(tiles.size() - 1, [&](std::size_t begin, std::size_t end) {
    struct Near {
      KeyBox box;
      SectorSet sectors;  // in which some voxel of the tile sees it
    };
    std::vector<Near> near;
    const auto by_code = [](const Viewpoint& v, std::uint64_t code) { return v.code < code; };
    for (std::size_t t = begin; t < end; ++t) {
      const KeyBox tile = detail::cube_of_code(now[tiles[t]].code);
      near.clear();
      for (const KeyBox& box : changed)
        if (view.may_contain_point(tile, box))
          near.push_back({box, bins != nullptr ? bins->sectors_of(tile, box) : SectorSet::all()});
      auto old = std::lower_bound(before.begin(), before.end(), detail::cell_code(tile.min), by_code);
      for (std::size_t i = tiles[t]; i < tiles[t + 1]; ++i) {
        while (old != before.end() && old->code < now[i].code) ++old;
        if (old == before.end() || old->code != now[i].code) continue;
        const VoxelKey here = detail::cell_of_code(now[i].code);
        SectorSet stale;
        for (const auto& [box, sectors] : near) {
          if (stale.contains(sectors)) continue;
          const SectorSet there = bins != nullptr ? bins->sectors_of(here, box) : SectorSet::all();
          if (!stale.contains(there) && view.may_contain_point({here, here}, box)) stale |= there;
        }
        kept[i] = {old->index, stale, stale.any()};
      }
    }
  });
  return kept;
}

// What the options amount to.
ViewQualityOptions effective(ViewQualityOptions options) {
  if (options.renderer != ViewQualityOptions::Renderer::kExact) return options;
  options.samples = ViewQualityOptions::kAll;
  options.sampling = ViewQualityOptions::Sampling::kFeasible;
  options.estimator = ViewQualityOptions::Estimator::kUnbiased;
  return options;
}

}  // namespace

void ViewQualityOptions::check() const {
  const auto refuse = [](const std::string& name, auto value, const std::string& reason) {
    throw std::invalid_argument("view quality: " + name + " is " + std::to_string(static_cast<int>(value)) +
                                ", " + reason);
  };
  if (renderer > Renderer::kExact) refuse("renderer", renderer, "which is none of the values of Renderer");
  if (azimuth_bins < 0 || azimuth_bins > kMaxAzimuthBins)
    refuse("azimuth_bins", azimuth_bins, "but has to lie between 0 and " + std::to_string(kMaxAzimuthBins));
  if (renderer == Renderer::kExact) return;  // it ignores the rest
  if (samples < 1) refuse("samples", samples, "but has to be at least 1");
  if (sampling > Sampling::kBuckets) refuse("sampling", sampling, "which is none of the values of Sampling");
  if (estimator > Estimator::kPaper)
    refuse("estimator", estimator, "which is none of the values of Estimator");
  if (estimator == Estimator::kPaper && sampling != Sampling::kFeasible)
    throw std::invalid_argument(
        "view quality: the paper's estimator counts hits among feasible targets; take Sampling::kFeasible");
}

double ViewQuality::standard_error_of(std::uint64_t some_hits,
                                      ViewQualityOptions::Estimator estimator) const {
  if (drawn == population) return 0.0;
  const double all = population, count = drawn;
  const double q = (static_cast<double>(some_hits) + 1.0) / (count + 2.0);
  const double error = std::sqrt((1.0 - count / all) * q * (1.0 - q) / std::max(count - 1.0, 1.0));
  return error * (estimator == ViewQualityOptions::Estimator::kUnbiased ? all : count);
}

ViewQualityImage::ViewQualityImage(const Lattice& lattice, const FieldOfView& field_of_view,
                                   const ViewQualityOptions& options)
    : resolution_(lattice.resolution()), options_(options) {
  options_.check();
  region_ = std::make_shared<const ViewRegion>(field_of_view, lattice.resolution());
  azimuth_bins_ = std::make_shared<const detail::AzimuthBins>(*region_, options.azimuth_bins);
  tries_ = std::make_shared<detail::RayTries>();
  targets_ = std::make_shared<const detail::TargetIndex>(std::span<const VoxelKey>());
  order_ = sorted({});
}

void ViewQualityImage::render(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
                              std::span<const VoxelKey> targets) {
  check_count(viewpoints.size());
  auto order = sorted(viewpoints);
  const std::vector<Kept> kept(order->size());
  remake(caster, viewpoints, std::move(order), std::make_shared<const detail::TargetIndex>(targets), kept);
}

std::size_t ViewQualityImage::best() const {
  const auto of_greatest_gain =
      std::max_element(values_.begin(), values_.end(),
                       [](const ViewQuality& a, const ViewQuality& b) { return a.gain < b.gain; });
  return static_cast<std::size_t>(of_greatest_gain - values_.begin());
}

std::size_t ViewQualityImage::update(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
                                     std::span<const VoxelKey> targets, const MapChange& change) {
  check_count(viewpoints.size());
  if (change.grid.resolution() != resolution_)
    throw std::invalid_argument("view quality on voxels of " + decimals_of(resolution_) +
                                " m, but those of the map that has changed are of " +
                                decimals_of(change.grid.resolution()) + " m");
  auto index = std::make_shared<const detail::TargetIndex>(targets);
  const ViewQualityOptions options = effective(options_);
  const bool buckets = options.sampling == ViewQualityOptions::Sampling::kBuckets;
  const auto boxes = detail::changed_boxes(change.keys, *targets_, *index, buckets);
  const bool same = std::equal(viewpoints.begin(), viewpoints.end(), viewpoints_.begin(), viewpoints_.end());
  auto order = same ? order_ : sorted(viewpoints);
  // What is drawn anew is drawn in all directions.
  const bool by_sector = options.samples == ViewQualityOptions::kAll && !buckets && options.azimuth_bins > 0;
  auto kept = find_kept(*order, *order_, *region_, boxes, by_sector ? azimuth_bins_.get() : nullptr);
  // Rays of a caster without a grid may leave the line.
  if (const auto grid = by_sector ? caster.grid() : std::nullopt) {
    std::vector<detail::Onlooker> onlookers;
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (kept[i].again && kept[i].index != Kept::kNothing)
        onlookers.push_back({(*order)[i].code, kept[i].stale});
    detail::leave_out_hidden(*grid, change.keys, *targets_, *index, *region_, options.azimuth_bins,
                             onlookers);
    auto onlooker = onlookers.begin();
    for (Kept& one : kept)
      if (one.again && one.index != Kept::kNothing) one.stale = (onlooker++)->sectors;
  }
  return remake(caster, viewpoints, std::move(order), std::move(index), kept);
}

// All is made aside, so that a caster that throws leaves the image as it was.
std::size_t ViewQualityImage::remake(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
                                     std::shared_ptr<const std::vector<Viewpoint>> order,
                                     std::shared_ptr<const detail::TargetIndex> targets,
                                     std::span<const Kept> kept) {
  if (caster.lattice().resolution() != resolution_)
    throw std::invalid_argument("view quality on voxels of " + decimals_of(resolution_) +
                                " m, but the caster's are of " + decimals_of(caster.lattice().resolution()) +
                                " m");
  const std::size_t bins = this->bins();
  const bool same = order == order_;
  std::vector<VoxelKey> keys(viewpoints.begin(), viewpoints.end());
  std::vector<ViewQuality> values = same ? values_ : std::vector<ViewQuality>(keys.size());
  std::vector<std::uint32_t> bin_hits = same ? bin_hits_ : std::vector<std::uint32_t>(keys.size() * bins);
  std::vector<StaleViewpoint> stale;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Viewpoint& viewpoint = (*order)[i];
    if (kept[i].again) stale.push_back({viewpoint.code, viewpoint.index, kept[i].stale});
    if (same || kept[i].index == Kept::kNothing) continue;
    values[viewpoint.index] = values_[kept[i].index];
    std::copy_n(bin_hits_.begin() + static_cast<std::ptrdiff_t>(kept[i].index * bins), bins,
                bin_hits.begin() + static_cast<std::ptrdiff_t>(viewpoint.index * bins));
  }
  const std::size_t rendered = stale.size();
  const ViewQualityOptions options = effective(options_);
  const bool exact = options.renderer == ViewQualityOptions::Renderer::kExact;
  if (const auto grid = exact ? caster.grid() : std::nullopt) {
    const auto& walk = detail::trie_walks().front();
    stale = detail::render_exactly({*grid, *region_, *targets, walk, *tries_, options.azimuth_bins}, stale,
                                   values, bin_hits);
  }
  detail::render_views({caster, *region_, *azimuth_bins_, *targets, options}, stale, values, bin_hits);

  viewpoints_ = std::move(keys);
  order_ = std::move(order);
  targets_ = std::move(targets);
  values_ = std::move(values);
  bin_hits_ = std::move(bin_hits);
  return rendered;
}

ViewQualityImage render_view_quality(const RayCaster& caster, const Lattice& lattice,
                                     std::span<const VoxelKey> viewpoints, std::span<const VoxelKey> targets,
                                     const FieldOfView& field_of_view, const ViewQualityOptions& options) {
  ViewQualityImage image(lattice, field_of_view, options);
  image.render(caster, viewpoints, targets);
  return image;
}

}  // namespace frontlux
