#include <frontlux/file.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux::synthetic {
namespace {

// In the name of the folder, so that a benchmark never runs on what an older generator left in its build
// tree. Raise it with every change that alters a map.
constexpr int kGeneration = 2;

constexpr std::array kRecipes{
    MapRecipe{"color_room_0.2m", ".ot", SceneKind::kRoom, 0.2, true},
    MapRecipe{"building_0.5m", ".bt", SceneKind::kBuilding, 0.5},
    MapRecipe{"building_0.3m", ".bt", SceneKind::kBuilding, 0.3},
    MapRecipe{"building_0.2m", ".bt", SceneKind::kBuilding, 0.2},
    MapRecipe{"building_0.1m", ".bt", SceneKind::kBuilding, 0.1},
};

struct Survey {
  Scene scene;
  std::vector<Eigen::Vector3d> places;
  ScanOptions options;
};

Survey plan_survey(SceneKind kind, double resolution, std::uint64_t seed) {
  // `spacing` of neighbouring rays where they are longest.
  const auto survey = [&](Scene scene, std::size_t places, double apart, double range, double spacing) {
    const int rays = static_cast<int>(4.0 * std::numbers::pi * range * range / (spacing * spacing));
    auto drawn = draw_places(scene, places, apart, seed);
    return Survey{std::move(scene), std::move(drawn), {resolution, range, rays, seed}};
  };
  if (kind == SceneKind::kRoom) return survey(make_room_scene(seed), 3, 1.0, 5.0, resolution);
  // Denser: at a grazing angle a scan must hit every voxel of a surface, lest it clear those it misses.
  return survey(make_building_scene(seed), 100, 3.0, 9.0, std::min(0.5 * resolution, 0.1));
}

void write_tree(const MapRecipe& recipe, std::uint64_t seed, const ScanProgress& progress,
                std::ostream& stream) {
  const Survey survey = plan_survey(recipe.scene, recipe.resolution, seed);
  if (recipe.color) {
    scan<octomap::ColorOcTree>(survey.scene, survey.places, survey.options, progress)->write(stream);
    return;
  }
  const auto tree = scan(survey.scene, survey.places, survey.options, progress);
  if (recipe.extension == ".ot") {
    tree->write(stream);
    return;
  }
  // Voxels that differ only in their probability are one leaf in a .bt file.
  tree->toMaxLikelihood();
  tree->prune();
  tree->writeBinaryConst(stream);
}

}  // namespace

std::span<const MapRecipe> map_recipes() { return kRecipes; }

const MapRecipe& find_map_recipe(std::string_view name) {
  std::string known;
  for (const MapRecipe& recipe : kRecipes) {
    if (recipe.name == name) return recipe;
    known.append(" ").append(recipe.name);
  }
  throw std::invalid_argument("no synthetic map is called '" + std::string(name) + "'; there are:" + known);
}

void write_map(const MapRecipe& recipe, std::uint64_t seed, const std::filesystem::path& file,
               const ScanProgress& progress) {
  write_file(file, [&](std::ostream& stream) { write_tree(recipe, seed, progress, stream); });
}

std::filesystem::path ensure_map(std::string_view name, const std::filesystem::path& directory,
                                 const std::function<void(std::string_view)>& progress) {
  const MapRecipe& recipe = find_map_recipe(name);
  const std::filesystem::path folder = directory / ("generation_" + std::to_string(kGeneration));
  const std::filesystem::path file = folder / recipe.file_name();
  if (std::filesystem::exists(file)) return file;
  std::filesystem::create_directories(folder);
  write_map(recipe, 1, file, [&](std::size_t done, std::size_t total) {
    if (!progress || (done != total && done % 10 != 0)) return;
    progress("making " + file.string() + ": " + std::to_string(done) + " of " + std::to_string(total) +
             " scans");
  });
  return file;
}

}  // namespace frontlux::synthetic
