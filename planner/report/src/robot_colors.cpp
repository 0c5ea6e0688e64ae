#include "parts.hpp"

#include <frontlux/report/robot_colors.hpp>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string>

namespace frontlux::report {
namespace {

// The number at the end of a name; 1 if there is none.
std::size_t number_of(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  std::size_t number = 1;
  std::from_chars(name.data() + digits, name.data() + name.size(), number);
  return std::max<std::size_t>(number, 1);
}

}  // namespace

std::vector<ColorPair> robot_colors(std::span<const planner::RobotDescription> team) {
  std::vector<ColorPair> colors;
  const auto taken = [&](const ColorPair& color) {
    return std::ranges::find(colors, color.light, &ColorPair::light) != colors.end();
  };
  for (const planner::RobotDescription& description : team) {
    const bool ground = description.robot.travel.drives();
    const std::span<const ColorPair> choice = ground ? detail::ground_colors() : detail::aerial_colors();
    const std::size_t own = (number_of(description.robot.name) - 1) % choice.size();
    std::size_t i = 0;
    while (i < choice.size() && taken(choice[(own + i) % choice.size()])) ++i;
    colors.push_back(choice[(own + i) % choice.size()]);
  }
  return colors;
}

}  // namespace frontlux::report
