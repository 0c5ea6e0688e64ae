#include "draw/colors.hpp"
#include "draw/counts_seconds.hpp"
#include "draw/stills.hpp"
#include "text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::app {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{20, 20, 24}, kGrid{217, 223, 231}, kMuted{86, 97, 112};
constexpr int kWidth = 1000, kHeight = 560, kLeft = 96, kRight = 30, kTop = 96, kBottom = 70;

struct Curve {
  std::string name;
  Color color;
  double thickness;
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
  std::vector<Curve> curves = {{"team", kInk, 3.5, {}}};
  const std::vector<Color> colors = robot_colors(head.robots);
  for (std::size_t r = 0; r < head.robots.size(); ++r)
    curves.push_back({head.robots[r].robot.name, colors[r], 2.5, {}});
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

// 1, 2 or 5 times a power of ten, so that there are at most ten.
std::uint64_t tick_of(std::uint64_t most) {
  for (std::uint64_t power = 1;; power *= 10)
    for (const std::uint64_t factor : {1U, 2U, 5U})
      if (most <= 10 * power * factor) return power * factor;
}

}  // namespace

Canvas draw_coverage(const planner::Recording& recording, const std::string& name) {
  std::string of;
  const std::vector<Curve> curves = curves_of(recording, of);
  const Axis axis = axis_of(recording);
  const double end = std::max(1.0, axis.places.back());
  const auto pixel_x = [&](double place) { return kLeft + (kWidth - kLeft - kRight) * place / end; };
  const auto pixel_y = [](double fraction) {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * fraction;
  };

  Canvas canvas(kWidth, kHeight, kPaper);
  canvas.text(24, 24,
              (name == recording.head.world ? name : name + ": " + recording.head.world) + ", mapped " + of,
              kInk);
  int x = 24;
  for (const Curve& curve : curves) {
    canvas.fill(x, 58, 24, 5, curve.color);
    const std::string text = curve.name + " " + percent(curve.fractions.back(), 1);
    canvas.text(x + 32, 54, text, kInk);
    x += 32 + Canvas::text_width(text) + 28;
  }
  for (int tick = 0; tick <= 4; ++tick) {
    const int y = static_cast<int>(std::lround(pixel_y(tick / 4.0)));
    canvas.fill(kLeft, y, kWidth - kLeft - kRight, 1, kGrid);
    const std::string text = percent(tick / 4.0, 0);
    canvas.text(kLeft - 10 - Canvas::text_width(text), y - Canvas::kTextHeight / 2, text, kMuted);
  }
  const auto most = static_cast<std::uint64_t>(axis.places.back()), each = tick_of(most);
  for (std::uint64_t tick = 0; tick <= most; tick += each) {
    const auto place = static_cast<double>(tick);
    const int at = static_cast<int>(std::lround(pixel_x(place)));
    canvas.fill(at, kTop, 1, kHeight - kTop - kBottom, kGrid);
    const std::string text = fixed(axis.first + place, 0);
    canvas.text(at - Canvas::text_width(text) / 2, kHeight - kBottom + 10, text, kMuted);
  }
  canvas.text(kWidth - kRight - Canvas::text_width(axis.unit), kHeight - 30, axis.unit, kMuted);
  std::for_each(curves.rbegin(), curves.rend(), [&](const Curve& curve) {
    for (std::size_t from = 0, to = 1; to < curve.fractions.size(); from = to++) {
      const auto x0 = pixel_x(axis.places[from]), y0 = pixel_y(curve.fractions[from]);
      const auto x1 = pixel_x(axis.places[to]), y1 = pixel_y(curve.fractions[to]);
      if (x0 != x1 || y0 != y1) canvas.line(x0, y0, x1, y1, curve.thickness, curve.color);
    }
  });
  return canvas;
}

}  // namespace frontlux::app
