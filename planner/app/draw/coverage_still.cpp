#include "draw/colors.hpp"
#include "draw/counts_seconds.hpp"
#include "draw/round_length.hpp"
#include "draw/stills.hpp"
#include "text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::app {
namespace {

constexpr Color kGrid{217, 223, 231};
constexpr int kWidth = 1000, kHeight = 560, kLeft = 96, kRight = 30, kBottom = 78, kLine = 32;
constexpr TextStyle kTitle{.size = 20.0, .color = kInk, .bold = true}, kText{.size = 18.0, .color = kInk};

struct Curve {
  std::string name;
  Color color;
  double thickness;
  std::vector<double> dashes;  // [px] strokes and gaps; they tell robots apart in grey, too
  std::vector<double> fractions;
};

std::vector<Curve> curves_of(const planner::Recording& recording, std::string& of) {
  const planner::RecordingHead& head = recording.head;
  const bool observable = head.observable > 0;
  const auto count = [&](const planner::KnownVoxels& known) {
    return static_cast<double>(observable ? known.observable : known.bounding);
  };
  of = observable ? "of the observable" : head.bounding > 0 ? "of the box" : "of what is mapped in the end";
  double total = static_cast<double>(observable ? head.observable : head.bounding);
  if (total == 0.0)
    for (const planner::KnownVoxels& known : recording.steps.back().known) total += count(known);
  total = std::max(total, 1.0);
  std::vector<Curve> curves = {{"team", kInk, 3.5, {}, {}}};
  const std::vector<Color> colors = robot_colors(head.robots);
  const std::array<std::vector<double>, 4> kDashes = {{{}, {12, 6}, {3, 6}, {16, 6, 3, 6}}};
  for (std::size_t r = 0; r < head.robots.size(); ++r)
    curves.push_back({head.robots[r].robot.name, colors[r], 2.8, kDashes.at(r % kDashes.size()), {}});
  for (const planner::RecordedStep& step : recording.steps) {
    double sum = 0.0;
    for (std::size_t r = 0; r < head.robots.size(); ++r) {
      curves[r + 1].fractions.push_back(count(step.known[r]) / total);
      sum += curves[r + 1].fractions.back();
    }
    curves.front().fractions.push_back(sum);
  }
  if (head.robots.size() == 1) curves.erase(curves.begin());
  return curves;
}

// What the steps are drawn over, from 0 on.
struct Axis {
  const char* unit;
  double first;                // the number at its left end
  std::vector<double> places;  // of each step, behind the first; they never fall
};

constexpr double kMostSeconds = 1e9;  // 30 years

Axis axis_of(const planner::Recording& recording) {
  const bool seconds = counts_seconds(recording);
  const auto first = static_cast<double>(recording.steps.front().step.number);
  Axis axis{seconds ? "seconds" : "step", seconds ? 0.0 : first, {}};
  double place = 0.0;
  for (const planner::RecordedStep& recorded : recording.steps) {
    const double time = std::min(recorded.step.time, kMostSeconds);
    place = std::max(place, seconds ? time : static_cast<double>(recorded.step.number) - first);
    axis.places.push_back(place);
  }
  return axis;
}

// Each curve's name and last value, in as many lines as they need.
struct Legend {
  struct Entry {
    Spot at;
    std::string text;
  };
  std::vector<Entry> entries;
  double bottom = 0.0;
};

Legend legend_of(const std::vector<Curve>& curves, double top) {
  constexpr double kSample = 44.0, kGap = 30.0;
  Picture measure(1, 1);
  Legend legend;
  Spot at{24.0, top};
  for (const Curve& curve : curves) {
    const std::string text = curve.name + " " + percent(curve.fractions.back(), 1);
    const double width = kSample + measure.text_width(text, kText);
    if (at.x > 24.0 && at.x + width > kWidth - kRight) at = {24.0, at.y + kLine};
    legend.entries.push_back({at, text});
    at.x += width + kGap;
  }
  legend.bottom = at.y + kLine;
  return legend;
}

}  // namespace

Picture draw_coverage(const planner::Recording& recording, const std::string& name) {
  std::string of;
  const std::vector<Curve> curves = curves_of(recording, of);
  const Axis axis = axis_of(recording);
  const Legend legend = legend_of(curves, 68.0);
  const double top = legend.bottom, height = top + kHeight - 100;
  const double end = std::max(1.0, axis.places.back());
  const auto pixel_x = [&](double place) { return kLeft + (kWidth - kLeft - kRight) * place / end; };
  const auto pixel_y = [&](double fraction) {
    return height - kBottom - (height - top - kBottom) * fraction;
  };

  Picture picture(kWidth, static_cast<int>(height));
  picture.text({24, 30},
               (name == recording.head.world ? name : name + ": " + recording.head.world) + ", mapped " + of,
               kTitle);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto& [at, text] = legend.entries[i];
    const std::array<Spot, 2> sample = {at, {at.x + 34, at.y}};
    picture.line(sample, curves[i].thickness + 1.0, curves[i].color, curves[i].dashes);
    picture.text({at.x + 44, at.y}, text, kText);
  }
  for (int tick = 0; tick <= 4; ++tick) {
    const double y = std::round(pixel_y(tick / 4.0));
    picture.fill(kLeft, y, kWidth - kLeft - kRight, 1, kGrid);
    picture.text({kLeft - 10.0, y}, percent(tick / 4.0, 0), {kText.size, kMuted, Align::kRight});
  }
  const auto most = static_cast<std::uint64_t>(axis.places.back());
  const double each = std::max(1.0, round_length(static_cast<double>(most) / 4.0));
  for (double tick = 0.0; tick <= static_cast<double>(most); tick += each) {
    const double at = std::round(pixel_x(tick));
    picture.fill(at, top, 1, height - top - kBottom, kGrid);
    picture.text({at, height - kBottom + 20.0}, fixed(axis.first + tick, 0),
                 {kText.size, kMuted, Align::kMiddle});
  }
  picture.text({kWidth - kRight * 1.0, height - 24.0}, axis.unit, {kText.size, kMuted, Align::kRight});
  std::for_each(curves.rbegin(), curves.rend(), [&](const Curve& curve) {
    std::vector<Spot> spots;
    for (std::size_t i = 0; i < curve.fractions.size(); ++i) {
      const Spot spot{pixel_x(axis.places[i]), pixel_y(curve.fractions[i])};
      if (spots.empty() || spot.x != spots.back().x || spot.y != spots.back().y) spots.push_back(spot);
    }
    picture.line(spots, curve.thickness, curve.color, curve.dashes);
  });
  return picture;
}

}  // namespace frontlux::app
