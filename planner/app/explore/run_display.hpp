#pragma once

#include "explore/run_files.hpp"
#include "explore/run_forecast.hpp"
#include "explore/run_json.hpp"
#include "explore/run_loop.hpp"
#include "terminal.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace frontlux::app {

struct ExploreRun;
struct ExploreSetup;

/// What a run prints: on a terminal a line that replaces itself, elsewhere a line for each step; its result
/// in the end. With --json the result alone is on standard output, with --quiet neither line nor result is. A
/// closed standard output counts as --quiet: the run is in its folder.
class RunDisplay {
 public:
  /// @param run, setup  live as long as the display
  RunDisplay(const ExploreRun& run, const ExploreSetup& setup);

  /// A step of a resumed run is taken again.
  /// @param done     of the recorded steps
  /// @param seconds  since the command began, here and below
  void repeated(std::size_t done, std::size_t recorded, double seconds);
  /// The run's files are there now: says where.
  void begin();
  /// How far the run is, what each robot does in this step, and what it is about.
  void step(const planner::ExplorationStep& step, const RunSums& sums, double seconds);
  /// No step follows; what is made of the run takes long in a large world.
  void ended(double seconds);
  /// What the run came to.
  /// @param end       why it ended; nothing if it was stopped
  /// @param run_json  the bytes of run.json
  void result(const RunResult& result, const std::optional<RunEnd>& end, const std::string& run_json);

 private:
  void print_line(const std::string& line) const;
  void print_summary(const RunResult& result, const std::optional<RunEnd>& end) const;

  const ExploreRun& run_;
  const ExploreSetup& setup_;
  ProgressLine line_;
  bool quiet_, in_place_, lines_;
  RunForecast forecast_;
  std::size_t repeated_ = 0;
  double last_line_ = 0.0;  // [s]
};

}  // namespace frontlux::app
