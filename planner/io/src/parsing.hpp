#pragma once

#include <frontlux/file.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace frontlux::io {

/// The number that the text is, from end to end; nan and inf are numbers. In every locale the same.
[[nodiscard]] std::optional<double> to_number(std::string_view text);
[[nodiscard]] std::optional<std::uint64_t> to_count(std::string_view text);

/// Infinite if it is too large for a float.
[[nodiscard]] float to_float(double number);

/// How a number is stored in a binary file.
struct NumberType {
  std::size_t bytes;
  double (*read)(const char* bytes, std::endian order);
};
template <class Number>
inline constexpr NumberType kNumberType{sizeof(Number), [](const char* bytes, std::endian order) {
                                          return static_cast<double>(from_bytes<Number>(bytes, order));
                                        }};

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

/// All words of a line.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

}  // namespace frontlux::io
