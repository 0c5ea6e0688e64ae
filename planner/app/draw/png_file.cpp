#include "draw/png_file.hpp"

#include <frontlux/file.hpp>

#include <png.h>
#include <stdexcept>
#include <string>

namespace frontlux::app {

void write_png(const std::filesystem::path& file, const Canvas& image) {
  // libpng's simplified interface: no long jumps across C++.
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.bytes().data(), 0, nullptr) == 0)
    throw std::runtime_error(file.string() + ": cannot be made: libpng says " + header.message);
  bytes.resize(size);
  write_file(file, bytes);
}

}  // namespace frontlux::app
