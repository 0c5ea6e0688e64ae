#include "scaling/options.hpp"

#include "google_benchmark.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>

namespace frontlux::bench {
namespace {

constexpr const char* kDescription =
    "Measures how rays per second of castRay, the grid caster and the Embree caster change with the map, "
    "the\n"
    "rays and the threads, after checking that all give the same answers. One axis is varied at a time:\n"
    "  resolution  the generated building in voxels of 0.1 to 0.5 m: visible_uav, cast_lidar\n"
    "  length      rays of 2 to 60 m in a nearly empty box and in the building\n"
    "  share       0.01 % to 20 % of a box occupied by random cubes; rays of 20 m\n"
    "  size        1 to 100 million known voxels in equal rooms; rays of 5 m; also memory and build time\n"
    "  order       the building's rays as a planner asks them and shuffled, on each number of threads\n"
    "All but `order` are measured on the highest number of threads. Without --quick the run takes some "
    "minutes\n"
    "and 2.2 GB of memory; the first one makes the building in four resolutions, two minutes more.\n"
    "Takes Google Benchmark's options (--benchmark_...) as well.\n"
    "Draw the results with: bench/plot_scaling.py RESULTS.json FOLDER\n";

}  // namespace

std::optional<ScalingOptions> read_scaling_options(int argc, char** argv, int& exit_code) {
  ScalingOptions options;
  SplitArguments arguments(argc, argv);
  CLI::App app{kDescription};
  options.cache = std::filesystem::temp_directory_path() / "frontlux-maps";
  app.add_option("--axis", options.axes, "what to vary (default: all)")
      ->check(CLI::IsMember(std::vector<std::string>(kAxes.begin(), kAxes.end())));
  app.add_option("--threads", options.threads, "numbers of threads")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--json", options.json,
                 "write Google Benchmark's JSON to this file, when all has been timed");
  app.add_option("--map-cache", options.cache, "folder in which generated maps are kept")
      ->capture_default_str();
  app.add_flag("--quick", options.quick,
               "fewer points, maps of at most 10 million voxels, one short repetition: under a minute");
  try {
    app.parse(arguments.own);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }

  std::sort(options.threads.begin(), options.threads.end());
  options.threads.erase(std::unique(options.threads.begin(), options.threads.end()), options.threads.end());
  if (options.axes.empty()) options.axes.assign(kAxes.begin(), kAxes.end());
  // A slow or disturbed moment must not meet one caster only: repetitions of all rows in random order.
  options.benchmark_arguments = {"--benchmark_enable_random_interleaving=true",
                                 options.quick ? "--benchmark_repetitions=1" : "--benchmark_repetitions=5",
                                 options.quick ? "--benchmark_min_time=0.01" : "--benchmark_min_time=0.1"};
  if (!options.json.empty()) {
    options.unfinished = options.json;
    options.unfinished += ".unfinished";
    check_writable(options.unfinished.string());
    options.benchmark_arguments.push_back("--benchmark_out=" + options.unfinished.string());
    options.benchmark_arguments.push_back("--benchmark_out_format=json");
  }
  options.benchmark_arguments.insert(options.benchmark_arguments.end(), arguments.passed_on.begin(),
                                     arguments.passed_on.end());
  return options;
}

}  // namespace frontlux::bench
