#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::bench {

/// The command line of `bench_rays`.
struct Options {
  std::vector<std::filesystem::path> maps;  ///< files to measure on
  std::vector<std::string> generated;       ///< names of generated maps to measure on, before the files
  std::filesystem::path cache;              ///< where generated maps are kept
  std::optional<std::size_t> rays;          ///< per workload
  std::vector<int> threads{1, 2};           ///< ascending
  bool peers = false;
  std::vector<std::string> benchmark_arguments;  ///< for Google Benchmark, our defaults first
};

/// Reads the command line and `FRONTLUX_EXTRA_MAPS`.
/// @return the options, or the exit code if there is nothing to do but exit
/// @throws std::runtime_error naming a folder that cannot be listed or a file that cannot be written
[[nodiscard]] std::optional<Options> read_options(int argc, char** argv, int& exit_code);

}  // namespace frontlux::bench
