#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace frontlux::planner::detail {

/// The number that the text is, from end to end; nan and inf are numbers. In every locale the same.
[[nodiscard]] std::optional<double> to_number(std::string_view text);
[[nodiscard]] std::optional<std::uint64_t> to_count(std::string_view text);

/// Infinite if it is too large for a float.
[[nodiscard]] float to_float(double number);

/// A number of little-endian bytes.
template <class Number>
[[nodiscard]] Number from_little_endian(const char* bytes) {
  static_assert(std::endian::native == std::endian::little, "swap the bytes here for another machine");
  static_assert(std::is_arithmetic_v<Number>);
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

/// Takes a file's text line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  /// The next line without its end (\n or \r\n); nothing after the last.
  [[nodiscard]] std::optional<std::string_view> next();
  /// Of the line taken last, from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Where the next line begins [bytes].
  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  std::string_view text_;
  std::size_t number_ = 0, offset_ = 0;
};

/// Takes the next word off a line; empty if there is none. Blanks and tabs are between words.
[[nodiscard]] std::string_view take_word(std::string_view& line);

}  // namespace frontlux::planner::detail
