#include "mesh/raw_mesh.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

namespace frontlux::sim {
namespace {

enum class Format { kAscii, kLittle, kBig };

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

Type type_of(std::string_view name) {
  constexpr std::array<std::string_view, 8> kShort = {"char", "uchar", "short", "ushort",
                                                      "int",  "uint",  "float", "double"};
  constexpr std::array<std::string_view, 8> kLong = {"int8",  "uint8",  "int16",   "uint16",
                                                     "int32", "uint32", "float32", "float64"};
  for (std::size_t i = 0; i < kShort.size(); ++i)
    if (name == kShort[i] || name == kLong[i]) return static_cast<Type>(i);
  throw MeshFault("unknown type '" + std::string(name.substr(0, 40)) + "' in the PLY header");
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  std::vector<std::string_view> words;
  for (auto at = line.find_first_not_of(kBlank); at != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlank, end);
  }
  return words;
}

// The values of the body, one after the other.
class Body {
 public:
  Body(std::string_view bytes, std::size_t at, Format format) : bytes_(bytes), at_(at), format_(format) {}

  double next(Type type) { return format_ == Format::kAscii ? next_word() : next_binary(type); }

  // No more values than this can follow.
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw MeshFault(what + " at byte " + std::to_string(at_));
  }

 private:
  double next_word() {
    constexpr std::string_view kBlank = " \t\r\n";
    at_ = std::min(bytes_.find_first_not_of(kBlank, at_), bytes_.size());
    std::string_view word =
        bytes_.substr(at_, std::min(bytes_.find_first_of(kBlank, at_), bytes_.size()) - at_);
    if (word.empty()) fail("the file ends too early");
    if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      fail(quote(word) + " is not a number");
    at_ = static_cast<std::size_t>(end - bytes_.data());
    return value;
  }

  template <class Value>
  double as(std::array<char, 8>& raw) {
    if ((format_ == Format::kBig) != (std::endian::native == std::endian::big))
      std::reverse(raw.begin(), raw.begin() + sizeof(Value));
    Value value;
    std::memcpy(&value, raw.data(), sizeof(Value));
    return static_cast<double>(value);
  }

  double next_binary(Type type) {
    const std::size_t size = size_of(type);
    if (left() < size) fail("the file ends too early");
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, size);
    at_ += size;
    switch (type) {
      case Type::kInt8:
        return as<std::int8_t>(raw);
      case Type::kUint8:
        return as<std::uint8_t>(raw);
      case Type::kInt16:
        return as<std::int16_t>(raw);
      case Type::kUint16:
        return as<std::uint16_t>(raw);
      case Type::kInt32:
        return as<std::int32_t>(raw);
      case Type::kUint32:
        return as<std::uint32_t>(raw);
      case Type::kFloat:
        return as<float>(raw);
      case Type::kDouble:
        break;
    }
    return as<double>(raw);
  }

  std::string_view bytes_;
  std::size_t at_;
  Format format_;
};

struct Header {
  Format format = Format::kAscii;
  std::vector<Element> elements;
  std::size_t end = 0;  // where the body begins
};

Format format_of(const std::vector<std::string_view>& words) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return Format::kAscii;
    if (words[1] == "binary_little_endian") return Format::kLittle;
    if (words[1] == "binary_big_endian") return Format::kBig;
  }
  throw MeshFault(
      "the PLY header names no format that is known: ascii, binary_little_endian, binary_big_endian");
}

void add_property(const std::vector<std::string_view>& words, std::vector<Element>& elements) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (elements.empty() || (!list && words.size() != 3))
    throw MeshFault("a property in the PLY header is malformed");
  Property property{std::string(words.back()), type_of(words[words.size() - 2]), std::nullopt};
  if (list) property.count = type_of(words[2]);
  elements.back().properties.push_back(std::move(property));
}

Header parse_header(std::string_view bytes) {
  Header header;
  bool has_format = false;
  for (std::size_t at = 0, line_number = 1;; ++line_number) {
    const auto end = bytes.find('\n', at);
    if (end == std::string_view::npos) throw MeshFault("the PLY header does not end with 'end_header'");
    const auto words = words_of(bytes.substr(at, end - at));
    at = end + 1;
    const std::string_view first = words.empty() ? std::string_view() : words[0];
    if (line_number == 1) {
      if (words.size() != 1 || first != "ply") throw MeshFault("the file does not begin with 'ply'");
    } else if (first == "format") {
      header.format = format_of(words);
      has_format = true;
    } else if (first == "element") {
      std::uint64_t count = 0;
      const std::string_view number = words.size() == 3 ? words[2] : std::string_view();
      const auto [last, error] = std::from_chars(number.data(), number.data() + number.size(), count);
      if (number.empty() || error != std::errc{} || last != number.data() + number.size())
        throw MeshFault("an element in the PLY header is malformed");
      header.elements.push_back({std::string(words[1]), count, {}});
    } else if (first == "property") {
      add_property(words, header.elements);
    } else if (first == "end_header") {
      if (!has_format) throw MeshFault("the PLY header names no format");
      header.end = at;
      return header;
    } else if (!first.empty() && first != "comment" && first != "obj_info") {
      throw MeshFault("unknown word '" + std::string(first.substr(0, 40)) + "' in the PLY header");
    }
  }
}

std::uint64_t whole(const Body& body, double value) {
  if (!(value >= 0.0 && value < 0x1p53) || value != std::floor(value))
    body.fail("a negative or broken index or count");
  return static_cast<std::uint64_t>(value);
}

void read_element(const Element& element, Body& body, RawMesh& mesh) {
  // Each of its values takes a byte at least, so that no count can ask for more than the file's size.
  if (element.properties.empty() ? element.count > 0 : element.count > body.left())
    body.fail("the file ends too early for " + std::to_string(element.count) + " of '" + element.name + "'");
  const bool vertices = element.name == "vertex", faces = element.name == "face";
  std::vector<std::uint64_t> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    for (const auto& property : element.properties) {
      if (!property.count) {
        const double value = body.next(property.type);
        if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
          vertex[property.name[0] - 'x'] = value;
        continue;
      }
      const std::uint64_t length = whole(body, body.next(*property.count));
      if (length > body.left()) body.fail("the file ends too early for a list of " + std::to_string(length));
      const bool corners = faces && (property.name == "vertex_indices" || property.name == "vertex_index");
      polygon.clear();
      for (std::uint64_t j = 0; j < length; ++j) {
        const double value = body.next(property.type);
        if (corners) polygon.push_back(whole(body, value));
      }
      for (std::size_t j = 2; j < polygon.size(); ++j)
        mesh.triangles.push_back({polygon[0], polygon[j - 1], polygon[j]});
    }
    if (vertices) mesh.vertices.push_back(vertex);
  }
}

}  // namespace

RawMesh parse_ply(const std::string& bytes) {
  const Header header = parse_header(bytes);
  for (const auto& element : header.elements) {
    if (element.name != "vertex") continue;
    for (const std::string_view axis : {"x", "y", "z"})
      if (std::none_of(element.properties.begin(), element.properties.end(),
                       [&](const Property& property) { return property.name == axis && !property.count; }))
        throw MeshFault("the PLY file's vertices have no " + std::string(axis));
  }
  Body body(bytes, header.end, header.format);
  RawMesh mesh;
  for (const auto& element : header.elements) read_element(element, body, mesh);
  return mesh;
}

}  // namespace frontlux::sim
