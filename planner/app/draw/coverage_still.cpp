#include "draw/colors.hpp"
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
  for (std::size_t r = 0; r < head.robots.size(); ++r)
    curves.push_back({head.robots[r].robot.name, robot_color(r), 2.5, {}});
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
  const std::uint64_t first = recording.steps.front().step.number, last = recording.steps.back().step.number;
  const double steps = std::max(1.0, static_cast<double>(last - first));
  const auto pixel_x = [&](double step) { return kLeft + (kWidth - kLeft - kRight) * step / steps; };
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
  const std::uint64_t each = tick_of(last - first);
  for (std::uint64_t tick = 0; tick <= last - first; tick += each) {
    const int at = static_cast<int>(std::lround(pixel_x(static_cast<double>(tick))));
    canvas.fill(at, kTop, 1, kHeight - kTop - kBottom, kGrid);
    const std::string text = std::to_string(first + tick);
    canvas.text(at - Canvas::text_width(text) / 2, kHeight - kBottom + 10, text, kMuted);
  }
  canvas.text(kWidth - kRight - Canvas::text_width("step"), kHeight - 30, "step", kMuted);
  std::for_each(curves.rbegin(), curves.rend(), [&](const Curve& curve) {
    for (std::size_t i = 1; i < curve.fractions.size(); ++i) {
      const auto step = [&](std::size_t k) {
        return static_cast<double>(recording.steps[k].step.number - first);
      };
      canvas.line(pixel_x(step(i - 1)), pixel_y(curve.fractions[i - 1]), pixel_x(step(i)),
                  pixel_y(curve.fractions[i]), curve.thickness, curve.color);
    }
  });
  return canvas;
}

}  // namespace frontlux::app
