#pragma once

#include "draw/canvas.hpp"

#include <filesystem>

namespace frontlux::app {

/// Writes an image as PNG. The file appears complete or not at all.
/// @throws std::runtime_error naming the file, if it cannot be written
void write_png(const std::filesystem::path& file, const Canvas& image);

}  // namespace frontlux::app
