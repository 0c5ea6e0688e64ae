// Which part of the path optimiser does what: methods to choose yaws, side by side on random paths.

#include "rays/generated_map.hpp"
#include "paths/ablation.hpp"
#include "paths/table.hpp"
#include "program.hpp"

#include <frontlux/octomap.hpp>

#include <CLI/CLI.hpp>
#include <tbb/task_arena.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

void write_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream stream(part, std::ios::binary | std::ios::trunc);
  if (!(stream << text << std::flush)) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw std::runtime_error("cannot write " + part.string());
  }
  stream.close();
  std::filesystem::rename(part, file);
}

int run(int argc, char** argv) {
  CLI::App app{"Compares ways to choose the yaws of a path: distinct frontiers in view, time, evaluations."};
  std::filesystem::path cache = std::filesystem::temp_directory_path() / "frontlux-maps", table;
  std::vector<std::filesystem::path> files;
  int seeds = 20;
  app.add_option("--map", files, ".bt or .ot files, besides the generated building")
      ->check(CLI::ExistingFile);
  app.add_option("--map-cache", cache, "folder in which generated maps are kept")->capture_default_str();
  app.add_option("--seeds", seeds, "random paths on each map")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000));
  app.add_option("--table", table, "write the page to this file too, when all has been measured");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  files.insert(files.begin(), generate_map("building_0.3m", cache));

  std::vector<MapTrial> maps;
  PathTrial large;
  tbb::task_arena one_core(1);
  one_core.execute([&] {
    for (const auto& file : files) {
      const auto grid =
          std::visit([](const auto& tree) { return make_voxel_grid(*tree); }, read_octree(file));
      maps.push_back(run_ablation(file.stem().string(), grid, seeds));
    }
    large = run_large_path();
  });
  std::ostringstream page;
  print_ablation(maps, large, page);
  std::cout << page.str();
  if (!table.empty()) write_file(table, page.str());
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  return frontlux::bench::run_program("bench_paths", frontlux::bench::run, argc, argv);
}
