#include "options.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace frontlux::bench {
namespace {

namespace fs = std::filesystem;

const CLI::Range kThreads(1, 1024), kCounts(std::size_t{1}, std::size_t{10'000'000});

/// A command line with the options that all benchmarks on maps have.
class CommandLine : public CLI::App {
 public:
  CommandLine(const std::string& description, Options& options) : CLI::App(description), options_(options) {
    options_.cache = fs::temp_directory_path() / "frontlux-maps";
    add_option("--map-cache", options_.cache, "folder in which generated maps are kept")
        ->capture_default_str();
  }

  void add_maps(const std::string& defaults) {
    add_option("--map", options_.maps, "maps to measure on, .bt or .ot (default: " + defaults + ")")
        ->check(CLI::ExistingFile);
  }

  template <class Given>
  void add_viewpoints(Given& given) {
    add_option("--samples", given.samples, "frontiers drawn for each viewpoint")
        ->check(CLI::Range(1, 1'000'000));
    add_option("--viewpoints", given.ground_viewpoints, "most viewpoints of the ground robot")
        ->check(kCounts);
    add_option("--viewpoints-in-space", given.aerial_viewpoints, "most viewpoints of the aerial robot")
        ->check(kCounts);
  }

  void add_google_benchmark(const std::string& quick) {
    footer("Options of Google Benchmark (--benchmark_...) are passed on.");
    takes_google_ = true;
    add_option("--threads", options_.threads, "numbers of threads")->capture_default_str()->check(kThreads);
    add_option("--json", options_.json, "write the JSON of Google Benchmark to this file");
    add_flag("--quick", options_.quick, quick);
  }

  void read(int argc, char** argv) {
    name(fs::path(argv[0]).filename().string());
    std::vector<std::string> own;  // the last one first, as CLI11 takes them
    for (int i = argc - 1; i > 0; --i) {
      const std::string argument = argv[i];
      if (takes_google_ && argument.starts_with("--benchmark_"))
        options_.passed_on.insert(options_.passed_on.begin(), argument);
      else
        own.push_back(argument);
    }
    try {
      parse(own);
    } catch (const CLI::ParseError& error) {
      throw Exit{exit(error) == 0 ? 0 : 2};
    }
    auto& threads = options_.threads;
    std::sort(threads.begin(), threads.end());
    threads.erase(std::unique(threads.begin(), threads.end()), threads.end());
  }

 private:
  Options& options_;
  bool takes_google_ = false;
};

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

RaysOptions read_rays_options(int argc, char** argv) {
  RaysOptions options;
  CommandLine line(
      R"(Measures the rays per second of every ray caster on OctoMap maps. Before that, it checks that all casters
give the same answers. The casters:
  octomap  OctoMap's castRay, the baseline
  fast     make_ray_caster: packets of rays through a table of open voxels, Embree for long rays
  embree   make_embree_ray_caster: Embree's BVH, without tables
  grid     make_grid_ray_caster: castRay's walk over the voxel grid, one ray at a time
)",
      options);
  bool generated = false;
  line.add_maps(
      "the generated building_0.3m, building_0.1m and site_0.05m, and the maps in the folder "
      "FRONTLUX_EXTRA_MAPS");
  line.add_flag("--generated", generated, "also measure on the generated maps if --map is given");
  line.add_option("--rays", options.rays,
                  "rays per workload (default: as many as castRay casts in some tenths of a second)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  line.add_flag("--peers", options.peers, "also measure NanoVDB and Open3D, as far as built with them");
  line.add_google_benchmark(
      "only check that it works: few rays, one repetition, of the generated maps the coarse one only");
  line.read(argc, argv);
  if (options.maps.empty() || generated) {
    options.generated = {"building_0.3m"};
    if (!options.quick) options.generated.insert(options.generated.end(), {"building_0.1m", "site_0.05m"});
  }
  const char* extra = std::getenv("FRONTLUX_EXTRA_MAPS");
  if (options.maps.empty() && extra != nullptr && *extra != '\0') options.maps = maps_in(extra);
  if (options.quick && !options.rays) options.rays = 2'000;
  return options;
}

ScalingOptions read_scaling_options(int argc, char** argv) {
  ScalingOptions options;
  CommandLine line(
      R"(Measures how the rays per second of every ray caster change with the map, the rays and the threads. Before
that, it checks that all casters give the same answers. One axis is varied at a time:
  resolution  the generated building in voxels of 0.1 to 0.5 m: visible_uav, cast_lidar
  length      rays of 2 to 60 m in a nearly empty box and in the building
  density     0.01 % to 20 % of a box occupied by random cubes; rays of 20 m
  size        1 to 100 million known voxels in equal rooms; rays of 5 m; also memory and build time
  width       streets of a town of 250 m to 2 km in voxels of 0.2 m, past the width of one table; rays of 30 m
  order       the rays of the building in a planner's order and shuffled, on each number of threads
All axes but `order` are measured on the highest number of threads. Without --quick a run takes some minutes
and 4 GB of memory; the first run generates the building in four resolutions, which takes two minutes more.
To draw the results: bench/plot_scaling.py RESULTS.json FOLDER
)",
      options);
  line.add_option("--axis", options.axes, "what to vary (default: all)")
      ->check(CLI::IsMember(std::vector<std::string>(kAxes.begin(), kAxes.end())));
  line.add_google_benchmark(
      "fewer points, maps of at most 10 million voxels, one short repetition: under a minute");
  line.read(argc, argv);
  if (options.axes.empty()) options.axes.assign(kAxes.begin(), kAxes.end());
  return options;
}

PlannerOptions read_planner_options(int argc, char** argv) {
  PlannerOptions options;
  CommandLine line(
      R"(Measures the time to choose goals. Before that, it checks that all ray casters give the same answers.)",
      options);
  line.add_maps("the generated building_0.3m");
  line.add_viewpoints(options);
  line.add_flag("--corners", options.corners,
                "also count voxels as frontiers that share only an edge or corner with a free voxel");
  line.add_google_benchmark("only check that it works: few viewpoints, one repetition");
  line.read(argc, argv);
  if (options.quick) {
    options.ground_viewpoints = std::min<std::size_t>(options.ground_viewpoints, 2'000);
    options.aerial_viewpoints = std::min<std::size_t>(options.aerial_viewpoints, 5'000);
  }
  return options;
}

ViewErrorOptions read_view_error_options(int argc, char** argv) {
  ViewErrorOptions options;
  options.threads = {1};
  CommandLine line(
      R"(Measures the error of sampled view quality against exact view quality, and the time of both. Before that, it
checks that the exact values are those of rays to all frontiers.)",
      options);
  line.add_maps("the generated building_0.3m");
  line.add_viewpoints(options);
  line.add_option("--checked", options.checked_viewpoints,
                  "viewpoints that are checked, and on which the slow casters are timed")
      ->check(kCounts);
  line.add_option("--passes", options.passes,
                  "number of measurements, each with its own draws; medians are printed")
      ->check(CLI::Range(1, 1000));
  line.add_option("--threads", options.threads, "number of threads")->expected(1)->check(kThreads);
  line.add_option("--csv", options.csv, "write the table to this file");
  line.read(argc, argv);
  return options;
}

PathsOptions read_paths_options(int argc, char** argv) {
  PathsOptions options;
  CommandLine line(
      R"(Compares methods that choose the yaws of a path: distinct frontiers in view, time, evaluations.)",
      options);
  line.add_maps("none; the generated building_0.3m is always measured");
  line.add_option("--seeds", options.seeds, "random paths on each map")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000));
  line.add_option("--table", options.table, "also write the page to this file");
  line.read(argc, argv);
  return options;
}

ToursOptions read_tours_options(int argc, char** argv) {
  ToursOptions options;
  CLI::App line(
      R"(Tells how good the paths of robots in recorded runs were. The hindsight tour of a robot is the shortest one that
2-opt and Or-opt find, when the whole map is known, from its start through all of its stops. A stop is where it
took its last scan before it planned because its goal was reached or seen, if it had mapped frontiers by itself
since its planning before. The columns:
  path       metres that the robot went
  stops      cells that hold stops
  in order   metres of the shortest paths from stop to stop, in the order in which the robot was there
  hindsight  metres of the hindsight tour
  ratio      path / hindsight
  revisited  the part of its path within 1 m of its own path at least 6 m of path before
)",
      fs::path(argv[0]).filename().string());
  line.add_option("RUN", options.runs, "folders of runs in motion, as frontlux explore leaves them")
      ->required()
      ->check(CLI::ExistingDirectory);
  try {
    line.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    throw Exit{line.exit(error) == 0 ? 0 : 2};
  }
  return options;
}

}  // namespace frontlux::bench
