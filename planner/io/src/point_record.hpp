#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace frontlux::planner::detail {

/// How a number lies in a binary file.
enum class NumberType : std::uint8_t {
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kUint8,
  kUint16,
  kUint32,
  kUint64,
  kFloat,
  kDouble
};

[[nodiscard]] std::size_t bytes_of(NumberType type);
[[nodiscard]] double read_number(const char* bytes, NumberType type);

/// How points are laid out in a file: records of equal size, x, y and z somewhere in each.
struct PointRecord {
  struct Field {
    std::size_t word = 0;    ///< its place among the numbers of the record
    std::size_t offset = 0;  ///< its place in a binary record [bytes]
    NumberType type = NumberType::kFloat;
  };
  std::array<std::optional<Field>, 3> xyz;
  std::size_t words = 0;  ///< numbers in a record
  std::size_t bytes = 0;  ///< of a binary record

  /// Adds a field of `count` numbers at the end. False if there is an x, y or z by this name already, or
  /// one that is not a single number.
  bool add(std::string_view name, NumberType type, std::size_t count);
  [[nodiscard]] bool complete() const { return xyz[0] && xyz[1] && xyz[2]; }
};

/// `count` binary records, the first at `offset`.
/// @throws std::runtime_error naming the file, if it ends before they do
[[nodiscard]] std::vector<Eigen::Vector3f> read_binary_points(const std::filesystem::path& file,
                                                              std::string_view bytes, std::size_t offset,
                                                              std::uint64_t count, const PointRecord& record);

class Lines;

/// `count` lines of numbers.
/// @throws std::runtime_error naming the file and the line
[[nodiscard]] std::vector<Eigen::Vector3f> read_ascii_points(const std::filesystem::path& file, Lines& lines,
                                                             std::uint64_t count, const PointRecord& record);

[[nodiscard]] std::vector<Eigen::Vector3f> parse_pcd(const std::filesystem::path& file,
                                                     std::string_view bytes);
[[nodiscard]] std::vector<Eigen::Vector3f> parse_ply(const std::filesystem::path& file,
                                                     std::string_view bytes);

}  // namespace frontlux::planner::detail
