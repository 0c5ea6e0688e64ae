#pragma once

#include "options.hpp"

#include <cstddef>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace frontlux::bench {

/// `<what>/<caster>/threads:<n>`
[[nodiscard]] std::string row_name(const std::string& what, const std::string& caster, int threads);

/// Times rows with Google Benchmark: repetitions of all rows in random order, so that a slow moment of the
/// machine does not affect one caster only.
class GoogleBenchmark {
 public:
  /// Prints the processor's name. Warns on stderr if the machine has fewer processors than threads are asked
  /// for.
  /// @throws std::runtime_error if Google Benchmark knows no such option or JSON cannot be written
  GoogleBenchmark(const std::string& program, const Options& options);
  ~GoogleBenchmark();
  GoogleBenchmark(const GoogleBenchmark&) = delete;
  GoogleBenchmark& operator=(const GoogleBenchmark&) = delete;

  /// Registers a row.
  /// @param pass      what is timed, in an arena of so many threads
  /// @param items     processed by a pass
  /// @param counters  added to the row's JSON
  /// @throws std::logic_error if there is a row of this name
  void add(const std::string& name, int threads, std::size_t items, std::function<void()> pass,
           std::map<std::string, double> counters);

  /// Says on stderr that nothing is timed, unless all casters agree where they have to.
  /// @return whether they do
  [[nodiscard]] static bool may_run(bool agreed);

  /// Times all rows that pass the filter. The JSON file appears when all have been timed.
  /// @throws std::runtime_error if none passes
  void run();

  /// Median over the repetitions [items/s]; nothing if the row did not run.
  [[nodiscard]] std::optional<double> rate(const std::string& row) const;

  /// Median number of processors that the process kept busy; nothing if the row did not run.
  [[nodiscard]] std::optional<double> busy_processors(const std::string& row) const;

  /// Prints what lessens trust in the numbers: other work on the machine while the rows of most threads ran,
  /// and differences between repetitions.
  void print_cautions(std::ostream& out) const;

 private:
  class Recorder;
  std::vector<std::string> arguments_;  // Google Benchmark keeps a pointer to the program's name
  std::filesystem::path json_, unfinished_;
  std::map<std::string, int> threads_;  // of each row
  std::unique_ptr<Recorder> recorder_;
};

/// Whether a row passes the option --benchmark_filter.
/// @throws std::runtime_error if that is not an extended regular expression
[[nodiscard]] bool passes_filter(const std::string& row);

/// @throws std::runtime_error  that no row passes the option --benchmark_filter
[[noreturn]] void throw_no_row_passes();

}  // namespace frontlux::bench
