#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct _cairo;

namespace frontlux::app {

/// sRGB.
struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Of a picture [px]; y grows downwards.
struct Spot {
  double x = 0.0, y = 0.0;
};

/// Pixels to put into a picture; what is not set shows what is below.
class Raster {
 public:
  Raster(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// @pre inside
  void set(int x, int y, Color color) { pixels_[place(x, y)] = 0xFF000000U | packed(color); }
  /// What lies outside is left out.
  void fill(int x, int y, int width, int height, Color color);
  /// The mean of each square of so many pixels: edges become soft.
  [[nodiscard]] Raster reduced(int edge) const;
  /// Rows from the top; alpha in the highest byte, then red, green, blue, multiplied by it.
  [[nodiscard]] std::vector<std::uint32_t>& pixels() { return pixels_; }

 private:
  static std::uint32_t packed(Color color) {
    return std::uint32_t{color.red} << 16U | std::uint32_t{color.green} << 8U | color.blue;
  }
  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  std::vector<std::uint32_t> pixels_;
};

enum class Align { kLeft, kMiddle, kRight };

/// Text: its height, its place beside the spot, and a halo around the letters.
struct TextStyle {
  double size = 16.0;  ///< [px]
  Color color{};
  Align align = Align::kLeft;
  bool bold = false;
  bool halo = false;  ///< of the paper's white
};

/// A picture on white paper, drawn by Cairo. The origin is the upper left corner. The same calls make the
/// same bytes on the same machine; letters are those of its font DejaVu Sans, or of what it has instead.
class Picture {
 public:
  /// @throws std::invalid_argument unless both edges are 1 to 32767 pixels
  Picture(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  void fill(double x, double y, double width, double height, Color color);
  void frame(double x, double y, double width, double height, double thickness, Color color);
  void disc(const Spot& middle, double radius, Color color);
  void ring(const Spot& middle, double radius, double thickness, Color color);
  /// @param dashes  lengths of strokes and gaps in turn [px]; empty: unbroken
  void line(std::span<const Spot> spots, double thickness, Color color, std::span<const double> dashes = {});
  void image(double x, double y, Raster raster);
  /// @param at  where the text begins, has its middle or ends; half as high as a small letter. Bytes that are
  ///     not UTF-8 show as the replacement character.
  void text(const Spot& at, std::string_view text, const TextStyle& style);
  [[nodiscard]] double text_width(std::string_view text, const TextStyle& style);

  /// The bytes of a file with this ending: .png, .svg or .pdf.
  /// @throws std::runtime_error  what Cairo says, if it cannot be made
  [[nodiscard]] std::string encoded(std::string_view ending) const;
  /// Writes it in the format of the file's ending. The file appears complete or not at all.
  /// @throws std::runtime_error naming the file, if it cannot be written
  void write(const std::filesystem::path& file) const;

 private:
  int width_, height_;
  std::vector<std::function<void(_cairo* pen)>> strokes_;  // what is drawn, in order
  std::shared_ptr<_cairo> measure_;                        // for the widths of texts
};

}  // namespace frontlux::app
