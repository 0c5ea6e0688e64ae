#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace frontlux {

/// @throws std::runtime_error "file: what; advice"
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, const std::string& advice);

inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30;

/// The bytes of a file.
/// @throws std::runtime_error naming the file and what to do, unless it is a regular file that can be read
/// and
///         has at most `max_bytes`
[[nodiscard]] std::string read_file(const std::filesystem::path& file,
                                    std::uint64_t max_bytes = kMaxFileBytes);

/// Writes a file complete or not at all: into a file beside it first, which then takes its name.
/// @param write  writes the bytes
/// @throws std::runtime_error naming the file and what to do, and what `write` throws
void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

/// The ending of a file's name in lower case, with its dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& file);

/// A piece of a file that may be shown on a terminal: in quotes, printable, not too long.
[[nodiscard]] std::string quote(std::string_view text);

}  // namespace frontlux
