#pragma once

#include <string_view>

namespace frontlux::report::detail {

/// The page as web/build.mjs makes it, with two marks where a report's own parts go.
[[nodiscard]] std::string_view page();

inline constexpr std::string_view kTitleMark = "@@frontlux-title@@";
inline constexpr std::string_view kRunsMark = "@@frontlux-runs@@";

}  // namespace frontlux::report::detail
