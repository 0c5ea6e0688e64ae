#include "input_file.hpp"
#include "point_record.hpp"

#include <frontlux/file.hpp>

#include <string>
#include <utility>

namespace frontlux::planner::detail {
namespace {

std::optional<NumberType> type_of(std::string_view name) {
  using enum NumberType;
  constexpr std::array<std::pair<std::string_view, NumberType>, 16> kNames = {{{"char", kInt8},
                                                                               {"int8", kInt8},
                                                                               {"uchar", kUint8},
                                                                               {"uint8", kUint8},
                                                                               {"short", kInt16},
                                                                               {"int16", kInt16},
                                                                               {"ushort", kUint16},
                                                                               {"uint16", kUint16},
                                                                               {"int", kInt32},
                                                                               {"int32", kInt32},
                                                                               {"uint", kUint32},
                                                                               {"uint32", kUint32},
                                                                               {"float", kFloat},
                                                                               {"float32", kFloat},
                                                                               {"double", kDouble},
                                                                               {"float64", kDouble}}};
  for (const auto& [known, type] : kNames)
    if (name == known) return type;
  return std::nullopt;
}

// The header, of which only what comes up to the vertices matters.
class Header {
 public:
  Header(const std::filesystem::path& file, Lines& lines) : file_(file), lines_(lines) {
    if (next_line() != "ply")
      fail_here("does not begin with the line 'ply'", "check that this is a PLY file");
    while (true) {
      std::string_view line = next_line();
      const std::string_view word = take_word(line);
      if (word == "end_header") break;
      if (word == "format") {
        format_ = take_word(line);
      } else if (word == "element") {
        take_element(line);
      } else if (word == "property") {
        take_property(line);
      } else if (word != "comment" && word != "obj_info" && !word.empty()) {
        fail_here(quote(word) + " belongs into no PLY header", "check that this is a PLY file");
      }
    }
    if (!vertices_) fail_here("there is no element 'vertex' above", "save the cloud with one");
    if (!record_.complete()) fail_here("the vertices have no x, y and z", "save the cloud with them");
    if (format_ != "ascii" && format_ != "binary_little_endian")
      fail_here("the format is " + quote(format_), "save the cloud as ascii or binary_little_endian");
  }

  [[nodiscard]] bool ascii() const { return format_ == "ascii"; }
  [[nodiscard]] std::uint64_t vertices() const { return *vertices_; }
  [[nodiscard]] const PointRecord& record() const { return record_; }

 private:
  [[noreturn]] void fail_here(const std::string& what, const std::string& advice) const {
    fail(file_, "line " + std::to_string(lines_.number()) + ": " + what, advice);
  }

  std::string_view next_line() {
    const auto line = lines_.next();
    if (!line) fail(file_, "ends before its header does", "a PLY header ends with a line of end_header");
    return *line;
  }

  void take_element(std::string_view line) {
    const std::string_view name = take_word(line);
    const auto count = to_count(take_word(line));
    if (!count) fail_here("the element " + quote(name) + " has no number", "say how many there are");
    in_vertices_ = name == "vertex";
    if (in_vertices_ && vertices_) fail_here("there is a second element 'vertex'", "leave one");
    if (!in_vertices_ && !vertices_)
      fail_here("the element " + quote(name) + " comes before the vertices",
                "save the cloud with the vertices first");
    if (in_vertices_) vertices_ = count;
  }

  void take_property(std::string_view line) {
    if (!in_vertices_) return;
    const std::string_view type_name = take_word(line), name = take_word(line);
    const auto type = type_of(type_name);
    if (!type)
      fail_here("the vertices have a property of type " + quote(type_name),
                "save them with single numbers only");
    if (!record_.add(name, *type, 1)) fail_here("the property " + quote(name) + " comes twice", "leave one");
  }

  const std::filesystem::path& file_;
  Lines& lines_;
  std::string_view format_;
  std::optional<std::uint64_t> vertices_;
  bool in_vertices_ = false;
  PointRecord record_;
};

}  // namespace

std::vector<Eigen::Vector3f> parse_ply(const std::filesystem::path& file, std::string_view bytes) {
  Lines lines(bytes);
  const Header header(file, lines);
  if (header.ascii()) return read_ascii_points(file, lines, header.vertices(), header.record());
  return read_binary_points(file, bytes, lines.offset(), header.vertices(), header.record());
}

}  // namespace frontlux::planner::detail
