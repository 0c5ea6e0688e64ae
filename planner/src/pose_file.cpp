#include "input_file.hpp"
#include "recorded_pose.hpp"

#include <frontlux/planner/recorded_scan.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace frontlux::planner {
namespace {

constexpr const char* kFormat = "write file,x,y,z,qx,qy,qz,qw or file,x,y,z,yaw";

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

RecordedPose pose_of(const std::filesystem::path& file, std::size_t line,
                     const std::vector<std::string_view>& fields) {
  const auto fail_here = [&](const std::string& what) {
    detail::fail(file, "line " + std::to_string(line) + ": " + what, kFormat);
  };
  if (fields.size() != 5 && fields.size() != 8)
    fail_here("has " + std::to_string(fields.size()) + " fields instead of 5 or 8");
  if (fields[0].empty()) fail_here("names no file");
  std::array<double, 7> n{};
  for (std::size_t i = 1; i < fields.size(); ++i) {
    const auto number = detail::to_number(fields[i]);
    if (!number || !std::isfinite(*number)) fail_here(detail::quoted(fields[i]) + " is no finite number");
    n[i - 1] = *number;
  }
  const bool has_yaw = fields.size() == 5;
  const Eigen::Quaterniond orientation =
      has_yaw ? Eigen::Quaterniond(Eigen::AngleAxisd(n[3], Eigen::Vector3d::UnitZ()))
              : Eigen::Quaterniond(n[6], n[3], n[4], n[5]);
  const auto pose = detail::pose_from({n[0], n[1], n[2]}, orientation);
  if (!pose) fail_here("the quaternion is not of length 1");
  return {std::string(fields[0]), line, *pose};
}

}  // namespace

std::vector<RecordedPose> read_pose_file(const std::filesystem::path& file) {
  const std::string text = detail::read_input_file(file);
  std::vector<RecordedPose> poses;
  detail::Lines lines(text);
  bool first = true;
  while (const auto line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    const auto fields = fields_of(*line);
    const bool names = first && fields[0] == "file" && fields.size() > 1 && !detail::to_number(fields[1]);
    first = false;
    if (!names) poses.push_back(pose_of(file, lines.number(), fields));
  }
  if (poses.empty()) detail::fail(file, "holds no pose", kFormat);
  return poses;
}

}  // namespace frontlux::planner
