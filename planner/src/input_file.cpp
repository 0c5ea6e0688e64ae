#include "input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>

namespace frontlux::planner::detail {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 30;

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars knows no plus
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

void fail(const std::filesystem::path& file, const std::string& what, const std::string& advice) {
  throw std::runtime_error((file.empty() ? "''" : file.string()) + ": " + what + "; " + advice);
}

std::string read_input_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    fail(file, "there is no such file", "check the path");
  if (error) fail(file, "cannot be looked at: " + error.message(), "check the path and its permissions");
  if (!std::filesystem::is_regular_file(status)) fail(file, "is not a regular file", "name a file");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    fail(file, "cannot be opened: " + std::generic_category().message(errno), "check its permissions");
  const auto size = std::filesystem::file_size(file, error);
  if (error) fail(file, "has no size: " + error.message(), "check the path and its permissions");
  if (size > kMaxBytes)
    fail(file,
         "has " + std::to_string(size) + " bytes, more than the " + std::to_string(kMaxBytes) +
             " that can be read",
         "split it");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size)
    fail(file, "gave " + std::to_string(stream.gcount()) + " of its " + std::to_string(size) + " bytes",
         "try again when nothing writes to it");
  return bytes;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  if (text.size() > kShown) shown += "...";
  return shown + "'";
}

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

}  // namespace frontlux::planner::detail
