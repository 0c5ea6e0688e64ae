#include "google_benchmark.hpp"

#include "table.hpp"

#include <frontlux/machine.hpp>
#include <frontlux/stopwatch.hpp>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <regex.h>
#include <stdexcept>
#include <thread>

namespace frontlux::bench {
namespace {

using Samples = std::map<std::string, std::vector<double>>;

std::optional<double> median_of(const Samples& samples, const std::string& row) {
  const auto found = samples.find(row);
  return found == samples.end() ? std::nullopt : std::optional(median(found->second));
}

/// What a reader of the numbers must know. Machine load, number of cores and date are in the JSON already.
void add_context() {
  benchmark::AddCustomContext("cpu_name", processor_name());
  benchmark::AddCustomContext("instructions", instruction_set_name());
#if defined(__clang__)
  benchmark::AddCustomContext("compiler", "clang " __clang_version__);
#elif defined(__GNUC__)
  benchmark::AddCustomContext("compiler", "gcc " __VERSION__);
#endif
  benchmark::AddCustomContext("compiler_flags", FRONTLUX_BENCH_FLAGS);  // what only the build knows
  benchmark::AddCustomContext("versions", FRONTLUX_BENCH_VERSIONS);
}

}  // namespace

std::string row_name(const std::string& what, const std::string& caster, int threads) {
  return what + "/" + caster + "/threads:" + std::to_string(threads);
}

/// Keeps what Google Benchmark measures, and prints nothing: the programs print tables.
class GoogleBenchmark::Recorder : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const auto rate = run.counters.find("items_per_second");
      if (run.run_type != Run::RT_Iteration || rate == run.counters.end()) continue;
      std::string name = run.run_name.str();
      if (const auto suffix = name.rfind("/real_time"); suffix != std::string::npos) name.resize(suffix);
      rates[name].push_back(rate->second.value);
      busy_processors[name].push_back(run.counters.at("busy_processors").value);
    }
  }

  Samples rates, busy_processors;
};

GoogleBenchmark::GoogleBenchmark(const std::string& program, const Options& options)
    : arguments_{program, "--benchmark_enable_random_interleaving=true",
                 options.quick ? "--benchmark_repetitions=1" : "--benchmark_repetitions=5",
                 options.quick ? "--benchmark_min_time=0.005" : "--benchmark_min_time=0.1"},
      json_(options.json),
      recorder_(std::make_unique<Recorder>()) {
  if (!json_.empty()) {
    unfinished_ = json_.string() + ".unfinished";
    arguments_.push_back("--benchmark_out=" + unfinished_.string());
    arguments_.emplace_back("--benchmark_out_format=json");
  }
  arguments_.insert(arguments_.end(), options.passed_on.begin(), options.passed_on.end());
  std::vector<char*> pointers;
  for (std::string& argument : arguments_) pointers.push_back(argument.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) throw Exit{2};
  // Google Benchmark finds out that it cannot write only after everything has been prepared.
  if (!unfinished_.empty() && !std::ofstream(unfinished_))
    throw std::runtime_error("cannot write " + unfinished_.string());
  add_context();
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  if (processors > 0 && options.threads.back() > processors)
    std::cerr << "This machine has " << processors
              << " processors. Rows with more threads do not show their gain.\n";
  std::cout << processor_name() << ". All answers are compared before anything is timed." << std::endl;
}

GoogleBenchmark::~GoogleBenchmark() {
  benchmark::Shutdown();
  std::error_code ignored;
  if (!unfinished_.empty()) std::filesystem::remove(unfinished_, ignored);
}

void GoogleBenchmark::add(const std::string& name, int threads, std::size_t items, std::function<void()> pass,
                          std::map<std::string, double> counters) {
  if (!threads_.emplace(name, threads).second) throw std::logic_error("two rows are named " + name);
  const auto run = [=](benchmark::State& state) {
    tbb::task_arena arena(threads);
    const Stopwatch watch;
    const std::clock_t cpu_start = std::clock();
    for (auto _ : state) arena.execute(pass);
    const double cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    const double seconds = watch.seconds();
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
    state.counters["busy_processors"] = cpu_seconds / seconds;
    state.counters["cpu_ms"] = 1e3 * cpu_seconds / static_cast<double>(state.iterations());
    for (const auto& [counter, value] : counters) state.counters[counter] = value;
  };
  benchmark::RegisterBenchmark(name.c_str(), run)->UseRealTime()->Unit(benchmark::kMillisecond);
}

bool GoogleBenchmark::may_run(bool agreed) {
  if (!agreed)
    std::cerr << "\nCasters disagree where they must not (see DISAGREEMENT above): nothing is timed.\n";
  return agreed;
}

void GoogleBenchmark::run() {
  std::cout << "Timing " << threads_.size() << " rows, repetitions of all in random order ..." << std::endl;
  if (benchmark::RunSpecifiedBenchmarks(recorder_.get()) == 0) throw_no_row_passes();
  if (!json_.empty() && !recorder_->rates.empty()) std::filesystem::rename(unfinished_, json_);
}

std::optional<double> GoogleBenchmark::rate(const std::string& row) const {
  return median_of(recorder_->rates, row);
}

std::optional<double> GoogleBenchmark::busy_processors(const std::string& row) const {
  return median_of(recorder_->busy_processors, row);
}

void GoogleBenchmark::print_cautions(std::ostream& out) const {
  int most = 0;
  for (const auto& [row, threads] : threads_) most = std::max(most, threads);
  std::vector<double> busy;
  std::vector<std::pair<double, std::string>> spreads;  // [%] of each row
  for (const auto& [row, threads] : threads_)
    if (const auto processors = busy_processors(row); processors && threads == most)
      busy.push_back(*processors);
  if (!busy.empty() && median(busy) < 0.9 * most)
    out << "CAUTION: rows with " << thread_count(most) << " kept only " << format("%.1f", median(busy))
        << " processors busy. The machine had other work, or the batches are small.\n";
  for (const auto& [row, rates] : recorder_->rates) {
    const auto [low, high] = std::minmax_element(rates.begin(), rates.end());
    if (rates.size() > 1) spreads.emplace_back(100 * (*high - *low) / median(rates), row);
  }
  if (spreads.empty()) return;
  std::ranges::sort(spreads);
  const auto each = [](const auto& spread) { return format("%.0f %%", spread.first); };
  out << "The repetitions of a row differ by " << each(spreads[spreads.size() / 2])
      << " (median of all rows; most: " << each(spreads.back()) << " in " << spreads.back().second << ").\n";
}

void throw_no_row_passes() {
  throw std::runtime_error("--benchmark_filter: no row passes '" + benchmark::GetBenchmarkFilter() + "'");
}

bool passes_filter(const std::string& row) {
  std::string filter = benchmark::GetBenchmarkFilter();
  if (filter.empty() || filter == "all") return true;
  const bool negated = filter.front() == '-';
  // By the C interface, because GCC 12 warns inside std::regex where sanitizers are on.
  regex_t pattern{};
  if (regcomp(&pattern, filter.c_str() + (negated ? 1 : 0), REG_EXTENDED | REG_NOSUB) != 0)
    throw std::runtime_error("--benchmark_filter: '" + filter + "' is not an extended regular expression");
  const bool found = regexec(&pattern, row.c_str(), 0, nullptr, 0) == 0;
  regfree(&pattern);
  return found != negated;
}

}  // namespace frontlux::bench
