#include "goal/rendered_cell.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <cstddef>

namespace frontlux::planner::detail {
namespace {

// A cell that may become the goal.
struct Candidate {
  RenderedCell rated;
  double most = 0.0;       // quality, if all that was not drawn were visible
  bool undecided = false;  // some targets were not drawn, so that the image's gain is an estimate
};

// By the estimate; where it is zero, by what may be hidden in it.
bool better_candidate(const GoalQuery& query, const Candidate& a, const Candidate& b) {
  const bool enough = query.enough(a.rated.gain);
  if (enough != query.enough(b.rated.gain)) return enough;
  if (a.rated.quality != b.rated.quality) return a.rated.quality > b.rated.quality;
  if (a.most != b.most) return a.most > b.most;
  return a.rated.cell < b.rated.cell;
}

std::vector<Candidate> list_candidates(const GoalQuery& query, const ViewQualityImage& image,
                                       const VoxelKey* containing) {
  std::vector<Candidate> candidates(image.size());
  for_each_index(image.size(), [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    candidate.rated = rate(query, image, i, containing);
    const ViewQuality& value = image.values()[i];
    candidate.undecided = value.drawn < value.population;
    candidate.most = query.quality(candidate.rated.distance, value.population);
  });
  std::erase_if(candidates, [&](const Candidate& candidate) {
    const bool sees_none = candidate.rated.gain <= 0.0 && !candidate.undecided;
    return sees_none || !query.far_enough(candidate.rated.distance);
  });
  return candidates;
}

// A window of azimuths holds all that some yaw shows; at the edges of one yaw's view less height is in view.
// Nothing is gained where that shows no target that has to be in view.
RenderedCell in_true_view(const GoalQuery& query, RenderedCell rated, const VoxelKey* containing) {
  std::vector<std::uint8_t> visible = query.visible_targets(rated.cell, rated.yaw);
  if (containing != nullptr) {
    const auto place = std::ranges::find(query.targets, *containing) - query.targets.begin();
    if (visible.at(static_cast<std::size_t>(place)) == 0) visible.clear();
  }
  rated.hits = static_cast<std::uint32_t>(std::count(visible.begin(), visible.end(), std::uint8_t{1}));
  rated.gain = rated.hits;
  rated.quality = query.quality(rated.distance, rated.gain);
  return rated;
}

// The best by what it truly sees at its yaw. Candidates that were worse before cannot be better by that.
std::optional<RenderedCell> best_of(const GoalQuery& query, std::span<const Candidate> candidates,
                                    const VoxelKey* containing) {
  std::vector<RenderedCell> cells;
  for (const auto& [rated, most, undecided] : candidates)
    if (rated.gain > 0.0) cells.push_back(rated);
  const auto is_better = [&](const RenderedCell& a, const RenderedCell& b) { return better(query, a, b); };
  if (query.bins() == 0) {
    const auto best = std::min_element(cells.begin(), cells.end(), is_better);
    return best == cells.end() ? std::nullopt : std::optional(*best);
  }
  std::make_heap(cells.begin(), cells.end(), [&](const auto& a, const auto& b) { return is_better(b, a); });
  std::optional<RenderedCell> best;
  for (auto end = cells.end(); end != cells.begin(); --end) {
    if (best && !is_better(cells.front(), *best)) break;
    const RenderedCell counted = in_true_view(query, cells.front(), containing);
    if (counted.gain > 0.0 && (!best || is_better(counted, *best))) best = counted;
    std::pop_heap(cells.begin(), end, [&](const auto& a, const auto& b) { return is_better(b, a); });
  }
  return best;
}

}  // namespace

bool better(const GoalQuery& query, const RenderedCell& a, const RenderedCell& b) {
  const bool enough = query.enough(a.gain);
  if (enough != query.enough(b.gain)) return enough;
  if (a.quality != b.quality) return a.quality > b.quality;
  return a.cell < b.cell;
}

RenderedCell rate(const GoalQuery& query, const ViewQualityImage& image, std::size_t index,
                  const VoxelKey* containing) {
  const ViewQuality& value = image.values()[index];
  RenderedCell rated;
  rated.cell = image.viewpoints()[index];
  rated.distance = query.distance(rated.cell);
  std::uint64_t hits = value.hits;
  if (query.bins() != 0 && (value.hits != 0 || containing != nullptr)) {
    std::optional<double> azimuth;
    if (containing != nullptr) azimuth = yaw_along(query.offset(rated.cell, *containing));
    const AzimuthWindow window = best_window(image.bin_hits(index), query.view.horizontal, azimuth);
    hits = window.hits;
    rated.yaw = window.yaw;
  }
  rated.hits = static_cast<std::uint32_t>(hits);
  rated.gain = static_cast<double>(hits) * value.gain_per_hit();
  rated.standard_error = value.standard_error_of(hits, image.options().estimator);
  rated.quality = query.quality(rated.distance, rated.gain);
  return rated;
}

ViewQualityOptions all_targets(const GoalQuery& query) {
  ViewQualityOptions rendering = query.options.rendering;
  rendering.samples = ViewQualityOptions::kAll;
  rendering.sampling = ViewQualityOptions::Sampling::kFeasible;
  rendering.azimuth_bins = query.bins();
  return rendering;
}

ViewQualityImage render_cells(const GoalQuery& query, std::span<const VoxelKey> cells,
                              const ViewQualityOptions& rendering) {
  return render_view_quality(query.caster, query.lattice, cells, query.targets, query.view, rendering);
}

std::optional<RenderedCell> best_cell(const GoalQuery& query, const ViewQualityImage& image,
                                      const VoxelKey* containing) {
  std::vector<Candidate> candidates = list_candidates(query, image, containing);
  const bool exact = std::none_of(candidates.begin(), candidates.end(),
                                  [](const Candidate& candidate) { return candidate.undecided; });
  if (exact || query.options.refined == 0) return best_of(query, candidates, containing);
  std::optional<RenderedCell> best;
  std::vector<VoxelKey> cells;
  auto begin = candidates.begin();
  for (auto count = static_cast<std::size_t>(query.options.refined); begin != candidates.end(); count *= 4) {
    const auto remaining = static_cast<std::size_t>(candidates.end() - begin);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(count, remaining));
    std::partial_sort(begin, end, candidates.end(), [&query](const Candidate& a, const Candidate& b) {
      return better_candidate(query, a, b);
    });
    if (best && (query.enough(best->gain) || !query.enough(begin->rated.gain))) break;
    cells.clear();
    for (auto candidate = begin; candidate != end; ++candidate) cells.push_back(candidate->rated.cell);
    const auto image_of_all = render_cells(query, cells, all_targets(query));
    const auto found = best_of(query, list_candidates(query, image_of_all, containing), containing);
    if (found && (!best || better(query, *found, *best))) best = found;
    begin = end;
  }
  return best;
}

}  // namespace frontlux::planner::detail
