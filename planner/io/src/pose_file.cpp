#include "parsing.hpp"
#include "rigid_pose.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/pose_file.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frontlux::io {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

// The fields of a line of a table, without blanks around them. One in quotes may hold commas and, doubled,
// quotes. Nothing if a quote does not end, or has something behind it.
std::optional<std::vector<std::string>> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (;;) {
    line = trimmed(line);
    std::string& field = fields.emplace_back();
    if (!line.starts_with('"')) {
      field = trimmed(line.substr(0, line.find(',')));
      line.remove_prefix(std::min(line.find(','), line.size()));
    } else {
      do {
        line.remove_prefix(1);
        const std::size_t end = line.find('"');
        if (end == std::string_view::npos) return std::nullopt;
        field += line.substr(0, end);
        line.remove_prefix(end + 1);
        if (line.starts_with('"')) field += '"';
      } while (line.starts_with('"'));
      line = trimmed(line);
      if (!line.empty() && !line.starts_with(',')) return std::nullopt;
    }
    if (line.empty()) return fields;
    line.remove_prefix(1);
  }
}

// A line of a table.
struct Row {
  const std::filesystem::path& file;
  const char* format;
  std::size_t line;
  std::vector<std::string> fields;

  [[noreturn]] void fail_here(const std::string& what) const {
    fail(file, "line " + std::to_string(line) + ": " + what, format);
  }
  [[nodiscard]] double finite(std::size_t i) const {
    const auto number = to_number(fields[i]);
    if (!number || !std::isfinite(*number)) fail_here(quote(fields[i]) + " is no finite number");
    return *number;
  }
};

// Calls `take(row)` for every line with content, except a first line of names: one that begins with the first
// name of these lists and has no number in its field `numeric`. It has to be one of the lists.
template <class Take>
void for_each_row(const std::filesystem::path& file, const char* format,
                  const std::vector<std::vector<std::string>>& names, std::size_t numeric, const Take& take) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::string bytes = read_file(file);
  std::string_view text = bytes;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Lines lines(text);
  bool first = true, empty = true;
  while (auto line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    Row row{file, format, lines.number(), {}};
    auto fields = fields_of(*line);
    if (!fields) row.fail_here("has a quote that does not end where a field does");
    row.fields = std::move(*fields);
    if (std::exchange(first, false) && row.fields[0] == names[0][0] && row.fields.size() > numeric &&
        !to_number(row.fields[numeric])) {
      if (std::ranges::find(names, row.fields) == names.end())
        row.fail_here("names other columns, or in another order");
      continue;
    }
    take(row);
    empty = false;
  }
  if (empty) fail(file, "holds no pose", format);
}

Eigen::Vector3d position_at(const Row& row, std::size_t i) {
  return {row.finite(i), row.finite(i + 1), row.finite(i + 2)};
}

double yaw_at(const Row& row, std::size_t i) {
  const double yaw = row.finite(i);
  if (!is_within_a_turn(yaw))
    row.fail_here("has a yaw of " + row.fields[i] + ", more than a turn: yaws are in radians");
  return yaw;
}

RecordedPose recorded_pose(const Row& row) {
  const std::size_t fields = row.fields.size();
  if (fields != 5 && fields != 8)
    row.fail_here("has " + std::to_string(fields) + " fields instead of 5 or 8");
  if (row.fields[0].empty()) row.fail_here("names no file");
  const Eigen::Vector3d position = position_at(row, 1);
  const Eigen::Quaterniond orientation =
      fields == 5 ? Eigen::Quaterniond(Eigen::AngleAxisd(yaw_at(row, 4), Eigen::Vector3d::UnitZ()))
                  : Eigen::Quaterniond(row.finite(7), row.finite(4), row.finite(5), row.finite(6));
  const auto pose = rigid_pose(position, orientation);
  if (!pose) row.fail_here("the quaternion is not of length 1");
  return {row.fields[0], row.line, *pose};
}

}  // namespace

std::vector<RecordedPose> read_pose_file(const std::filesystem::path& file) {
  std::vector<RecordedPose> poses;
  for_each_row(file, "write file,x,y,z,qx,qy,qz,qw or file,x,y,z,yaw",
               {{"file", "x", "y", "z", "qx", "qy", "qz", "qw"}, {"file", "x", "y", "z", "yaw"}}, 1,
               [&](const Row& row) { poses.push_back(recorded_pose(row)); });
  return poses;
}

std::vector<ListedPose> read_pose_list(const std::filesystem::path& file) {
  std::vector<ListedPose> poses;
  for_each_row(file, "write x,y,z,yaw", {{"x", "y", "z", "yaw"}}, 0, [&](const Row& row) {
    if (row.fields.size() != 4)
      row.fail_here("has " + std::to_string(row.fields.size()) + " fields instead of 4");
    poses.push_back({{position_at(row, 0), yaw_at(row, 3)}, row.line});
  });
  return poses;
}

}  // namespace frontlux::io
