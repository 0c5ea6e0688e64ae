#pragma once

#include <cstddef>
#include <string>

namespace frontlux::bench {

/// One number by a pattern of printf.
[[nodiscard]] std::string cell(const char* pattern, double value);

/// To the right in a column of this width.
[[nodiscard]] std::string pad(const std::string& text, std::size_t width);

/// In the middle of a column of this width.
[[nodiscard]] std::string centered(const std::string& text, std::size_t width);

/// Three digits, however large.
[[nodiscard]] std::string digits(double value);

/// Shares close to one are told from one.
[[nodiscard]] std::string percent(double share);

/// "1 thread", "2 threads"
[[nodiscard]] std::string words(int threads);

}  // namespace frontlux::bench
