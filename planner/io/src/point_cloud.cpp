#include "parsing.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/ply.hpp>
#include <frontlux/io/point_cloud.hpp>

#include <array>
#include <optional>
#include <string>

namespace frontlux::io {
namespace {

constexpr std::uint64_t kMaxCount = 1 << 20;  // numbers in one field of a point

// What the header of a PCD file says, line by line.
struct Header {
  std::vector<std::string_view> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
  std::string_view data;
};

// How points are stored: records of equal size, x, y and z somewhere in each.
struct PointRecord {
  struct Field {
    std::size_t word;    // its place among the numbers of the record
    std::size_t offset;  // its place in a binary record [bytes]
    NumberType type;
  };
  std::array<std::optional<Field>, 3> xyz;
  std::size_t words = 0;  // numbers in a record
  std::size_t bytes = 0;  // of a binary record
};

std::optional<NumberType> type_of(std::string_view type, std::string_view size) {
  const std::string name = std::string(type) + std::string(size);
  if (name == "F4") return kNumberType<float>;
  if (name == "F8") return kNumberType<double>;
  if (name == "I1") return kNumberType<std::int8_t>;
  if (name == "I2") return kNumberType<std::int16_t>;
  if (name == "I4") return kNumberType<std::int32_t>;
  if (name == "I8") return kNumberType<std::int64_t>;
  if (name == "U1") return kNumberType<std::uint8_t>;
  if (name == "U2") return kNumberType<std::uint16_t>;
  if (name == "U4") return kNumberType<std::uint32_t>;
  if (name == "U8") return kNumberType<std::uint64_t>;
  return std::nullopt;
}

class PcdReader {
 public:
  PcdReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes), lines_(bytes) {}

  std::vector<Eigen::Vector3f> read() {
    const Header header = read_header();
    const PointRecord record = record_of(header);
    const std::uint64_t points = points_of(header);
    if (header.data == "ascii") return read_ascii(points, record);
    if (header.data == "binary") return read_binary(points, record);
    fail_here("DATA is " + quote(header.data), "save the cloud as ascii or binary");
  }

 private:
  [[noreturn]] void fail_here(const std::string& what, const std::string& advice) const {
    fail(file_, "line " + std::to_string(lines_.number()) + ": " + what, advice);
  }

  Header read_header() {
    Header header;
    while (header.data.empty()) {
      const auto line = lines_.next();
      if (!line)
        fail(file_, "ends before its header does",
             "a PCD header ends with a line of DATA ascii or DATA binary");
      const auto words = words_of(*line);
      if (!words.empty() && !words[0].starts_with('#')) take_line(words, header);
    }
    return header;
  }

  void take_line(const std::vector<std::string_view>& words, Header& header) const {
    const std::vector<std::string_view> values(words.begin() + 1, words.end());
    const std::string_view name = words[0];
    const auto count = [&]() -> std::uint64_t {
      const auto number = values.size() == 1 ? to_count(values[0]) : std::nullopt;
      if (!number) fail_here(std::string(name) + " is not followed by one whole number", "write one");
      return *number;
    };
    if (name == "FIELDS" || name == "COLUMNS")
      header.fields = values;
    else if (name == "SIZE")
      header.sizes = values;
    else if (name == "TYPE")
      header.types = values;
    else if (name == "COUNT")
      header.counts = values;
    else if (name == "WIDTH")
      header.width = count();
    else if (name == "HEIGHT")
      header.height = count();
    else if (name == "POINTS")
      header.points = count();
    else if (name == "DATA" && values.size() == 1)
      header.data = values[0];
    else if (name != "VERSION" && name != "VIEWPOINT")
      fail_here(quote(name) + " belongs into no PCD header", "check that this is a PCD file of version 0.7");
  }

  [[nodiscard]] PointRecord record_of(const Header& header) const {
    const std::size_t fields = header.fields.size();
    if (header.sizes.size() != fields || header.types.size() != fields ||
        (!header.counts.empty() && header.counts.size() != fields))
      fail_here("FIELDS, SIZE, TYPE and COUNT above are not of the same length",
                "give each field one of each");
    PointRecord record;
    for (std::size_t i = 0; i < fields; ++i) {
      const std::string name = quote(header.fields[i]);
      const auto type = type_of(header.types[i], header.sizes[i]);
      if (!type)
        fail_here("the field " + name + " is of type " + quote(header.types[i]) + " and size " +
                      quote(header.sizes[i]),
                  "write F with 4 or 8, or I or U with 1, 2, 4 or 8");
      const auto count = header.counts.empty() ? std::optional<std::uint64_t>(1) : to_count(header.counts[i]);
      if (!count || *count == 0 || *count > kMaxCount)
        fail_here("the field " + name + " has a COUNT of " + quote(header.counts[i]),
                  "write a whole number above 0");
      const std::size_t axis = std::string_view("xyz").find(header.fields[i]);
      if (header.fields[i].size() == 1 && axis < 3) {
        if (record.xyz[axis] || *count != 1)
          fail_here("the field " + name + " comes twice, or is not one number", "leave one");
        record.xyz[axis] = {record.words, record.bytes, *type};
      }
      record.words += *count;
      record.bytes += *count * type->bytes;
    }
    if (!record.xyz[0] || !record.xyz[1] || !record.xyz[2])
      fail_here("there are no fields x, y and z", "save the cloud with them");
    return record;
  }

  [[nodiscard]] std::uint64_t points_of(const Header& header) const {
    std::optional<std::uint64_t> by_size;
    if (header.width) {
      const std::uint64_t height = header.height.value_or(1);
      if (height != 0 && *header.width > (std::uint64_t{1} << 40) / height)
        fail_here("WIDTH times HEIGHT is more points than can be", "check the header");
      by_size = *header.width * height;
    }
    if (!header.points && !by_size)
      fail_here("there is no line of POINTS above", "say how many points there are");
    if (header.points && by_size && *header.points != *by_size)
      fail_here("POINTS is " + std::to_string(*header.points) + ", but WIDTH times HEIGHT is " +
                    std::to_string(*by_size),
                "make them agree");
    return header.points ? *header.points : *by_size;
  }

  [[nodiscard]] std::vector<Eigen::Vector3f> read_binary(std::uint64_t count,
                                                         const PointRecord& record) const {
    const std::size_t offset = lines_.offset(), left = bytes_.size() - offset;
    if (count > left / record.bytes)
      fail(file_,
           "announces " + std::to_string(count) + " points of " + std::to_string(record.bytes) +
               " bytes, but only " + std::to_string(left) + " bytes follow (byte " + std::to_string(offset) +
               ")",
           "the file is damaged or incomplete: get another copy of it");
    std::vector<Eigen::Vector3f> points(static_cast<std::size_t>(count));
    const char* at = bytes_.data() + offset;
    for (Eigen::Vector3f& point : points) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& field = *record.xyz[axis];
        point[static_cast<Eigen::Index>(axis)] =
            to_float(field.type.read(at + field.offset, std::endian::little));
      }
      at += record.bytes;
    }
    return points;
  }

  [[nodiscard]] std::vector<Eigen::Vector3f> read_ascii(std::uint64_t count, const PointRecord& record) {
    std::vector<Eigen::Vector3f> points;  // not reserved: the count is only what the file says
    while (points.size() < count) {
      const auto line = lines_.next();
      if (!line)
        fail(file_,
             "ends after " + std::to_string(points.size()) + " of " + std::to_string(count) + " points",
             "the file is incomplete: get another copy of it");
      const auto words = words_of(*line);
      if (words.empty()) continue;
      if (words.size() != record.words)
        fail_here(
            "has " + std::to_string(words.size()) + " numbers instead of " + std::to_string(record.words),
            "write the fields of the header, a line for each point");
      Eigen::Vector3f point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string_view word = words[record.xyz[axis]->word];
        const auto number = to_number(word);
        if (!number) fail_here(quote(word) + " is no number", "write a number, or nan if there is none");
        point[static_cast<Eigen::Index>(axis)] = to_float(*number);
      }
      points.push_back(point);
    }
    while (const auto line = lines_.next())
      if (!words_of(*line).empty())
        fail_here("comes after all " + std::to_string(count) + " points that the header announces",
                  "make POINTS, WIDTH and HEIGHT agree with the lines");
    return points;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  Lines lines_;
};

}  // namespace

std::vector<Eigen::Vector3f> read_point_cloud(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".pcd") {
    const std::string bytes = read_file(file);
    return PcdReader(file, bytes).read();
  }
  if (extension != ".ply")
    fail(file, "is no kind of point cloud that can be read", "give a .pcd or .ply file");
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& vertex : read_ply(file).vertices)
    points.emplace_back(vertex.unaryExpr(&to_float));
  return points;
}

}  // namespace frontlux::io
