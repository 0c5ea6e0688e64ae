#pragma once

#include <string>

namespace frontlux::app {

/// The greatest of 1, 2 and 5 times a power of ten that is at most this, for scale bars and axes.
/// @pre above 0
[[nodiscard]] double round_length(double most);

/// Three significant digits, or a whole number from 1000 on.
[[nodiscard]] std::string short_number(double number);

}  // namespace frontlux::app
