#pragma once

#include <frontlux/export.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace frontlux {

/// @throws std::runtime_error "file: what; advice"
[[noreturn]] FRONTLUX_EXPORT void fail(const std::filesystem::path& file, const std::string& what,
                                       const std::string& advice);

inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30;

/// The bytes of a file.
/// @throws std::runtime_error naming the file and what to do, unless it is a regular file that can be read
/// and
///         has at most `max_bytes`
[[nodiscard]] FRONTLUX_EXPORT std::string read_file(const std::filesystem::path& file,
                                                    std::uint64_t max_bytes = kMaxFileBytes);

/// Removes what processes that were killed while they wrote this file have left beside it. What is being
/// written is locked (flock), here and in other containers; a file system without locks keeps what is left.
FRONTLUX_EXPORT void remove_unfinished(const std::filesystem::path& file);

/// Removes what this process has begun to write and not ended, for the handler of a signal that ends the
/// process at once: calls only what a handler may call. Threads that are writing never return.
FRONTLUX_EXPORT void remove_own_unfinished() noexcept;

/// Writes a file complete or not at all: one beside it takes its name. It replaces regular files only, and
/// links to them, not what those lead to.
/// @param write  writes the bytes
/// @throws std::runtime_error naming the file and what to do, and what `write` throws
FRONTLUX_EXPORT void write_file(const std::filesystem::path& file,
                                const std::function<void(std::ostream&)>& write);
FRONTLUX_EXPORT void write_file(const std::filesystem::path& file, std::string_view bytes);

/// Appends a number to binary data: lowest byte first, on every machine.
template <std::unsigned_integral Number>
void append_number(std::string& bytes, Number number) {
  for (unsigned shift = 0; shift < 8 * sizeof(Number); shift += 8)
    bytes += static_cast<char>((number >> shift) & 0xFFU);
}

/// A number of `sizeof(Number)` bytes, in this order.
template <class Number>
[[nodiscard]] Number from_bytes(const char* bytes, std::endian order) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

/// The ending of a file's name in lower case, with its dot.
[[nodiscard]] FRONTLUX_EXPORT std::string lower_extension(const std::filesystem::path& file);

/// The number that a text is, from end to end and in every locale; nan and inf are numbers, +1 is none.
template <class Number>
[[nodiscard]] std::optional<Number> number_from(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// The shortest decimals that read back as the same number, in every locale.
template <class Number>
[[nodiscard]] std::string decimals_of(Number number) {
  std::array<char, 64> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

/// A piece of a file that may be shown on a terminal: in quotes, printable, not too long.
[[nodiscard]] FRONTLUX_EXPORT std::string quote(std::string_view text);

}  // namespace frontlux
