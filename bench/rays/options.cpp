#include "rays/options.hpp"

#include "google_benchmark.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string_view>

namespace frontlux::bench {
namespace {

namespace fs = std::filesystem;

/// All maps of a folder, in the order of their names.
std::vector<fs::path> maps_in(const fs::path& folder) {
  std::vector<fs::path> maps;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (file.extension() == ".bt" || file.extension() == ".ot") maps.push_back(file);
  }
  if (error)
    throw std::runtime_error("FRONTLUX_EXTRA_MAPS: cannot list " + folder.string() + ": " + error.message());
  std::sort(maps.begin(), maps.end());
  return maps;
}

}  // namespace

std::optional<Options> read_options(int argc, char** argv, int& exit_code) {
  Options options;
  auto [own, passed_on] = SplitArguments(argc, argv);

  CLI::App app{
      "Measures rays per second of every ray caster on OctoMap maps, after checking that all give the same\n"
      "answers. Takes Google Benchmark's options (--benchmark_...) as well."};
  std::string json;
  bool quick = false, generated = false;
  options.cache = fs::temp_directory_path() / "frontlux-maps";
  app.add_option(
      "--map", options.maps,
      "maps to measure on, .bt or .ot (default: the generated building_0.3m and building_0.1m, and the "
      "maps in the folder FRONTLUX_EXTRA_MAPS, if that is set)");
  app.add_flag("--generated", generated, "measure on the generated maps even if others are given");
  app.add_option("--rays", options.rays,
                 "rays per workload (default: so many that castRay takes some tenths of a second)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  app.add_option("--threads", options.threads, "numbers of threads")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--json", json, "write Google Benchmark's JSON to this file");
  app.add_option("--map-cache", options.cache, "folder in which generated maps are kept")
      ->capture_default_str();
  app.add_flag("--peers", options.peers, "measure NanoVDB too, if built with it");
  app.add_flag("--quick", quick, "a smoke run: few rays, one repetition, and the coarse generated map only");
  try {
    app.parse(own);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }

  std::sort(options.threads.begin(), options.threads.end());
  options.threads.erase(std::unique(options.threads.begin(), options.threads.end()), options.threads.end());
  if (options.maps.empty() || generated) {
    options.generated = quick ? std::vector<std::string>{"building_0.3m"}
                              : std::vector<std::string>{"building_0.3m", "building_0.1m"};
  }
  if (options.maps.empty()) {
    const char* extra = std::getenv("FRONTLUX_EXTRA_MAPS");
    if (extra != nullptr && *extra != '\0') options.maps = maps_in(extra);
  }
  if (quick && !options.rays) options.rays = 2'000;

  // A slow or disturbed moment must not meet one caster only: repetitions of all rows in random order.
  options.benchmark_arguments = {"--benchmark_enable_random_interleaving=true",
                                 quick ? "--benchmark_repetitions=1" : "--benchmark_repetitions=5",
                                 quick ? "--benchmark_min_time=0.005" : "--benchmark_min_time=0.1"};
  if (!json.empty()) {
    check_writable(json);
    options.benchmark_arguments.push_back("--benchmark_out=" + json);
    options.benchmark_arguments.push_back("--benchmark_out_format=json");
  }
  options.benchmark_arguments.insert(options.benchmark_arguments.end(), passed_on.begin(), passed_on.end());
  return options;
}

}  // namespace frontlux::bench
