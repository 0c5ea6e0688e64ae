#include "draw/robot_color.hpp"

#include <array>

namespace frontlux::app {

Color robot_color(std::size_t robot) {
  constexpr std::array<Color, 4> kColors = {{{213, 94, 0}, {0, 114, 178}, {0, 158, 115}, {170, 68, 153}}};
  return kColors.at(robot % kColors.size());
}

}  // namespace frontlux::app
