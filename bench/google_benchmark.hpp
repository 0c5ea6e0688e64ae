#pragma once

#include "rays/trial.hpp"

#include <map>
#include <string>
#include <vector>

namespace frontlux::bench {

/// Google Benchmark's state, from its start to its end.
class GoogleBenchmark {
 public:
  /// @throws std::runtime_error if it does not know one of the arguments
  GoogleBenchmark(std::string program, std::vector<std::string> arguments);
  ~GoogleBenchmark();
  GoogleBenchmark(const GoogleBenchmark&) = delete;
  GoogleBenchmark& operator=(const GoogleBenchmark&) = delete;

 private:
  std::vector<std::string> arguments_;  // it keeps a pointer to the program's name
};

/// A command line, the options for Google Benchmark apart from ours.
struct SplitArguments {
  explicit SplitArguments(int argc, char** argv);
  std::vector<std::string> own;  ///< the last one first, as CLI11 takes them
  std::vector<std::string> passed_on;
};

/// Registers the passes of one caster on so many threads, to be timed.
/// @param trial, entry  must live until the rows have run
/// @param counters      to stand in the JSON beside those that every row has
void register_row(const std::string& name, const Trial& trial, const Entry& entry, int threads,
                  const std::map<std::string, double>& counters = {});

/// Says on stderr if the machine has fewer processors.
void warn_of_too_many_threads(int threads);

/// Google Benchmark finds out that it cannot write only after everything has been prepared.
/// @throws std::runtime_error naming the file
void check_writable(const std::string& file);

}  // namespace frontlux::bench
