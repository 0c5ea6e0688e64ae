#pragma once

#include <array>
#include <cstdint>

namespace frontlux::app {

/// Seven rows of five dots, the leftmost in bit 4.
using Glyph = std::array<std::uint8_t, 7>;

/// Small letters look like capitals, unknown signs like a box.
[[nodiscard]] Glyph glyph_of(char letter);

}  // namespace frontlux::app
