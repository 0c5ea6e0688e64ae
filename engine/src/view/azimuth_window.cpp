#include "view/azimuth_bins.hpp"

#include <frontlux/view_quality.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux {

AzimuthWindow best_window(std::span<const std::uint32_t> bin_hits, double opening,
                          std::optional<double> containing) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const std::size_t count = bin_hits.size();
  if (count == 0 || count > static_cast<std::size_t>(ViewQualityOptions::kMaxAzimuthBins))
    throw std::invalid_argument("best_window: " + std::to_string(count) +
                                " bins, but there have to be 1 to " +
                                std::to_string(ViewQualityOptions::kMaxAzimuthBins));
  if (!std::isfinite(opening) || !std::isfinite(containing.value_or(0.0)))
    throw std::invalid_argument("best_window: opening " + std::to_string(opening) + " rad, containing " +
                                std::to_string(containing.value_or(0.0)) + " rad: both have to be finite");
  const double width = kTurn / static_cast<double>(count);
  constexpr double kRounding = 1e-9;  // 90 degrees hold nine bins of 10
  const double fitting = std::floor(opening / width + kRounding);
  if (fitting < 1.0)
    throw std::invalid_argument("best_window: no bin of " + std::to_string(width) + " rad fits into " +
                                std::to_string(opening) + " rad: take more bins");
  const std::size_t window = fitting < static_cast<double>(count) ? static_cast<std::size_t>(fitting) : count;

  // Windows are numbered by their first bin; those with a bin of interest are `window` neighbours.
  std::size_t first = 0, candidates = count;
  if (containing) {
    const int bin = detail::azimuth_bin(*containing, static_cast<int>(count));
    first = (static_cast<std::size_t>(bin) + count + 1 - window) % count;
    candidates = window;
  }
  std::uint64_t hits = 0;
  for (std::size_t b = 0; b < window; ++b) hits += bin_hits[(first + b) % count];
  std::size_t best = first;
  std::uint64_t most = hits;
  for (std::size_t c = 1; c < candidates; ++c) {
    const std::size_t begin = (first + c) % count;
    hits += bin_hits[(begin + window - 1) % count];
    hits -= bin_hits[(begin + count - 1) % count];
    if (hits > most || (hits == most && begin < best)) {
      most = hits;
      best = begin;
    }
  }
  const double middle = (static_cast<double>(best) + static_cast<double>(window) / 2) * width;
  return {std::remainder(middle, kTurn), most};
}

}  // namespace frontlux
