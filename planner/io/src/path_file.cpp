#include <frontlux/file.hpp>
#include <frontlux/io/path_file.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <ostream>
#include <stdexcept>
#include <string>

namespace frontlux::io {
namespace {

constexpr double kArrow = 0.3;  // [m]

// The shortest decimals that read back as the same number, in every locale.
template <class Number>
void append(std::string& line, std::initializer_list<Number> numbers, char between) {
  std::array<char, 64> text;
  bool first = true;
  for (const Number number : numbers) {
    if (!first) line += between;
    first = false;
    line.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr);
  }
  line += '\n';
}

std::string csv_of(std::span<const planner::Pose> viewpoints) {
  std::string lines = "x,y,z,yaw\n";
  for (const planner::Pose& v : viewpoints)
    append(lines, {v.position.x(), v.position.y(), v.position.z(), v.yaw}, ',');
  return lines;
}

std::string ply_of(std::span<const planner::Pose> viewpoints) {
  const std::size_t count = viewpoints.size(), along = count > 0 ? count - 1 : 0;
  std::string text =
      "ply\nformat ascii 1.0\ncomment frontlux path: metres, z up; points, then the tips of their arrows\n"
      "element vertex " +
      std::to_string(2 * count) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nelement edge " +
      std::to_string(along + count) + "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  for (const double arrow : {0.0, kArrow})
    for (const planner::Pose& v : viewpoints) {
      const Eigen::Vector3d view(std::cos(v.yaw), std::sin(v.yaw), 0.0);
      const Eigen::Vector3f at = (v.position + arrow * view).cast<float>(), normal = view.cast<float>();
      append(text, {at.x(), at.y(), at.z(), normal.x(), normal.y(), normal.z()}, ' ');
    }
  for (std::size_t i = 0; i < along; ++i) append(text, {i, i + 1}, ' ');
  for (std::size_t i = 0; i < count; ++i) append(text, {i, count + i}, ' ');
  return text;
}

}  // namespace

void write_path(const std::filesystem::path& file, std::span<const planner::Pose> viewpoints) {
  const bool csv = file.extension() == ".csv";
  if (!csv && file.extension() != ".ply")
    throw std::invalid_argument(file.string() + " is no name for a path; give one that ends in .csv or .ply");
  const std::string text = csv ? csv_of(viewpoints) : ply_of(viewpoints);
  write_file(file,
             [&](std::ostream& out) { out.write(text.data(), static_cast<std::streamsize>(text.size())); });
}

}  // namespace frontlux::io
