#include "json_text.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace frontlux::report::detail {

void JsonText::separate() {
  if (text_.empty()) return;
  const char last = text_.back();
  if (last != '{' && last != '[' && last != ':') text_ += ',';
}

JsonText& JsonText::open(char bracket) {
  separate();
  text_ += bracket;
  return *this;
}

JsonText& JsonText::close(char bracket) {
  text_ += bracket;
  return *this;
}

JsonText& JsonText::name(std::string_view name) {
  text(name);
  text_ += ':';
  return *this;
}

JsonText& JsonText::text(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  separate();
  text_ += '"';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20)
      ((text_ += "\\u00") += kHex[byte >> 4U]) += kHex[byte & 15U];
    else if (c == '"' || c == '\\')
      (text_ += '\\') += c;
    else
      text_ += c;
  }
  text_ += '"';
  return *this;
}

JsonText& JsonText::number(double number) {
  if (!std::isfinite(number)) return null();
  separate();
  std::array<char, 32> buffer{};
  text_.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr);
  return *this;
}

JsonText& JsonText::number(std::uint64_t number) {
  separate();
  text_ += std::to_string(number);
  return *this;
}

JsonText& JsonText::yes(bool yes) {
  separate();
  text_ += yes ? "true" : "false";
  return *this;
}

JsonText& JsonText::null() {
  separate();
  text_ += "null";
  return *this;
}

}  // namespace frontlux::report::detail
