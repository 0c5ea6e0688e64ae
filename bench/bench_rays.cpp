#include "machine.hpp"
#include "options.hpp"
#include "report.hpp"
#include "subject.hpp"
#include "trial.hpp"
#include "workload.hpp"

#ifdef FRONTLUX_BENCH_NANOVDB
#include "peers/nanovdb_peer.hpp"
#endif

#include <frontlux/synthetic/cache.hpp>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <ctime>
#include <exception>
#include <iostream>
#include <memory>
#include <regex.h>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace frontlux::bench {
namespace {

/// Everything that the timed rows refer to.
struct Session {
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<std::unique_ptr<Trial>> trials;
  bool agreed = true;
};

/// @param arguments  must live as long as Google Benchmark does, which keeps a pointer to the program's name
void initialize_google_benchmark(std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) {
    throw std::runtime_error("unknown option of Google Benchmark");
  }
}

/// Google Benchmark's own kind of filter: an extended regular expression of POSIX, after `-` for all others.
/// By the C interface, because GCC 12 warns inside std::regex where sanitizers are on.
class Filter {
 public:
  explicit Filter(std::string text) {
    if (text.empty() || text == "all") text.assign(1, '.');
    negated_ = text.front() == '-';
    if (negated_) text.erase(0, 1);
    if (regcomp(&pattern_, text.c_str(), REG_EXTENDED | REG_NOSUB) != 0) {
      throw std::runtime_error("--benchmark_filter is no regular expression: " + text);
    }
  }
  ~Filter() { regfree(&pattern_); }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  [[nodiscard]] bool passes(const std::string& row) const {
    return (regexec(&pattern_, row.c_str(), 0, nullptr, 0) == 0) != negated_;
  }

 private:
  regex_t pattern_{};
  bool negated_ = false;
};

/// Whether the filter leaves any row of a workload, so that the others need not be prepared.
bool wanted(const std::string& workload, const std::string& map, const Options& options) {
  const Filter filter(benchmark::GetBenchmarkFilter());
  for (const char* caster : {"octomap", "grid", "embree", "nanovdb"}) {
    for (const int threads : options.threads) {
      const std::string row =
          workload + "/" + map + "/" + caster + "/threads:" + std::to_string(threads) + "/real_time";
      if (filter.passes(row)) return true;
    }
  }
  return false;
}

void register_row(const Trial& trial, const Entry& entry, int threads) {
  const auto run = [&trial, &entry, threads](benchmark::State& state) {
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
  };
  benchmark::RegisterBenchmark(row_name(trial, entry, threads).c_str(), run)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

/// Reads a map, draws its workloads, and checks all answers on them.
void prepare(const std::filesystem::path& file, const std::string& name, const Options& options,
             Session& session) {
  tbb::task_arena arena(options.threads.back());
  arena.execute([&] {
    session.subjects.push_back(load_subject(file, name));
    const Subject& subject = *session.subjects.back();
    std::cout << describe(subject) << std::endl;

    std::vector<Peer> peers;
#ifdef FRONTLUX_BENCH_NANOVDB
    if (options.peers) peers.push_back(make_nanovdb_peer(subject.grid));
#endif
    WorkloadSource source(subject.grid, *subject.contender("grid").caster);
    for (const std::string_view query : kWorkloads) {
      if (!wanted(std::string(query), name, options)) continue;
      Workload workload = source.make(query, options.rays);
      if (workload.size() == 0) {
        std::cout << "  " << query << " skipped: " << workload.skipped << std::endl;
        continue;
      }
      auto trial = std::make_unique<Trial>(subject, std::move(workload), peers);
      session.agreed = trial->check(options.threads, std::cout) && session.agreed;
      std::cout.flush();
      session.trials.push_back(std::move(trial));
    }
  });
}

/// Makes a generated map, unless an earlier run left it, and counts on one line while it does.
std::filesystem::path generate(const std::string& name, const std::filesystem::path& cache) {
  bool told = false;
  const auto file = synthetic::ensure_map(name, cache, [&](std::string_view text) {
    std::cerr << '\r' << text << std::flush;
    told = true;
  });
  if (told) std::cerr << std::endl;
  return file;
}

/// A map's name is its file's stem; a number tells apart those that share one.
std::string unique_name(const std::filesystem::path& file, std::set<std::string>& taken) {
  const std::string stem = file.stem().string();
  std::string name = stem;
  for (int number = 2; !taken.insert(name).second; ++number) name = stem + "_" + std::to_string(number);
  return name;
}

int run(int argc, char** argv) {
  int exit_code = 0;
  const auto options = read_options(argc, argv, exit_code);
  if (!options) return exit_code;
  std::vector<std::string> benchmark_arguments = options->benchmark_arguments;
  benchmark_arguments.insert(benchmark_arguments.begin(), argv[0]);
  initialize_google_benchmark(benchmark_arguments);
  add_context();

  if (const auto processors = static_cast<int>(std::thread::hardware_concurrency());
      processors > 0 && options->threads.back() > processors) {
    std::cerr << "This machine has " << processors
              << " processors: rows of more threads are not what they say.\n";
  }
  Session session;
  std::set<std::string> names;
  std::cout << cpu_name() << ". Answers are compared first, on the rays that are timed.\n";
  for (const std::string& name : options->generated) {
    names.insert(name);
    prepare(generate(name, options->cache), name, *options, session);
  }
  for (const auto& file : options->maps) prepare(file, unique_name(file, names), *options, session);
  if (!session.agreed) {
    std::cerr << "\nCasters disagree where they must not (see DISAGREEMENT above): nothing is timed.\n";
    return 1;
  }
  if (session.trials.empty()) {
    std::cout << "Nothing to measure.\n";
    return 0;
  }

  for (const auto& trial : session.trials) {
    for (const Entry& entry : trial->entries()) {
      for (const int threads : options->threads) register_row(*trial, entry, threads);
    }
  }
  std::cout << "Timing, in random order of all repetitions ..." << std::endl;
  Recorder recorder;
  benchmark::RunSpecifiedBenchmarks(&recorder);
  print_table(session.trials, options->threads, recorder, std::cout);
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  try {
    return frontlux::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench_rays: " << error.what() << '\n';
    return 2;
  }
}
