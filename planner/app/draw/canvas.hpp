#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace frontlux::app {

/// sRGB.
struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// An image to draw on; the origin is the upper left corner. What lies outside is left out.
class Canvas {
 public:
  /// @throws std::invalid_argument unless both edges are 1 to 32768
  Canvas(int width, int height, Color background);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Rows from the top, three bytes for each pixel.
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// @pre inside
  [[nodiscard]] Color at(int x, int y) const;

  /// @param opacity 0 leaves what is there, 1 replaces it
  void set(int x, int y, Color color, double opacity = 1.0);
  void fill(int x, int y, int width, int height, Color color);
  void frame(int x, int y, int width, int height, int thickness, Color color);
  /// With soft edges.
  void disc(double x, double y, double radius, Color color);
  void ring(double x, double y, double radius, double thickness, Color color);
  void line(double x0, double y0, double x1, double y1, double thickness, Color color);
  /// Capitals, digits and the commonest signs; others show as a box.
  void text(int x, int y, std::string_view text, Color color);

  /// [px]
  [[nodiscard]] static int text_width(std::string_view text);
  static constexpr int kTextHeight = 14;

 private:
  [[nodiscard]] std::size_t place(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
  }

  int width_, height_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace frontlux::app
