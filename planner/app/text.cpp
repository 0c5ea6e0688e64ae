#include "text.hpp"

#include "terminal.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace frontlux::app {
namespace {

template <class... Format>
std::string written(Format... format) {
  std::array<char, 400> buffer;  // 309 digits before the point at most
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), format...);
  return {buffer.data(), result.ptr};
}

}  // namespace

std::string to_text(float number) { return decimals_of(number); }

std::string to_text(double number) { return decimals_of(number); }

double as_written(float number) { return number_from<double>(to_text(number)).value(); }

std::string to_text(const Eigen::Vector3f& point) {
  return to_text(point.x()) + ", " + to_text(point.y()) + ", " + to_text(point.z());
}

std::string to_text(const VoxelKey& key) {
  return std::to_string(key.x) + ", " + std::to_string(key.y) + ", " + std::to_string(key.z);
}

std::string to_text(Occupancy state) {
  constexpr std::array kNames = {"unknown", "free", "occupied"};
  return kNames[static_cast<std::size_t>(state)];
}

std::string rounded(double number) { return written(number, std::chars_format::general, 7); }

std::string fixed(double number, int digits) { return written(number, std::chars_format::fixed, digits); }

std::string bytes_text(std::size_t bytes) {
  constexpr std::array kUnits = {" B", " KiB", " MiB", " GiB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 1024. && unit + 1 < kUnits.size(); ++unit) amount /= 1024.;
  return fixed(amount, unit == 0 ? 0 : 1) + kUnits[unit];
}

std::string percent(double fraction, int digits) {
  const double scale = std::pow(10.0, digits);
  double percents = std::round(100.0 * fraction * scale) / scale;
  if (fraction < 1.0) percents = std::min(percents, 100.0 - 1.0 / scale);
  return fixed(percents, digits) + " %";
}

std::string row(std::string_view label, std::string_view value) {
  constexpr std::size_t kWidth = 13;
  std::string line(label);
  line.resize(std::max(kWidth, line.size() + 1), ' ');
  // Names of files may hold anything.
  return without_controls(line.append(value)) + '\n';
}

}  // namespace frontlux::app
