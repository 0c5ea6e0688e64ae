#pragma once

#include "rays/trial.hpp"

#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace frontlux::bench {

/// `<query>/<map>/<caster>/threads:<n>`
[[nodiscard]] std::string row_name(const Trial& trial, const Entry& entry, int threads);

/// Keeps the rates that Google Benchmark measures; says nothing itself, for its rows are many and the table
/// comes at the end.
class Recorder : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;

  /// Median over the repetitions [rays/s]; nothing if the row did not run.
  [[nodiscard]] std::optional<double> rate(const std::string& row) const;

  /// Mean number of processors that the process kept busy; nothing if the row did not run.
  [[nodiscard]] std::optional<double> busy_processors(const std::string& row) const;

  /// How far the fastest and the slowest repetition of a row lie apart, relative to its median.
  struct Spread {
    double typical;  ///< median of all rows
    double worst;
  };
  /// Nothing if no row was repeated.
  [[nodiscard]] std::optional<Spread> spread() const;

 private:
  std::map<std::string, std::vector<double>> rates_, busy_processors_;
};

/// One line per workload and map: rates, speed-up over castRay, agreement, and what the speed costs.
void print_table(std::span<const std::unique_ptr<Trial>> trials, std::span<const int> threads,
                 const Recorder& recorder, std::ostream& out);

/// What lessens trust in the numbers: processors that were busy with something else while these rows ran on
/// so many threads, and repetitions that lie apart.
void print_cautions(std::span<const std::string> rows, int threads, const Recorder& recorder,
                    std::ostream& out);

}  // namespace frontlux::bench
