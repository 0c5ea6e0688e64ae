#pragma once

#include <string>
#include <string_view>

namespace frontlux::report::detail {

/// Bytes in zlib's format (RFC 1950), which browsers read by themselves.
/// @throws std::runtime_error if there is not the memory for it
[[nodiscard]] std::string compressed(std::string_view bytes);

/// Letters, digits, + and /, four for each three bytes; = fills up the end.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace frontlux::report::detail
