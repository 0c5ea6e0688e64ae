#include "input_file.hpp"
#include "point_record.hpp"

#include <frontlux/file.hpp>

#include <string>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxCount = 1 << 20;  // numbers in one field of a point

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

// What the header says, line by line.
struct Header {
  std::vector<std::string_view> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
  std::string_view data;
};

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, Lines& lines) : file_(file), lines_(lines) {}

  Header read() {
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

  [[noreturn]] void fail_here(const std::string& what, const std::string& advice) const {
    fail(file_, "line " + std::to_string(lines_.number()) + ": " + what, advice);
  }

 private:
  void take_line(const std::vector<std::string_view>& words, Header& header) {
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

  const std::filesystem::path& file_;
  Lines& lines_;
};

std::optional<NumberType> type_of(std::string_view type, std::string_view size) {
  using enum NumberType;
  if (type == "F")
    return size == "4" ? std::optional(kFloat) : size == "8" ? std::optional(kDouble) : std::nullopt;
  const bool is_signed = type == "I";
  if (!is_signed && type != "U") return std::nullopt;
  if (size == "1") return is_signed ? kInt8 : kUint8;
  if (size == "2") return is_signed ? kInt16 : kUint16;
  if (size == "4") return is_signed ? kInt32 : kUint32;
  if (size == "8") return is_signed ? kInt64 : kUint64;
  return std::nullopt;
}

PointRecord record_of(const Header& header, const HeaderReader& reader) {
  const std::size_t fields = header.fields.size();
  if (header.sizes.size() != fields || header.types.size() != fields ||
      (!header.counts.empty() && header.counts.size() != fields))
    reader.fail_here("FIELDS, SIZE, TYPE and COUNT above are not of the same length",
                     "give each field one of each");
  PointRecord record;
  for (std::size_t i = 0; i < fields; ++i) {
    const auto type = type_of(header.types[i], header.sizes[i]);
    if (!type)
      reader.fail_here("the field " + quote(header.fields[i]) + " is of type " + quote(header.types[i]) +
                           " and size " + quote(header.sizes[i]),
                       "write F with 4 or 8, or I or U with 1, 2, 4 or 8");
    const auto count = header.counts.empty() ? std::optional<std::uint64_t>(1) : to_count(header.counts[i]);
    if (!count || *count == 0 || *count > kMaxCount)
      reader.fail_here(
          "the field " + quote(header.fields[i]) + " has a COUNT of " + quote(header.counts[i]),
          "write a whole number above 0");
    if (!record.add(header.fields[i], *type, static_cast<std::size_t>(*count)))
      reader.fail_here("the field " + quote(header.fields[i]) + " comes twice, or is not one number",
                       "leave one");
  }
  if (!record.complete()) reader.fail_here("there are no fields x, y and z", "save the cloud with them");
  return record;
}

std::uint64_t points_of(const Header& header, const HeaderReader& reader) {
  std::optional<std::uint64_t> by_size;
  if (header.width) {
    const std::uint64_t height = header.height.value_or(1);
    if (height != 0 && *header.width > (std::uint64_t{1} << 40) / height)
      reader.fail_here("WIDTH times HEIGHT is more points than can be", "check the header");
    by_size = *header.width * height;
  }
  if (!header.points && !by_size)
    reader.fail_here("there is no line of POINTS above", "say how many points there are");
  if (header.points && by_size && *header.points != *by_size)
    reader.fail_here("POINTS is " + std::to_string(*header.points) + ", but WIDTH times HEIGHT is " +
                         std::to_string(*by_size),
                     "make them agree");
  return header.points ? *header.points : *by_size;
}

}  // namespace

std::vector<Eigen::Vector3f> parse_pcd(const std::filesystem::path& file, std::string_view bytes) {
  Lines lines(bytes);
  HeaderReader reader(file, lines);
  const Header header = reader.read();
  const PointRecord record = record_of(header, reader);
  const std::uint64_t points = points_of(header, reader);
  if (header.data == "ascii") return read_ascii_points(file, lines, points, record);
  if (header.data == "binary") return read_binary_points(file, bytes, lines.offset(), points, record);
  reader.fail_here("DATA is " + quote(header.data), "save the cloud as ascii or binary");
}

}  // namespace frontlux::planner::detail
