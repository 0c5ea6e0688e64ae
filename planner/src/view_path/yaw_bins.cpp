#include "view_path/yaw_bins.hpp"

#include "motion/yaw.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace frontlux::planner {
namespace {

// Views, or of as many the nearness, rise in each sweep but the last; few are needed.
constexpr int kMaxSweeps = 20;

constexpr std::int64_t kNearest = 1000;                // along the tangent
constexpr std::int64_t kView = std::int64_t{1} << 32;  // more than the nearness of all viewpoints

std::size_t place_of_largest(std::span<const std::int64_t> values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

}  // namespace

YawBins::YawBins(const InformationGain& gain, int bins, std::span<const double> tangent,
                 const YawLimits& limits)
    : gain_(gain),
      limits_(limits),
      yaws_(gain.viewpoints()),
      nearness_(gain.viewpoints()),
      in_view_(gain.viewpoints()) {
  const auto even = limits.even_turn(tangent.front(), tangent.back());
  std::vector<std::uint8_t> answers;
  for (std::size_t i = 0; i < yaws_.size(); ++i) {
    if (i == 0 || i + 1 == yaws_.size()) {
      yaws_[i] = {tangent[i]};
    } else {
      for (int b = 0; b < bins; ++b) yaws_[i].push_back(detail::wrapped(2.0 * std::numbers::pi * b / bins));
      if (limits.limited()) yaws_[i].push_back(even[i]);
    }
    for (const double yaw : yaws_[i])
      nearness_[i].push_back(std::llround(0.5 * kNearest * (1.0 + std::cos(yaw - tangent[i]))));
    in_view_[i].assign(gain.frontiers_of(i).size(), 0);
    answers.resize(in_view_[i].size());
    for (std::size_t b = 0; b < yaws_[i].size(); ++b) {
      gain.in_view(i, yaws_[i][b], answers);
      for (std::size_t p = 0; p < answers.size(); ++p)
        in_view_[i][p] |= static_cast<std::uint64_t>(answers[p]) << b;
    }
  }
}

std::vector<double> YawBins::most_views() const { return yaws_of(best_sequence()); }

std::vector<double> YawBins::most_distinct() const {
  std::vector<std::uint32_t> covered(gain_.frontiers(), 0);  // by how many viewpoints
  Choice choice;
  if (limits_.limited()) {
    choice = best_sequence();
    for (std::size_t i = 0; i < choice.size(); ++i) cover(i, choice[i], 1, covered);
  } else {
    choice = greedy_choice(covered);
  }
  sweep(choice, covered);
  return yaws_of(choice);
}

// Views add up, so the best sequence under limits between neighbours is found by dynamic programming.
YawBins::Choice YawBins::best_sequence() const {
  const std::vector<std::uint32_t> none(gain_.frontiers(), 0);
  Choice choice(yaws_.size(), 0);
  if (!limits_.limited()) {
    for (std::size_t i = 0; i < choice.size(); ++i) choice[i] = place_of_largest(scores(i, none));
    return choice;
  }
  constexpr std::int64_t kImpossible = -1;
  std::vector<std::int64_t> best;  // with which each yaw of the viewpoint at hand can be reached
  std::vector<Choice> from(yaws_.size());
  for (std::size_t i = 0; i < yaws_.size(); ++i) {
    const auto here = scores(i, none);
    std::vector<std::int64_t> next(here.size(), i == 0 ? 0 : kImpossible);
    from[i].assign(here.size(), 0);
    for (std::size_t b = 0; b < here.size(); ++b) {
      for (std::size_t a = 0; a < best.size(); ++a)
        if (best[a] > next[b] && limits_.allows(i - 1, yaws_[i - 1][a], yaws_[i][b]))
          next[b] = best[a], from[i][b] = a;
      if (next[b] != kImpossible) next[b] += here[b];
    }
    best = std::move(next);
  }
  if (!best.empty())
    choice.back() = static_cast<std::size_t>(std::max_element(best.begin(), best.end()) - best.begin());
  for (std::size_t i = choice.size(); i-- > 1;) choice[i - 1] = from[i][choice[i]];
  return choice;
}

// Chooses the viewpoint and yaw that add most, again and again. The number that one can add only falls as
// others are chosen, so a viewpoint is counted anew only when its old count is the highest.
YawBins::Choice YawBins::greedy_choice(std::vector<std::uint32_t>& covered) const {
  struct Offer {
    std::int64_t score;
    std::size_t viewpoint, bin, round;
  };
  Choice choice(yaws_.size(), 0);
  std::vector<Offer> open;
  for (std::size_t i = 0; i < yaws_.size(); ++i) {
    if (yaws_[i].size() == 1) cover(i, 0, 1, covered);
  }
  const auto offer = [&](std::size_t viewpoint, std::size_t round) {
    const auto here = scores(viewpoint, covered);
    const std::size_t bin = place_of_largest(here);
    return Offer{here[bin], viewpoint, bin, round};
  };
  for (std::size_t i = 0; i < yaws_.size(); ++i)
    if (yaws_[i].size() > 1) open.push_back(offer(i, 0));
  for (std::size_t round = 0; !open.empty();) {
    const auto best = std::max_element(open.begin(), open.end(),
                                       [](const Offer& a, const Offer& b) { return a.score < b.score; });
    if (best->round != round) {
      *best = offer(best->viewpoint, round);
      continue;
    }
    choice[best->viewpoint] = best->bin;
    cover(best->viewpoint, best->bin, 1, covered);
    open.erase(best);
    ++round;
  }
  return choice;
}

void YawBins::sweep(Choice& choice, std::vector<std::uint32_t>& covered) const {
  constexpr auto kLess = static_cast<std::uint32_t>(-1);
  bool turned = true;
  for (int sweeps = 0; turned && sweeps < kMaxSweeps; ++sweeps) {
    turned = false;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      if (yaws_[i].size() == 1) continue;
      cover(i, choice[i], kLess, covered);
      const auto here = scores(i, covered);
      std::size_t best = choice[i];
      for (std::size_t b = 0; b < here.size(); ++b)
        if (here[b] > here[best] && limits_.allows(i - 1, yaws_[i - 1][choice[i - 1]], yaws_[i][b]) &&
            limits_.allows(i, yaws_[i][b], yaws_[i + 1][choice[i + 1]]))
          best = b;
      turned = turned || best != choice[i];
      choice[i] = best;
      cover(i, best, 1, covered);
    }
  }
}

// By the frontiers in view at each yaw that no viewpoint covers.
std::vector<std::int64_t> YawBins::scores(std::size_t viewpoint,
                                          std::span<const std::uint32_t> covered) const {
  std::vector<std::int64_t> scores = nearness_[viewpoint];
  const auto mine = gain_.frontiers_of(viewpoint);
  for (std::size_t p = 0; p < mine.size(); ++p) {
    if (covered[mine[p]] != 0) continue;
    for (std::uint64_t bits = in_view_[viewpoint][p]; bits != 0; bits &= bits - 1)
      scores[static_cast<std::size_t>(std::countr_zero(bits))] += kView;
  }
  return scores;
}

void YawBins::cover(std::size_t viewpoint, std::size_t bin, std::uint32_t by,
                    std::vector<std::uint32_t>& covered) const {
  const auto mine = gain_.frontiers_of(viewpoint);
  for (std::size_t p = 0; p < mine.size(); ++p)
    if ((in_view_[viewpoint][p] >> bin & 1U) != 0) covered[mine[p]] += by;
}

std::vector<double> YawBins::yaws_of(const Choice& choice) const {
  std::vector<double> yaws(choice.size());
  for (std::size_t i = 0; i < choice.size(); ++i) yaws[i] = yaws_[i][choice[i]];
  return yaws;
}

}  // namespace frontlux::planner
