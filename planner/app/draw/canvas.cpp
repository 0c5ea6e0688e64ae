#include "draw/canvas.hpp"

#include "draw/bitmap_font.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::app {
namespace {

constexpr int kMaxEdge = 32768, kLetterStep = 6;

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
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
  return {bytes_[i], bytes_[i + 1], bytes_[i + 2]};
}

void Canvas::set(int x, int y, Color color, double opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0.0) return;
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
  const auto blend = [&](std::uint8_t& there, std::uint8_t wanted) {
    there = static_cast<std::uint8_t>(std::lround(there + (wanted - there) * std::min(opacity, 1.0)));
  };
  blend(bytes_[i], color.red);
  blend(bytes_[i + 1], color.green);
  blend(bytes_[i + 2], color.blue);
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

void Canvas::text(int x, int y, std::string_view text, int scale, Color color) {
  for (const char letter : text) {
    const Glyph glyph = glyph_of(letter);
    for (int row = 0; row < kTextHeight; ++row)
      for (int column = 0; column < 5; ++column)
        if ((glyph[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0)
          fill(x + column * scale, y + row * scale, scale, scale, color);
    x += kLetterStep * scale;
  }
}

int Canvas::text_width(std::string_view text, int scale) {
  return text.empty() ? 0 : (static_cast<int>(text.size()) * kLetterStep - 1) * scale;
}

}  // namespace frontlux::app
