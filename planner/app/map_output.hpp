#pragma once

#include <filesystem>

namespace frontlux::app {

/// What would fail in the end fails before the work.
/// @throws BadInput unless this is the name of a map, in a folder that is there
void check_map_output(const std::filesystem::path& file);

}  // namespace frontlux::app
