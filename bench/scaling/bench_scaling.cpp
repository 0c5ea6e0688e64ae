#include "google_benchmark.hpp"
#include "machine.hpp"
#include "program.hpp"
#include "report.hpp"
#include "scaling/options.hpp"
#include "scaling/sweep.hpp"
#include "scaling/table.hpp"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <iostream>
#include <system_error>

namespace frontlux::bench {
namespace {

/// Removes results that never became complete.
class Unfinished {
 public:
  explicit Unfinished(const ScalingOptions& options) : options_(options) {}
  ~Unfinished() {
    std::error_code ignored;
    if (!options_.unfinished.empty()) std::filesystem::remove(options_.unfinished, ignored);
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  void finish() const {
    if (!options_.json.empty()) std::filesystem::rename(options_.unfinished, options_.json);
  }

 private:
  const ScalingOptions& options_;
};

int run(int argc, char** argv) {
  int exit_code = 0;
  const auto options = read_scaling_options(argc, argv, exit_code);
  if (!options) return exit_code;
  const Unfinished results(*options);
  GoogleBenchmark google_benchmark(argv[0], options->benchmark_arguments);
  add_context();
  warn_of_too_many_threads(options->threads.back());

  std::cout << cpu_name() << ". Answers are compared first, on the rays that are timed." << std::endl;
  Sweep sweep(*options, std::cout);
  if (!sweep.prepare()) {
    std::cerr << "\nCasters disagree where they must not (see DISAGREEMENT above): nothing is timed.\n";
    return 1;
  }
  std::size_t rows = 0;
  for (const Point& point : sweep.points()) {
    for (const Entry& entry : point.trial->entries()) {
      for (const int threads : point.threads) {
        register_row(row_name(point, entry, threads), *point.trial, entry, threads, point.counters);
        ++rows;
      }
    }
  }
  std::cout << "Timing " << rows << " rows, in random order of all repetitions ..." << std::endl;
  Recorder recorder;
  benchmark::RunSpecifiedBenchmarks(&recorder);
  results.finish();
  print_scaling_table(sweep.points(), recorder, std::cout);
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  return frontlux::bench::run_program("bench_scaling", frontlux::bench::run, argc, argv);
}
