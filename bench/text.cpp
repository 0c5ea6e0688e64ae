#include "text.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace frontlux::bench {

std::string cell(const char* pattern, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

std::string pad(const std::string& text, std::size_t width) {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

std::string digits(double value) {
  return cell(value < 9.995 ? "%.2f" : value < 99.95 ? "%.1f" : "%.0f", value);
}

std::string percent(double share) {
  if (share == 1.0) return "100 %";
  return cell("%.2f %%", std::min(100 * share, 99.99));
}

std::string words(int threads) { return std::to_string(threads) + (threads == 1 ? " thread" : " threads"); }

std::string centered(const std::string& text, std::size_t width) {
  const std::size_t left = (width - std::min(width, text.size())) / 2;
  return pad(text, left + text.size()) + std::string(width - std::min(width, left + text.size()), ' ');
}

}  // namespace frontlux::bench
