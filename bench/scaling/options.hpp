#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::bench {

/// What can be varied, in the order in which it is measured.
inline constexpr std::array<std::string_view, 5> kAxes{"resolution", "length", "share", "size", "order"};

/// The command line of `bench_scaling`.
struct ScalingOptions {
  std::vector<std::string> axes;     ///< some of `kAxes`
  std::filesystem::path cache;       ///< where generated maps are kept
  std::filesystem::path json;        ///< results; empty for none
  std::filesystem::path unfinished;  ///< where the results are while they are not complete
  std::vector<int> threads{1, 2};    ///< ascending
  bool quick = false;
  std::vector<std::string> benchmark_arguments;  ///< for Google Benchmark, our defaults first
};

/// Reads the command line.
/// @return the options, or the exit code if there is nothing to do but exit
/// @throws std::runtime_error naming a file that cannot be written
[[nodiscard]] std::optional<ScalingOptions> read_scaling_options(int argc, char** argv, int& exit_code);

}  // namespace frontlux::bench
