#include "parsing.hpp"

#include <cmath>
#include <limits>

namespace frontlux::io {
namespace {

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars knows no plus
  return number_from<Number>(text);
}

}  // namespace

std::optional<double> to_number(std::string_view text) { return parsed<double>(text); }

std::optional<std::uint64_t> to_count(std::string_view text) { return parsed<std::uint64_t>(text); }

float to_float(double number) {
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<float>::max());
  if (std::fabs(number) > kLargest)
    return std::copysign(std::numeric_limits<float>::infinity(), number < 0 ? -1.0F : 1.0F);
  return static_cast<float>(number);
}

std::optional<std::string_view> Lines::next() {
  if (offset_ >= text_.size()) return std::nullopt;
  const std::size_t end = std::min(text_.find('\n', offset_), text_.size());
  std::string_view line = text_.substr(offset_, end - offset_);
  offset_ = std::min(end + 1, text_.size());
  ++number_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

}  // namespace frontlux::io
