#pragma once

#include <frontlux/synthetic/scanner.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::synthetic {

/// What a map shows: see `make_room_scene` and its like.
enum class SceneKind : std::uint8_t { kRoom, kBuilding };

/// A map that this project makes itself.
struct MapRecipe {
  std::string_view name;
  std::string_view extension;  ///< ".bt", or ".ot" with probabilities
  SceneKind scene = SceneKind::kRoom;
  double resolution = 0.0;  ///< [m]
  bool color = false;       ///< an `octomap::ColorOcTree`

  [[nodiscard]] std::string file_name() const { return std::string(name) + std::string(extension); }
};

/// All of them: the coloured one kept in `data/maps`, then the large ones made where they are needed.
[[nodiscard]] std::span<const MapRecipe> map_recipes();

/// @throws std::invalid_argument naming the known maps, if this is none of them
[[nodiscard]] const MapRecipe& find_map_recipe(std::string_view name);

/// Makes a map and writes it. The file appears complete or not at all; one that is there is replaced. The
/// same recipe and seed give the same bytes.
/// @throws std::runtime_error naming the file, if it cannot be written
void write_map(const MapRecipe& recipe, std::uint64_t seed, const std::filesystem::path& file,
               const ScanProgress& progress = {});

/// The file of a synthetic map (seed 1) in a directory; made first if it is not there.
/// @param directory  made if missing
/// @param progress   called with a text while the map is made
/// @throws std::invalid_argument if there is no such map
/// @throws std::runtime_error naming the file, if it cannot be written
[[nodiscard]] std::filesystem::path ensure_map(std::string_view name, const std::filesystem::path& directory,
                                               const std::function<void(std::string_view)>& progress = {});

}  // namespace frontlux::synthetic
