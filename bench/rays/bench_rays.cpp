#include "google_benchmark.hpp"
#include "machine.hpp"
#include "program.hpp"
#include "rays/generated_map.hpp"
#include "rays/options.hpp"
#include "rays/subject.hpp"
#include "rays/trial.hpp"
#include "rays/workload.hpp"
#include "report.hpp"

#ifdef FRONTLUX_BENCH_NANOVDB
#include "peers/nanovdb_peer.hpp"
#endif

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <iostream>
#include <memory>
#include <regex.h>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::bench {
namespace {

/// Everything that the timed rows refer to.
struct Session {
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<std::unique_ptr<Trial>> trials;
  bool agreed = true;
};

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
  for (const char* caster : {"octomap", "grid", "embree", "fast", "nanovdb"}) {
    for (const int threads : options.threads) {
      const std::string row =
          workload + "/" + map + "/" + caster + "/threads:" + std::to_string(threads) + "/real_time";
      if (filter.passes(row)) return true;
    }
  }
  return false;
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
  GoogleBenchmark google_benchmark(argv[0], options->benchmark_arguments);
  add_context();
  warn_of_too_many_threads(options->threads.back());
  Session session;
  std::set<std::string> names;
  std::cout << cpu_name() << ". Answers are compared first, on the rays that are timed.\n";
  for (const std::string& name : options->generated) {
    names.insert(name);
    prepare(generate_map(name, options->cache), name, *options, session);
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
      for (const int threads : options->threads)
        register_row(row_name(*trial, entry, threads), *trial, entry, threads);
    }
  }
  std::cout << "Timing, in random order of all repetitions ..." << std::endl;
  Recorder recorder;
  benchmark::RunSpecifiedBenchmarks(&recorder);
  print_table(session.trials, options->threads, recorder, std::cout);
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  return frontlux::bench::run_program("bench_rays", frontlux::bench::run, argc, argv);
}
