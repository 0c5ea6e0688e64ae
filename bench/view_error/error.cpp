#include "view_error/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace frontlux::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

std::size_t best_of(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
}

}  // namespace

Scores::Scores(const ViewQualityImage& image, double opening) {
  const bool binned = image.options().azimuth_bins != 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const ViewQuality& quality = image.values()[i];
    if (!binned) {
      value.push_back(quality.gain);
      continue;
    }
    const AzimuthWindow window = best_window(image.bin_hits(i), opening);
    value.push_back(static_cast<double>(window.hits) * quality.gain_per_hit());
    yaw.push_back(window.yaw);
  }
}

double true_score(const ViewQualityImage& truth, std::size_t viewpoint, double yaw, double opening) {
  const auto bins = truth.bin_hits(viewpoint);
  if (bins.empty()) return truth.values()[viewpoint].gain;
  const auto count = static_cast<long>(bins.size());
  const double width = kTurn / static_cast<double>(count);
  const auto window = std::min(count, static_cast<long>(std::floor(opening / width + 1e-9)));
  const long first = std::lround(yaw / width - static_cast<double>(window) / 2.0);
  double hits = 0;
  for (long b = first; b < first + window; ++b)
    hits += bins[static_cast<std::size_t>(((b % count) + count) % count)];
  return hits;
}

ErrorSum::ErrorSum(const ViewQualityImage& truth, const Lattice& lattice, double opening, double lambda,
                   std::size_t places)
    : truth_(truth), lattice_(lattice), opening_(opening), lambda_(lambda), true_scores_(truth, opening) {
  for (const ViewQuality& quality : truth.values()) {
    mean_gain_ += quality.gain;
    seeing_ += quality.gain > 0 ? 1 : 0;
  }
  if (seeing_ == 0) throw std::invalid_argument("ErrorSum: no viewpoint sees a target");
  mean_gain_ /= static_cast<double>(truth.size());
  const std::size_t chosen = std::min(places, truth.size());
  for (std::size_t p = 0; p < chosen; ++p) places_.push_back((2 * p + 1) * truth.size() / (2 * chosen));
}

double ErrorSum::discount(std::size_t place, std::size_t viewpoint) const {
  const auto metres = [&](std::size_t i) { return lattice_.center(truth_.viewpoints()[i]); };
  return std::exp(-lambda_ * (metres(place) - metres(viewpoint)).norm());
}

std::size_t ErrorSum::best_from(std::size_t place, const std::vector<double>& value) const {
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (const double here = value[i] > most ? value[i] * discount(place, i) : 0.0; here > most) {
      most = here;
      best = i;
    }
  return best;
}

double ErrorSum::best_recounted(std::size_t place, const std::vector<double>& value) const {
  struct Cell {
    double estimate, truth;
  };
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (value[i] > 0.0) {
      const double factor = discount(place, i);
      cells.push_back({value[i] * factor, true_scores_.value[i] * factor});
    }
  const std::size_t count = std::min(kRecounted, cells.size());
  std::partial_sort(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(count), cells.end(),
                    [](const Cell& a, const Cell& b) { return a.estimate > b.estimate; });
  double best = 0.0;
  for (std::size_t c = 0; c < count; ++c) best = std::max(best, cells[c].truth);
  return best;
}

void ErrorSum::add(const ViewQualityImage& estimate) {
  if (!std::ranges::equal(estimate.viewpoints(), truth_.viewpoints()))
    throw std::invalid_argument("ErrorSum: the estimate has other viewpoints than the truth");
  ViewError error;
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const double off = estimate.values()[i].gain - truth_.values()[i].gain;
    error.rms += off * off;
    error.predicted += estimate.values()[i].standard_error * estimate.values()[i].standard_error;
    error.absolute += std::abs(off);
    error.bias += off;
    error.missed += truth_.values()[i].gain > 0 && estimate.values()[i].gain <= 0 ? 1 : 0;
  }
  const auto count = static_cast<double>(truth_.size());
  sum_.rms += error.rms / count;
  sum_.predicted += error.predicted / count;
  sum_.absolute += error.absolute / count;
  sum_.bias += error.bias / count;
  sum_.missed += error.missed / static_cast<double>(seeing_);

  const Scores scores(estimate, opening_);
  const auto gets = [&](std::size_t i) {
    return true_score(truth_, i, scores.yaw.empty() ? 0.0 : scores.yaw[i], opening_);
  };
  sum_.best_loss += 1.0 - gets(best_of(scores.value)) / *std::ranges::max_element(true_scores_.value);
  for (const std::size_t place : places_) {
    const std::size_t chosen = best_from(place, scores.value), best = best_from(place, true_scores_.value);
    const double most = true_scores_.value[best] * discount(place, best);
    sum_.recounted_loss +=
        (1.0 - best_recounted(place, scores.value) / most) / static_cast<double>(places_.size());
    sum_.place_loss +=
        (1.0 - gets(chosen) * discount(place, chosen) / most) / static_cast<double>(places_.size());
  }
  ++count_;
}

ViewError ErrorSum::mean() const {
  const auto count = static_cast<double>(std::max<std::size_t>(count_, 1));
  return {std::sqrt(sum_.rms / count) / mean_gain_,
          std::sqrt(sum_.predicted / count) / mean_gain_,
          sum_.absolute / count / mean_gain_,
          sum_.bias / count / mean_gain_,
          sum_.missed / count,
          sum_.best_loss / count,
          sum_.place_loss / count,
          sum_.recounted_loss / count};
}

}  // namespace frontlux::bench
