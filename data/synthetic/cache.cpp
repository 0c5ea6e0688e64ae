#include <frontlux/synthetic/cache.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <cstddef>
#include <string>

namespace frontlux::synthetic {
namespace {

// In the name of the folder, so that a benchmark never runs on what an older generator left in its build
// tree. Raise it with every change that alters a map.
constexpr int kGeneration = 2;

}  // namespace

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
