#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::bench {

/// The main function of each benchmark; `main` prints the exceptions that it throws and returns 2.
int run(int argc, char** argv);

/// Thrown when the command line has been answered: by the help, or by an error message.
struct Exit {
  int code;
};

/// What the benchmarks on maps have in common.
struct Options {
  std::vector<std::filesystem::path> maps;  ///< files to measure on
  std::filesystem::path cache;              ///< folder of the generated maps
  std::vector<int> threads{1, 2};           ///< ascending
  std::filesystem::path json;               ///< results of Google Benchmark; empty: none
  bool quick = false;
  std::vector<std::string> passed_on;  ///< options of Google Benchmark
};

struct RaysOptions : Options {
  std::vector<std::string> generated;  ///< names of generated maps, measured before the files
  std::optional<std::size_t> rays;     ///< per workload
  bool peers = false;
};

/// What `bench_scaling` can vary, in the order in which it is measured.
inline constexpr std::array<std::string_view, 6> kAxes{"resolution", "length", "density",
                                                       "size",       "width",  "order"};

struct ScalingOptions : Options {
  std::vector<std::string> axes;  ///< some of `kAxes`
};

struct PlannerOptions : Options {
  std::vector<int> samples{16, 64, 256};
  std::size_t ground_viewpoints = 40'000, aerial_viewpoints = 150'000;
  bool corners = false;  ///< frontiers share an edge or corner with a free voxel, too
};

struct ViewErrorOptions : Options {
  std::vector<int> samples{8, 16, 32, 64, 128, 256, 512};
  std::size_t ground_viewpoints = 40'000, aerial_viewpoints = 20'000, checked_viewpoints = 1'000;
  int passes = 5;
  std::filesystem::path csv;
};

struct PathsOptions : Options {
  int seeds = 20;
  std::filesystem::path table;
};

/// Of `bench_tours`.
struct ToursOptions {
  std::vector<std::filesystem::path> runs;  ///< folders of recorded runs in motion
};

/// Read the command line of each benchmark.
/// @throws Exit if there is nothing to measure
/// @throws std::runtime_error naming a folder of maps that cannot be listed
/// @{
[[nodiscard]] RaysOptions read_rays_options(int argc, char** argv);
[[nodiscard]] ScalingOptions read_scaling_options(int argc, char** argv);
[[nodiscard]] PlannerOptions read_planner_options(int argc, char** argv);
[[nodiscard]] ViewErrorOptions read_view_error_options(int argc, char** argv);
[[nodiscard]] PathsOptions read_paths_options(int argc, char** argv);
[[nodiscard]] ToursOptions read_tours_options(int argc, char** argv);
/// @}

}  // namespace frontlux::bench
