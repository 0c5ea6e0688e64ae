#include "share_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace frontlux::app {

std::string share_text(double share, int digits) {
  const double scale = std::pow(10.0, digits);
  double percent = std::round(100.0 * share * scale) / scale;
  if (share < 1.0) percent = std::min(percent, 100.0 - 1.0 / scale);
  std::array<char, 64> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), percent, std::chars_format::fixed, digits).ptr;
  return std::string(text.data(), end) + " %";
}

}  // namespace frontlux::app
