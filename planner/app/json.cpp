#include "json.hpp"

#include "text.hpp"

#include <array>
#include <cstddef>

namespace frontlux::app {
namespace {

// Length of the UTF-8 sequence at the front of `text`, 0 if it is none. File names are bytes, JSON is
// Unicode.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const unsigned char second = byte(1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool surrogate = first == 0xED && second >= 0xA0;
  const bool too_large = first == 0xF4 && second >= 0x90;
  return overlong || surrogate || too_large ? 0 : length;
}

std::string json_string(std::string_view text) {
  constexpr std::array kHex = {'0', '1', '2', '3', '4', '5', '6', '7',
                               '8', '9', 'a', 'b', 'c', 'd', 'e', 'f'};
  std::string out = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const auto c = static_cast<unsigned char>(text.front());
    if (length == 0)
      out += "\\ufffd";
    else if (c == '"' || c == '\\')
      (out += '\\') += text.front();
    else if (c < 0x20)
      ((out += "\\u00") += kHex[c >> 4U]) += kHex[c & 15U];
    else
      out.append(text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out + '"';
}

std::string bracketed(std::string_view text) {
  std::string out = "[";
  return out.append(text) += ']';
}

}  // namespace

JsonObject& JsonObject::add_raw(std::string_view name, std::string_view value) {
  if (!members_.empty()) members_ += ", ";
  members_.append("\"").append(name).append("\": ").append(value);
  return *this;
}

JsonObject& JsonObject::add(std::string_view name, std::string_view text) {
  return add_raw(name, json_string(text));
}
JsonObject& JsonObject::add(std::string_view name, double number) { return add_raw(name, to_text(number)); }
JsonObject& JsonObject::add(std::string_view name, float number) { return add_raw(name, to_text(number)); }
JsonObject& JsonObject::add(std::string_view name, std::uint64_t number) {
  return add_raw(name, std::to_string(number));
}
JsonObject& JsonObject::add(std::string_view name, bool yes) { return add_raw(name, yes ? "true" : "false"); }
JsonObject& JsonObject::add(std::string_view name, const VoxelKey& key) {
  return add_raw(name, bracketed(to_text(key)));
}
JsonObject& JsonObject::add(std::string_view name, const Eigen::Vector3f& point) {
  return add_raw(name, bracketed(to_text(point)));
}
JsonObject& JsonObject::add(std::string_view name, const Eigen::Vector3d& point) {
  return add_raw(name, bracketed(to_text(point.x()) + ", " + to_text(point.y()) + ", " + to_text(point.z())));
}
JsonObject& JsonObject::add(std::string_view name, const JsonObject& object) {
  return add_raw(name, object.text());
}
JsonObject& JsonObject::add(std::string_view name, std::span<const std::string> texts) {
  std::string list;
  for (const std::string& text : texts) list.append(list.empty() ? "" : ", ").append(json_string(text));
  return add_raw(name, bracketed(list));
}
JsonObject& JsonObject::add_null(std::string_view name) { return add_raw(name, "null"); }

}  // namespace frontlux::app
