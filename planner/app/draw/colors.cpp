#include "draw/colors.hpp"

#include <frontlux/report/robot_colors.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace frontlux::app {
namespace {

std::uint8_t encoded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double gamma = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * gamma));
}

// Oklab: lightness and two axes of opponent colours that eyes judge evenly.
Color from_oklab(double lightness, double green_red, double blue_yellow) {
  const auto cube = [](double root) { return root * root * root; };
  const double l = cube(lightness + 0.3963377774 * green_red + 0.2158037573 * blue_yellow);
  const double m = cube(lightness - 0.1055613458 * green_red - 0.0638541728 * blue_yellow);
  const double s = cube(lightness - 0.0894841775 * green_red - 1.2914855480 * blue_yellow);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

Color on_paper(const report::ColorPair& color) {
  constexpr int kHexadecimal = 16;
  unsigned rgb = 0;
  std::from_chars(color.light.data() + 1, color.light.data() + color.light.size(), rgb, kHexadecimal);
  return {static_cast<std::uint8_t>(rgb >> 16U), static_cast<std::uint8_t>(rgb >> 8U),
          static_cast<std::uint8_t>(rgb)};
}

}  // namespace

Color color_of(double fraction) {
  const double t = fraction > 0.0 ? std::min(fraction, 1.0) : 0.0;
  // The hue turns from violet over blue and green to yellow; chroma stays within what screens show.
  const double lightness = 0.28 + 0.64 * t;
  const double hue = (302.0 - 197.0 * t) * std::numbers::pi / 180.0;
  const double chroma = t < 0.5 ? 0.150 - 0.10 * t : 0.100 + 0.16 * (t - 0.5);
  return from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
}

std::vector<Color> robot_colors(const std::vector<planner::RobotDescription>& team) {
  std::vector<Color> colors;
  for (const report::ColorPair& color : report::robot_colors(team)) colors.push_back(on_paper(color));
  return colors;
}

Color frontier_color() { return on_paper(report::frontier_color()); }

}  // namespace frontlux::app
