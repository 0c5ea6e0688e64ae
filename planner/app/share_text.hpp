#pragma once

#include <string>

namespace frontlux::app {

/// A share from 0 to 1 for people: "97.2 %". Of what is not all, never "100 %".
/// @param digits after the point
[[nodiscard]] std::string share_text(double share, int digits);

}  // namespace frontlux::app
