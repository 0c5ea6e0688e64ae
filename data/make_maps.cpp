#include <frontlux/stopwatch.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace synthetic = frontlux::synthetic;

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

void list_maps() {
  for (const synthetic::MapRecipe& recipe : synthetic::map_recipes())
    std::cout << recipe.name << '\t' << recipe.resolution << " m\t" << recipe.file_name() << '\n';
}

void make_map(const synthetic::MapRecipe& recipe, const std::filesystem::path& folder, std::uint64_t seed) {
  const std::string name(recipe.name);
  const frontlux::Stopwatch watch;
  const std::filesystem::path file = folder / recipe.file_name();
  synthetic::write_map(recipe, seed, file, [&](std::size_t done, std::size_t total) {
    if (done == total || done % 20 == 0) std::cerr << name << ": " << done << " of " << total << " scans\n";
  });
  const double seconds = watch.seconds();
  std::cerr << name << ": " << std::filesystem::file_size(file) << " bytes in " << seconds << " s\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Makes the synthetic maps of frontlux."};
  std::string folder;
  std::vector<std::string> names;
  std::uint64_t seed = 1;
  bool list = false;
  app.add_option("--out", folder, "folder to write to, made if missing");
  app.add_option("--seed", seed, "same seed, same bytes")->capture_default_str();
  app.add_flag("--list", list, "list the maps and stop");
  app.add_option("NAME", names, "maps to make; all of them if none is named");
  try {
    app.parse(argc, argv);
    if (!list && folder.empty()) throw CLI::RequiredError("--out");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  if (list) {
    list_maps();
    return 0;
  }
  try {
    std::vector<synthetic::MapRecipe> recipes;
    for (const std::string& name : names) recipes.push_back(synthetic::find_map_recipe(name));
    if (names.empty()) recipes.assign(synthetic::map_recipes().begin(), synthetic::map_recipes().end());
    if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
      throw std::invalid_argument("--out: " + folder + " is not a folder");
    std::filesystem::create_directories(folder);
    for (const synthetic::MapRecipe& recipe : recipes) make_map(recipe, folder, seed);
  } catch (const std::invalid_argument& error) {
    std::cerr << "make_maps: " << error.what() << '\n';
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "make_maps: " << error.what() << '\n';
    return kFailed;
  }
  return 0;
}
