#include "draw/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::app {
namespace {

constexpr int kMaxEdge = 32768, kDot = 2, kLetterStep = 6 * kDot;  // [px]

// Seven rows of five dots, the leftmost in bit 4. Small letters look like capitals, unknown signs like a box.
// clang-format off
std::array<unsigned, 7> glyph_of(char letter) {
  if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  switch (letter) {
    case ' ': return {};
    case 'A': return {0x0E, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11};
    case 'B': return {0x1E, 0x11, 0x11, 0x1E, 0x11, 0x11, 0x1E};
    case 'C': return {0x0E, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0E};
    case 'D': return {0x1E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1E};
    case 'E': return {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x1F};
    case 'F': return {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x10};
    case 'G': return {0x0E, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0F};
    case 'H': return {0x11, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11};
    case 'I': return {0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E};
    case 'J': return {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0C};
    case 'K': return {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11};
    case 'L': return {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F};
    case 'M': return {0x11, 0x1B, 0x15, 0x15, 0x11, 0x11, 0x11};
    case 'N': return {0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11};
    case 'O': return {0x0E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E};
    case 'P': return {0x1E, 0x11, 0x11, 0x1E, 0x10, 0x10, 0x10};
    case 'Q': return {0x0E, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0D};
    case 'R': return {0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11};
    case 'S': return {0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E};
    case 'T': return {0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04};
    case 'U': return {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E};
    case 'V': return {0x11, 0x11, 0x11, 0x11, 0x11, 0x0A, 0x04};
    case 'W': return {0x11, 0x11, 0x11, 0x15, 0x15, 0x1B, 0x11};
    case 'X': return {0x11, 0x11, 0x0A, 0x04, 0x0A, 0x11, 0x11};
    case 'Y': return {0x11, 0x11, 0x0A, 0x04, 0x04, 0x04, 0x04};
    case 'Z': return {0x1F, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1F};
    case '0': return {0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E};
    case '1': return {0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E};
    case '2': return {0x0E, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1F};
    case '3': return {0x1E, 0x01, 0x01, 0x0E, 0x01, 0x01, 0x1E};
    case '4': return {0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02};
    case '5': return {0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E};
    case '6': return {0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E};
    case '7': return {0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08};
    case '8': return {0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E};
    case '9': return {0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C};
    case '.': return {0x00, 0x00, 0x00, 0x00, 0x00, 0x0C, 0x0C};
    case ',': return {0x00, 0x00, 0x00, 0x00, 0x06, 0x04, 0x08};
    case '-': return {0x00, 0x00, 0x00, 0x1F, 0x00, 0x00, 0x00};
    case '+': return {0x00, 0x04, 0x04, 0x1F, 0x04, 0x04, 0x00};
    case ':': return {0x00, 0x0C, 0x0C, 0x00, 0x0C, 0x0C, 0x00};
    case '/': return {0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10};
    case '(': return {0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02};
    case ')': return {0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08};
    case '_': return {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1F};
    case '=': return {0x00, 0x00, 0x1F, 0x00, 0x1F, 0x00, 0x00};
    case '%': return {0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03};
    default: return {0x1F, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1F};
  }
}
// clang-format on

// How much of a pixel a shape covers whose edge is this far inside of the pixel's middle [px].
double coverage(double inside) { return std::clamp(inside + 0.5, 0.0, 1.0); }

}  // namespace

Canvas::Canvas(int width, int height, Color background) : width_(width), height_(height) {
  if (width < 1 || height < 1 || width > kMaxEdge || height > kMaxEdge)
    throw std::invalid_argument("canvas: " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels, but each edge has to be 1 to " + std::to_string(kMaxEdge));
  bytes_.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  fill(0, 0, width, height, background);
}

Color Canvas::at(int x, int y) const {
  const std::uint8_t* const bytes = &bytes_[place(x, y)];
  return {bytes[0], bytes[1], bytes[2]};
}

void Canvas::set(int x, int y, Color color, double opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0.0) return;
  const auto blend = [&](std::uint8_t& there, std::uint8_t wanted) {
    there = static_cast<std::uint8_t>(std::lround(there + (wanted - there) * std::min(opacity, 1.0)));
  };
  std::uint8_t* const bytes = &bytes_[place(x, y)];
  blend(bytes[0], color.red);
  blend(bytes[1], color.green);
  blend(bytes[2], color.blue);
}

void Canvas::fill(int x, int y, int width, int height, Color color) {
  for (int row = std::max(y, 0); row < std::min(y + height, height_); ++row)
    for (int column = std::max(x, 0); column < std::min(x + width, width_); ++column) set(column, row, color);
}

void Canvas::frame(int x, int y, int width, int height, int thickness, Color color) {
  fill(x, y, width, thickness, color);
  fill(x, y + height - thickness, width, thickness, color);
  fill(x, y, thickness, height, color);
  fill(x + width - thickness, y, thickness, height, color);
}

void Canvas::disc(double x, double y, double radius, Color color) { ring(x, y, radius / 2, radius, color); }

void Canvas::ring(double x, double y, double radius, double thickness, Color color) {
  const double reach = radius + thickness / 2 + 1;
  for (int row = static_cast<int>(y - reach); row <= static_cast<int>(y + reach) + 1; ++row)
    for (int column = static_cast<int>(x - reach); column <= static_cast<int>(x + reach) + 1; ++column) {
      const double from_middle = std::hypot(column + 0.5 - x, row + 0.5 - y);
      set(column, row, color, coverage(thickness / 2 - std::fabs(from_middle - radius)));
    }
}

void Canvas::line(double x0, double y0, double x1, double y1, double thickness, Color color) {
  const double dx = x1 - x0, dy = y1 - y0, squared = dx * dx + dy * dy, reach = thickness / 2 + 1;
  for (int row = static_cast<int>(std::min(y0, y1) - reach); row <= std::max(y0, y1) + reach; ++row)
    for (int column = static_cast<int>(std::min(x0, x1) - reach); column <= std::max(x0, x1) + reach;
         ++column) {
      const double x = column + 0.5 - x0, y = row + 0.5 - y0;
      const double along = squared == 0.0 ? 0.0 : std::clamp((x * dx + y * dy) / squared, 0.0, 1.0);
      set(column, row, color, coverage(thickness / 2 - std::hypot(x - along * dx, y - along * dy)));
    }
}

void Canvas::text(int x, int y, std::string_view text, Color color) {
  for (const char letter : text) {
    int top = y;
    for (const unsigned row : glyph_of(letter)) {
      for (int column = 0; column < 5; ++column)
        if ((row >> (4 - column) & 1U) != 0) fill(x + column * kDot, top, kDot, kDot, color);
      top += kDot;
    }
    x += kLetterStep;
  }
}

int Canvas::text_width(std::string_view text) {
  return text.empty() ? 0 : static_cast<int>(text.size()) * kLetterStep - kDot;
}

}  // namespace frontlux::app
