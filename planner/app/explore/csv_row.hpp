#pragma once

#include "text.hpp"

#include <frontlux/planner/pose.hpp>

#include <string>
#include <string_view>
#include <type_traits>

namespace frontlux::app {

/// A cell of a table with commas. Text with a comma, a quote or a line break is quoted.
[[nodiscard]] inline std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}
template <class Number>
requires std::is_arithmetic_v<Number>
[[nodiscard]] std::string csv_cell(Number number) { return to_text(number); }
/// Four cells: x, y, z, yaw.
[[nodiscard]] inline std::string csv_cell(const planner::Pose& pose) {
  const Eigen::Vector3d& p = pose.position;
  return to_text(p.x()) + ',' + to_text(p.y()) + ',' + to_text(p.z()) + ',' + to_text(pose.yaw);
}

/// A line of a table with commas, with its end.
template <class... Cells>
[[nodiscard]] std::string csv_row(const Cells&... cells) {
  std::string line;
  (line.append(line.empty() ? "" : ",").append(csv_cell(cells)), ...);
  return line + '\n';
}

}  // namespace frontlux::app
