#include "input_file.hpp"
#include "recorded_pose.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/io/recorded_scan.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace frontlux::planner {
namespace {

constexpr const char* kFormat = "write file,x,y,z,qx,qy,qz,qw or file,x,y,z,yaw";
constexpr const char* kListFormat = "write x,y,z,yaw";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

[[noreturn]] void fail_at(const std::filesystem::path& file, std::size_t line, const std::string& what,
                          const char* format) {
  frontlux::fail(file, "line " + std::to_string(line) + ": " + what, format);
}

double finite(const std::filesystem::path& file, std::size_t line, std::string_view field,
              const char* format) {
  const auto number = detail::to_number(field);
  if (!number || !std::isfinite(*number))
    fail_at(file, line, quote(field) + " is no finite number", format);
  return *number;
}

RecordedPose pose_of(const std::filesystem::path& file, std::size_t line,
                     const std::vector<std::string_view>& fields) {
  if (fields.size() != 5 && fields.size() != 8)
    fail_at(file, line, "has " + std::to_string(fields.size()) + " fields instead of 5 or 8", kFormat);
  if (fields[0].empty()) fail_at(file, line, "names no file", kFormat);
  std::array<double, 7> n{};
  for (std::size_t i = 1; i < fields.size(); ++i) n[i - 1] = finite(file, line, fields[i], kFormat);
  const bool has_yaw = fields.size() == 5;
  const Eigen::Quaterniond orientation =
      has_yaw ? Eigen::Quaterniond(Eigen::AngleAxisd(n[3], Eigen::Vector3d::UnitZ()))
              : Eigen::Quaterniond(n[6], n[3], n[4], n[5]);
  const auto pose = detail::pose_from({n[0], n[1], n[2]}, orientation);
  if (!pose) fail_at(file, line, "the quaternion is not of length 1", kFormat);
  return {std::string(fields[0]), line, *pose};
}

// Calls `take(line, fields)` for every line that holds something, but for one of names at the beginning,
// which has no number in its field `numeric`.
template <class Take>
void for_each_row(const std::filesystem::path& file, std::string_view name, std::size_t numeric,
                  const Take& take) {
  const std::string text = read_file(file);
  detail::Lines lines(text);
  bool first = true;
  while (const auto line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    const auto fields = fields_of(*line);
    const bool names =
        first && fields[0] == name && fields.size() > numeric && !detail::to_number(fields[numeric]);
    first = false;
    if (!names) take(lines.number(), fields);
  }
}

}  // namespace

std::vector<RecordedPose> read_pose_file(const std::filesystem::path& file) {
  std::vector<RecordedPose> poses;
  for_each_row(file, "file", 1, [&](std::size_t line, const std::vector<std::string_view>& fields) {
    poses.push_back(pose_of(file, line, fields));
  });
  if (poses.empty()) frontlux::fail(file, "holds no pose", kFormat);
  return poses;
}

std::vector<ListedPose> read_pose_list(const std::filesystem::path& file) {
  std::vector<ListedPose> poses;
  for_each_row(file, "x", 0, [&](std::size_t line, const std::vector<std::string_view>& fields) {
    if (fields.size() != 4)
      fail_at(file, line, "has " + std::to_string(fields.size()) + " fields instead of 4", kListFormat);
    std::array<double, 4> n{};
    for (std::size_t i = 0; i < 4; ++i) n[i] = finite(file, line, fields[i], kListFormat);
    poses.push_back({{{n[0], n[1], n[2]}, n[3]}, line});
  });
  if (poses.empty()) frontlux::fail(file, "holds no pose", kListFormat);
  return poses;
}

}  // namespace frontlux::planner
