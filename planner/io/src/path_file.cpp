#include <frontlux/file.hpp>
#include <frontlux/io/path_file.hpp>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string>

namespace frontlux::io {
namespace {

constexpr double kArrow = 0.3;  // [m]

template <class Number>
void append(std::string& text, std::initializer_list<Number> numbers, char between) {
  for (const Number number : numbers) text += decimals_of(number) + between;
  text.back() = '\n';
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
  write_file(file, csv ? csv_of(viewpoints) : ply_of(viewpoints));
}

}  // namespace frontlux::io
