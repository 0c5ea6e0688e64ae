#include "draw/picture.hpp"

#include <frontlux/file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <new>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace frontlux::app {
namespace {

constexpr int kMaxEdge = 32767;            // [px] of Cairo's images
constexpr double kPointsPerPixel = 0.75;   // of 1/72 and 1/96 inch
constexpr double kHalfSmallLetter = 0.27;  // of a text's size

using Surface = std::shared_ptr<cairo_surface_t>;
using Pen = std::shared_ptr<cairo_t>;

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("Cairo says ") + cairo_status_to_string(status));
}

Surface owned(cairo_surface_t* surface) {
  Surface owner(surface, cairo_surface_destroy);
  check(cairo_surface_status(surface));
  return owner;
}

Pen pen_on(const Surface& surface) {
  Pen pen(cairo_create(surface.get()), cairo_destroy);
  check(cairo_status(pen.get()));
  return pen;
}

void use(cairo_t* pen, Color color) {
  constexpr double kWhole = 255.0;
  cairo_set_source_rgb(pen, color.red / kWhole, color.green / kWhole, color.blue / kWhole);
}

// Cairo refuses a text that is not UTF-8, but names of files may hold any bytes.
std::string printable(std::string_view text) {
  using nlohmann::json;
  const json quoted = json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace));
  return quoted.get<std::string>();
}

void choose(cairo_t* pen, const TextStyle& style) {
  const std::unique_ptr<cairo_font_options_t, void (*)(cairo_font_options_t*)> options(
      cairo_font_options_create(), cairo_font_options_destroy);
  // Letters stand where the vectors say, in all formats.
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(pen, options.get());
  cairo_select_font_face(pen, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, style.size);
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned length) {
  try {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Raster::Raster(int width, int height)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Raster::fill(int x, int y, int width, int height, Color color) {
  for (int row = std::max(y, 0); row < std::min(y + height, height_); ++row)
    for (int column = std::max(x, 0); column < std::min(x + width, width_); ++column) set(column, row, color);
}

Raster Raster::reduced(int edge) const {
  Raster small(width_ / edge, height_ / edge);
  const unsigned count = static_cast<unsigned>(edge) * static_cast<unsigned>(edge);
  for (int y = 0; y < small.height_; ++y)
    for (int x = 0; x < small.width_; ++x) {
      std::uint32_t mean = 0;
      for (unsigned shift = 0; shift < 32; shift += 8) {
        unsigned sum = count / 2;
        for (int row = 0; row < edge; ++row)
          for (int column = 0; column < edge; ++column)
            sum += pixels_[place(x * edge + column, y * edge + row)] >> shift & 0xFFU;
        mean |= sum / count << shift;
      }
      small.pixels_[small.place(x, y)] = mean;
    }
  return small;
}

Picture::Picture(int width, int height) : width_(width), height_(height) {
  if (width < 1 || height < 1 || width > kMaxEdge || height > kMaxEdge)
    throw std::invalid_argument("picture: " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels, but each edge has to be 1 to " + std::to_string(kMaxEdge));
  measure_ = pen_on(owned(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1)));
  fill(0.0, 0.0, width, height, {255, 255, 255});
}

void Picture::fill(double x, double y, double width, double height, Color color) {
  strokes_.emplace_back([=](cairo_t* pen) {
    use(pen, color);
    cairo_rectangle(pen, x, y, width, height);
    cairo_fill(pen);
  });
}

void Picture::frame(double x, double y, double width, double height, double thickness, Color color) {
  strokes_.emplace_back([=](cairo_t* pen) {
    use(pen, color);
    cairo_set_line_width(pen, thickness);
    cairo_rectangle(pen, x + thickness / 2, y + thickness / 2, width - thickness, height - thickness);
    cairo_stroke(pen);
  });
}

void Picture::disc(const Spot& middle, double radius, Color color) {
  strokes_.emplace_back([=](cairo_t* pen) {
    use(pen, color);
    cairo_arc(pen, middle.x, middle.y, radius, 0.0, 2 * std::numbers::pi);
    cairo_fill(pen);
  });
}

void Picture::ring(const Spot& middle, double radius, double thickness, Color color) {
  strokes_.emplace_back([=](cairo_t* pen) {
    use(pen, color);
    cairo_set_line_width(pen, thickness);
    cairo_new_sub_path(pen);
    cairo_arc(pen, middle.x, middle.y, radius, 0.0, 2 * std::numbers::pi);
    cairo_stroke(pen);
  });
}

void Picture::line(std::span<const Spot> spots, double thickness, Color color,
                   std::span<const double> dashes) {
  if (spots.empty()) return;
  strokes_.emplace_back([thickness, color, path = std::vector(spots.begin(), spots.end()),
                         gaps = std::vector(dashes.begin(), dashes.end())](cairo_t* pen) {
    use(pen, color);
    cairo_set_line_width(pen, thickness);
    cairo_set_dash(pen, gaps.data(), static_cast<int>(gaps.size()), 0.0);
    cairo_move_to(pen, path.front().x, path.front().y);
    for (const Spot& spot : std::span(path).subspan(1)) cairo_line_to(pen, spot.x, spot.y);
    cairo_stroke(pen);
    cairo_set_dash(pen, nullptr, 0, 0.0);
  });
}

void Picture::image(double x, double y, Raster raster) {
  const auto kept = std::make_shared<Raster>(std::move(raster));
  strokes_.emplace_back([x, y, kept](cairo_t* pen) {
    const Surface pixels = owned(cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char*>(kept->pixels().data()), CAIRO_FORMAT_ARGB32, kept->width(),
        kept->height(), static_cast<int>(sizeof(std::uint32_t)) * kept->width()));
    cairo_set_source_surface(pen, pixels.get(), x, y);
    cairo_pattern_set_filter(cairo_get_source(pen), CAIRO_FILTER_NEAREST);
    cairo_rectangle(pen, x, y, kept->width(), kept->height());
    cairo_fill(pen);
    use(pen, {});                        // lets go of the pixels
    cairo_surface_finish(pixels.get());  // a page that still needs them makes a copy
  });
}

void Picture::text(const Spot& at, std::string_view text, const TextStyle& style) {
  const double width = style.align == Align::kLeft ? 0.0 : text_width(text, style);
  const Spot begin{at.x - (style.align == Align::kRight ? width : width / 2),
                   at.y + kHalfSmallLetter * style.size};
  strokes_.emplace_back([begin, style, shown = printable(text)](cairo_t* pen) {
    choose(pen, style);
    if (style.halo) {
      use(pen, {255, 255, 255});
      cairo_set_line_width(pen, 0.3 * style.size);
      cairo_move_to(pen, begin.x, begin.y);
      cairo_text_path(pen, shown.c_str());
      cairo_stroke(pen);
    }
    use(pen, style.color);
    cairo_move_to(pen, begin.x, begin.y);
    cairo_show_text(pen, shown.c_str());
    cairo_new_path(pen);
  });
}

double Picture::text_width(std::string_view text, const TextStyle& style) {
  choose(measure_.get(), style);
  cairo_text_extents_t extents{};
  cairo_text_extents(measure_.get(), printable(text).c_str(), &extents);
  return extents.x_advance;
}

std::string Picture::encoded(std::string_view ending) const {
  std::string bytes;
  // Not by a recording of Cairo's own, which Cairo 1.16 does not free when it is drawn into an SVG.
  const auto draw = [&](const Surface& onto, double scale) {
    const Pen pen = pen_on(onto);
    cairo_scale(pen.get(), scale, scale);
    cairo_set_line_join(pen.get(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(pen.get(), CAIRO_LINE_CAP_ROUND);
    for (const auto& stroke : strokes_) stroke(pen.get());
    check(cairo_status(pen.get()));
  };
  const double width = kPointsPerPixel * width_, height = kPointsPerPixel * height_;
  if (ending == ".png") {
    const Surface image = owned(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_));
    draw(image, 1.0);
    check(cairo_surface_write_to_png_stream(image.get(), append, &bytes));
    return bytes;
  }
  const bool pdf = ending == ".pdf";
  const Surface page = owned(pdf ? cairo_pdf_surface_create_for_stream(append, &bytes, width, height)
                                 : cairo_svg_surface_create_for_stream(append, &bytes, width, height));
  // Otherwise the moment of writing would be in the file.
  if (pdf) cairo_pdf_surface_set_metadata(page.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  draw(page, kPointsPerPixel);
  cairo_surface_finish(page.get());
  check(cairo_surface_status(page.get()));
  return bytes;
}

void Picture::write(const std::filesystem::path& file) const {
  std::string bytes;
  try {
    bytes = encoded(file.extension().string());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": cannot be made: " + error.what());
  }
  write_file(file, bytes);
}

}  // namespace frontlux::app
