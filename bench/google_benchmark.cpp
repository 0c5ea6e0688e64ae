#include "google_benchmark.hpp"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace frontlux::bench {

GoogleBenchmark::GoogleBenchmark(std::string program, std::vector<std::string> arguments)
    : arguments_(std::move(arguments)) {
  arguments_.insert(arguments_.begin(), std::move(program));
  std::vector<char*> pointers;
  for (std::string& argument : arguments_) pointers.push_back(argument.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) {
    throw std::runtime_error("unknown option of Google Benchmark");
  }
}

GoogleBenchmark::~GoogleBenchmark() { benchmark::Shutdown(); }

SplitArguments::SplitArguments(int argc, char** argv) {
  for (int i = argc - 1; i > 0; --i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--benchmark_")) {
      passed_on.insert(passed_on.begin(), argument);
    } else {
      own.push_back(argument);
    }
  }
}

void register_row(const std::string& name, const Trial& trial, const Entry& entry, int threads,
                  const std::map<std::string, double>& counters) {
  const auto run = [&trial, &entry, threads, counters](benchmark::State& state) {
    tbb::task_arena arena(threads);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    for (auto _ : state) arena.execute(entry.pass);
    const double cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    state.counters["busy_processors"] = cpu_seconds / seconds.count();
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(trial.workload().size()));
    state.counters["rays"] = static_cast<double>(trial.workload().size());
    state.counters["agreement"] = entry.agreement;
    state.counters["hit_share"] = trial.positive_share();
    state.counters["mean_voxels"] = trial.mean_voxels();
    state.counters["build_seconds"] = entry.build_seconds;
    state.counters["memory_bytes"] = static_cast<double>(entry.bytes);
    for (const auto& [counter, value] : counters) state.counters[counter] = value;
  };
  benchmark::RegisterBenchmark(name.c_str(), run)->UseRealTime()->Unit(benchmark::kMillisecond);
}

void warn_of_too_many_threads(int threads) {
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  if (processors > 0 && threads > processors) {
    std::cerr << "This machine has " << processors
              << " processors: rows of more threads are not what they say.\n";
  }
}

void check_writable(const std::string& file) {
  if (!std::ofstream(file, std::ios::app)) throw std::runtime_error("cannot write " + file);
}

}  // namespace frontlux::bench
