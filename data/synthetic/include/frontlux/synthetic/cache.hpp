#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace frontlux::synthetic {

/// The file of a synthetic map (`map_recipes`, seed 1) in a directory; made first, atomically, if it isn't
/// there.
/// @param directory  made if missing
/// @param progress   told in words what is being done, only when something is
/// @throws std::invalid_argument if there is no such map
/// @throws std::runtime_error naming the file, if it cannot be written
[[nodiscard]] std::filesystem::path ensure_map(std::string_view name, const std::filesystem::path& directory,
                                               const std::function<void(std::string_view)>& progress = {});

}  // namespace frontlux::synthetic
