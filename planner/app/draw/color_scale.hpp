#pragma once

#include "draw/canvas.hpp"

namespace frontlux::app {

/// A colour for a share from 0 (dark violet) over 0.5 (teal) to 1 (light yellow). Lightness grows evenly as
/// eyes judge it, so that equal steps look equal, and shows the order alone to those who do not tell hues
/// apart. Shares outside are cut off; NaN is 0.
[[nodiscard]] Color color_of_share(double share);

}  // namespace frontlux::app
