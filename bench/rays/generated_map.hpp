#pragma once

#include <filesystem>
#include <string>

namespace frontlux::bench {

/// Makes a generated map, unless an earlier run left it, and counts on one line while it does.
/// @return its file
/// @throws std::invalid_argument if there is no such map
/// @throws std::runtime_error naming the file, if it cannot be written
[[nodiscard]] std::filesystem::path generate_map(const std::string& name, const std::filesystem::path& cache);

}  // namespace frontlux::bench
