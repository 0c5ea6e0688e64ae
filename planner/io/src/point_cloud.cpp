#include "input_file.hpp"
#include "point_record.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/recorded_scan.hpp>

#include <algorithm>
#include <string>

namespace frontlux::planner {
namespace detail {

std::size_t bytes_of(NumberType type) {
  constexpr std::array<std::size_t, 10> kBytes = {1, 2, 4, 8, 1, 2, 4, 8, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

double read_number(const char* bytes, NumberType type) {
  switch (type) {
    case NumberType::kInt8:
      return from_little_endian<std::int8_t>(bytes);
    case NumberType::kInt16:
      return from_little_endian<std::int16_t>(bytes);
    case NumberType::kInt32:
      return from_little_endian<std::int32_t>(bytes);
    case NumberType::kInt64:
      return static_cast<double>(from_little_endian<std::int64_t>(bytes));
    case NumberType::kUint8:
      return from_little_endian<std::uint8_t>(bytes);
    case NumberType::kUint16:
      return from_little_endian<std::uint16_t>(bytes);
    case NumberType::kUint32:
      return from_little_endian<std::uint32_t>(bytes);
    case NumberType::kUint64:
      return static_cast<double>(from_little_endian<std::uint64_t>(bytes));
    case NumberType::kFloat:
      return static_cast<double>(from_little_endian<float>(bytes));
    case NumberType::kDouble:
      break;
  }
  return from_little_endian<double>(bytes);
}

bool PointRecord::add(std::string_view name, NumberType type, std::size_t count) {
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (name == kNames[axis]) {
      if (xyz[axis] || count != 1) return false;
      xyz[axis] = Field{words, bytes, type};
    }
  words += count;
  bytes += count * bytes_of(type);
  return true;
}

std::vector<Eigen::Vector3f> read_binary_points(const std::filesystem::path& file, std::string_view bytes,
                                                std::size_t offset, std::uint64_t count,
                                                const PointRecord& record) {
  const std::size_t left = bytes.size() - offset;
  if (count > left / record.bytes)
    fail(file,
         "announces " + std::to_string(count) + " points of " + std::to_string(record.bytes) +
             " bytes, but only " + std::to_string(left) + " bytes follow (byte " + std::to_string(offset) +
             ")",
         "the file is damaged or incomplete: get another copy of it");
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* at = bytes.data() + offset + i * record.bytes;
    Eigen::Vector3f point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& field = *record.xyz[axis];
      point[static_cast<Eigen::Index>(axis)] = to_float(read_number(at + field.offset, field.type));
    }
    points.push_back(point);
  }
  return points;
}

std::vector<Eigen::Vector3f> read_ascii_points(const std::filesystem::path& file, Lines& lines,
                                               std::uint64_t count, const PointRecord& record) {
  std::vector<Eigen::Vector3f> points;  // not reserved: the count is only what the file says
  std::vector<std::string_view> words;
  while (points.size() < count) {
    auto line = lines.next();
    if (!line)
      fail(file, "ends after " + std::to_string(points.size()) + " of " + std::to_string(count) + " points",
           "the file is incomplete: get another copy of it");
    words.clear();
    for (auto word = take_word(*line); !word.empty(); word = take_word(*line)) words.push_back(word);
    if (words.empty()) continue;
    const std::string where = "line " + std::to_string(lines.number()) + ": ";
    if (words.size() != record.words)
      fail(file,
           where + "has " + std::to_string(words.size()) + " numbers instead of " +
               std::to_string(record.words),
           "write the fields of the header, a line for each point");
    Eigen::Vector3f point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view word = words[record.xyz[axis]->word];
      const auto number = to_number(word);
      if (!number)
        fail(file, where + quote(word) + " is no number", "write a number, or nan if there is none");
      point[static_cast<Eigen::Index>(axis)] = to_float(*number);
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace detail

std::vector<Eigen::Vector3f> read_point_cloud(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (ending != ".pcd" && ending != ".ply")
    frontlux::fail(file, "is no kind of point cloud that can be read", "give a .pcd or .ply file");
  const std::string bytes = read_file(file);
  return ending == ".pcd" ? detail::parse_pcd(file, bytes) : detail::parse_ply(file, bytes);
}

}  // namespace frontlux::planner
