#include "parsing.hpp"

#include <frontlux/io/ply.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace frontlux::io {
namespace {

constexpr const char* kGetAnotherCopy = "the file is damaged or incomplete: get another copy of it";
constexpr const char* kCheckFormat = "check that this is a PLY file of version 1.0";

struct Property {
  std::string_view name;
  NumberType type;
  std::optional<NumberType> length;  // of a list
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

std::optional<NumberType> type_of(std::string_view name) {
  if (name == "char" || name == "int8") return kNumberType<std::int8_t>;
  if (name == "uchar" || name == "uint8") return kNumberType<std::uint8_t>;
  if (name == "short" || name == "int16") return kNumberType<std::int16_t>;
  if (name == "ushort" || name == "uint16") return kNumberType<std::uint16_t>;
  if (name == "int" || name == "int32") return kNumberType<std::int32_t>;
  if (name == "uint" || name == "uint32") return kNumberType<std::uint32_t>;
  if (name == "float" || name == "float32") return kNumberType<float>;
  if (name == "double" || name == "float64") return kNumberType<double>;
  return std::nullopt;
}

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes), lines_(bytes) {}

  RawMesh read() {
    read_header();
    at_ = lines_.offset();
    RawMesh mesh;
    for (const Element& element : elements_) read_element(element, mesh);
    return mesh;
  }

 private:
  [[noreturn]] void fail_here(const std::string& what, const std::string& advice) const {
    if (in_header_ || ascii_) fail(file_, "line " + std::to_string(lines_.number()) + ": " + what, advice);
    fail(file_, what + " (byte " + std::to_string(at_) + ")", advice);
  }

  void read_header() {
    bool has_format = false;
    while (true) {
      const auto line = lines_.next();
      if (!line) fail(file_, "ends before its header does", "a PLY header ends with a line of end_header");
      const auto words = words_of(*line);
      const std::string_view first = words.empty() ? std::string_view() : words[0];
      if (lines_.number() == 1) {
        if (words.size() != 1 || first != "ply")
          fail_here("does not begin with the line 'ply'", kCheckFormat);
      } else if (first == "format") {
        take_format(words);
        has_format = true;
      } else if (first == "element") {
        take_element(words);
      } else if (first == "property") {
        take_property(words);
      } else if (first == "end_header") {
        break;
      } else if (!first.empty() && first != "comment" && first != "obj_info") {
        fail_here(quote(first) + " belongs into no PLY header", kCheckFormat);
      }
    }
    if (!has_format) fail_here("there is no line of the format above", kCheckFormat);
    check_vertices();
    in_header_ = false;
  }

  void take_format(const std::vector<std::string_view>& words) {
    const std::string_view format = words.size() == 3 && words[2] == "1.0" ? words[1] : std::string_view();
    ascii_ = format == "ascii";
    if (!ascii_ && format != "binary_little_endian" && format != "binary_big_endian")
      fail_here("the format is " + quote(words.size() > 1 ? words[1] : format) + " or of an unknown version",
                "save the file as ascii, binary_little_endian or binary_big_endian 1.0");
    order_ = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  }

  void take_element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? to_count(words[2]) : std::nullopt;
    if (!count) fail_here("the element does not have a name and a number", "say how many there are");
    if (std::ranges::any_of(elements_, [&](const Element& other) { return other.name == words[1]; }))
      fail_here("there is a second element " + quote(words[1]), "leave one");
    check_number(elements_.size(), "elements");
    elements_.push_back({words[1], *count, {}});
  }

  void take_property(const std::vector<std::string_view>& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (elements_.empty() || (!list && words.size() != 3))
      fail_here("the property is not of the form 'property TYPE NAME' or 'property list TYPE TYPE NAME'",
                kCheckFormat);
    const auto known_type = [&](std::string_view name) {
      const auto type = type_of(name);
      if (!type) fail_here("the property is of the unknown type " + quote(name), "save it as a number");
      return *type;
    };
    auto& properties = elements_.back().properties;
    if (std::ranges::any_of(properties, [&](const Property& other) { return other.name == words.back(); }))
      fail_here("the property " + quote(words.back()) + " comes twice", "leave one");
    check_number(properties.size(), "properties");
    properties.push_back({words.back(), known_type(words[words.size() - 2]), std::nullopt});
    if (list) properties.back().length = known_type(words[2]);
  }

  // Of what each one more is compared with.
  void check_number(std::size_t there, const char* what) const {
    constexpr std::size_t kMost = 1000;
    if (there >= kMost)
      fail_here("there are more than " + std::to_string(kMost) + " " + what, "leave out what is not needed");
  }

  void check_vertices() const {
    const auto vertex = std::ranges::find(elements_, "vertex", &Element::name);
    if (vertex == elements_.end()) fail_here("there is no element 'vertex' above", "save the file with one");
    for (const char* axis : {"x", "y", "z"})
      if (std::ranges::none_of(vertex->properties,
                               [&](const Property& p) { return p.name == axis && !p.length; }))
        fail_here("the vertices have no " + std::string(axis), "save the file with x, y and z");
  }

  void read_element(const Element& element, RawMesh& mesh) {
    // Each row takes at least so many bytes, so no count can ask for more than the file holds.
    std::size_t least = 0;
    for (const Property& property : element.properties)
      least += ascii_ ? 1 : property.length.value_or(property.type).bytes;
    if (least == 0 ? element.count > 0 : element.count > left() / least)
      fail_here("announces " + std::to_string(element.count) + " of the element " + quote(element.name) +
                    ", but only " + std::to_string(left()) + " bytes follow",
                kGetAnotherCopy);
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    std::vector<std::uint64_t> polygon;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      begin_row();
      Eigen::Vector3d vertex;
      for (const Property& property : element.properties) {
        if (property.length) {
          const bool corners =
              faces && (property.name == "vertex_indices" || property.name == "vertex_index");
          read_list(property, corners ? &polygon : nullptr);
          if (corners) add_fan(polygon, mesh);
          continue;
        }
        const double value = next(property.type);
        if (vertices && property.name.size() == 1 && property.name >= "x" && property.name <= "z")
          vertex[property.name[0] - 'x'] = value;
      }
      end_row();
      if (vertices) mesh.vertices.push_back(vertex);
    }
  }

  void read_list(const Property& property, std::vector<std::uint64_t>* indices) {
    const std::uint64_t length = whole(next(*property.length));
    if (length > left() / (ascii_ ? 1 : property.type.bytes))
      fail_here("announces a list of " + std::to_string(length) + ", but only " + std::to_string(left()) +
                    " bytes follow",
                kGetAnotherCopy);
    if (indices != nullptr) indices->clear();
    for (std::uint64_t i = 0; i < length; ++i) {
      const double value = next(property.type);
      if (indices != nullptr) indices->push_back(whole(value));
    }
  }

  void add_fan(const std::vector<std::uint64_t>& polygon, RawMesh& mesh) const {
    constexpr std::size_t kMost = std::size_t{1} << 28U;
    if (mesh.triangles.size() + polygon.size() > kMost)
      fail_here("holds more than " + std::to_string(kMost) + " triangles", "simplify the mesh");
    for (std::size_t i = 2; i < polygon.size(); ++i)
      mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }

  [[nodiscard]] std::uint64_t whole(double value) const {
    if (!(value >= 0.0 && value < 0x1p53) || value != std::floor(value))
      fail_here("an index or a length is not a whole number from 0 on", kGetAnotherCopy);
    return static_cast<std::uint64_t>(value);
  }

  // Of text a row is a line.
  void begin_row() {
    while (ascii_) {
      const auto line = lines_.next();
      if (!line) fail_here("the file ends too early", kGetAnotherCopy);
      row_ = *line;
      at_ = lines_.offset();
      if (row_.find_first_not_of(" \t") != std::string_view::npos) return;
    }
  }
  void end_row() {
    if (ascii_ && !take_word(row_).empty())
      fail_here("has more numbers than the header says",
                "write a line for each element, with its properties");
  }

  double next(const NumberType& type) {
    if (ascii_) {
      const std::string_view word = take_word(row_);
      if (word.empty())
        fail_here("has fewer numbers than the header says",
                  "write a line for each element, with its properties");
      const auto number = to_number(word);
      if (!number) fail_here(quote(word) + " is no number", "write a number, or nan if there is none");
      return *number;
    }
    if (left() < type.bytes) fail_here("the file ends too early", kGetAnotherCopy);
    const char* bytes = bytes_.data() + at_;
    at_ += type.bytes;
    return type.read(bytes, order_);
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_ + row_.size(); }

  const std::filesystem::path& file_;
  std::string_view bytes_, row_;
  Lines lines_;
  std::vector<Element> elements_;
  std::size_t at_ = 0;
  bool ascii_ = false, in_header_ = true;
  std::endian order_ = std::endian::little;
};

}  // namespace

RawMesh read_ply(const std::filesystem::path& file, std::uint64_t max_bytes) {
  const std::string bytes = read_file(file, max_bytes);
  return PlyReader(file, bytes).read();
}

}  // namespace frontlux::io
