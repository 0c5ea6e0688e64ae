#include "text.hpp"

#include "bad_input.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <system_error>

namespace frontlux::app {
namespace {

template <class... Format>
std::string written(Format... format) {
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), format...);
  return {buffer.data(), result.ptr};
}

// from_chars knows no leading plus.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

template <class Number>
std::optional<Number> parse_finite(std::string_view text) {
  text = without_plus(text);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace

std::string to_text(float number) { return written(number); }

std::string to_text(double number) { return written(number); }

std::string rounded(double number) { return written(number, std::chars_format::general, 7); }

std::string to_text_bytes(std::size_t bytes) {
  constexpr std::array kUnits = {" B", " KiB", " MiB", " GiB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 1024. && unit + 1 < kUnits.size(); ++unit) amount /= 1024.;
  return written(amount, std::chars_format::fixed, unit == 0 ? 0 : 1) + kUnits[unit];
}

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

std::string row(std::string_view label, std::string_view value) {
  constexpr std::size_t kWidth = 13;
  std::string line(label);
  line.resize(std::max(kWidth, line.size() + 1), ' ');
  return line.append(value) + '\n';
}

double parse_number(std::string_view name, std::string_view text) {
  if (const auto number = parse_finite<double>(text)) return *number;
  throw BadInput(std::string(name) + ": '" + std::string(text) + "' is not a finite number");
}

double parse_length(std::string_view name, std::string_view text) {
  const double length = parse_number(name, text);
  if (!(length > 0.0))
    throw BadInput(std::string(name) + ": " + std::string(text) + " m is no length; give one above 0");
  return length;
}

double parse_resolution(std::string_view text) {
  const double resolution = parse_length("--resolution", text);
  if (resolution < 1e-3 || resolution > 1e3)
    throw BadInput("--resolution: " + std::string(text) + " m is no voxel to map with; give 0.001 to 1000 m");
  return resolution;
}

Eigen::Vector3f parse_vector(std::string_view name, std::string_view text) {
  Eigen::Vector3f vector;
  std::string_view rest = text;
  for (int i = 0; i < 3; ++i) {
    const auto comma = rest.find(',');
    const auto number = parse_finite<float>(rest.substr(0, comma));
    if (!number || (comma == std::string_view::npos) != (i == 2))
      throw BadInput(std::string(name) + ": '" + std::string(text) +
                     "' is not three finite numbers; write them with commas and no blanks, as in " +
                     std::string(name) + "=1.5,-2,0.4");
    vector[i] = *number;
    if (i < 2) rest.remove_prefix(comma + 1);
  }
  return vector;
}

}  // namespace frontlux::app
