#include "explore/run_display.hpp"

#include "accuracy_text.hpp"
#include "explore/explore_run.hpp"
#include "explore/run_warnings.hpp"
#include "setup/explore_setup.hpp"
#include "terminal.hpp"
#include "text.hpp"

#include <frontlux/planner/exploration.hpp>

#include <iostream>
#include <limits>
#include <unistd.h>

namespace frontlux::app {
namespace {

using planner::ExplorationStep;

RunForecast::Quantities ends_of(const ExploreSetup& setup) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const int steps = setup.exploration.max_steps;
  return {setup.stop_coverage.value_or(1.0), setup.stop_time.value_or(kNever),
          steps == std::numeric_limits<int>::max() ? kNever : steps};
}

// "2:05"
std::string minutes(double seconds) {
  const auto whole = static_cast<long>(seconds);
  return std::to_string(whole / 60) + (whole % 60 < 10 ? ":0" : ":") + std::to_string(whole % 60);
}

std::string moves(const planner::RobotStep& robot, std::uint64_t number, bool lockstep) {
  if (!lockstep)
    return "moves " + fixed(robot.length, 1) + " m" +
           (robot.goal.reason.empty() ? "" : " (" + robot.goal.reason + ")");
  if (robot.goal.pose)
    return "travels " + fixed(robot.length, 1) + " m, expected gain " + std::to_string(robot.gain_predicted) +
           " of " + std::to_string(robot.goal.assigned);
  return number == 0 ? "looks around" : robot.length > 0.0 ? "backs off" : "waits";
}

}  // namespace

RunDisplay::RunDisplay(const ExploreRun& run, const ExploreSetup& setup)
    : run_(run),
      setup_(setup),
      quiet_(run.quiet || (!run.json && !is_open_to_write(STDOUT_FILENO))),
      in_place_(line_.visible() && !quiet_),
      lines_(!quiet_ && (!line_.visible() || (::isatty(STDOUT_FILENO) == 0 && !run.json))),
      forecast_(ends_of(setup)) {}

void RunDisplay::print_line(const std::string& line) const {
  (run_.json ? std::cerr : std::cout) << line << std::endl;
}

void RunDisplay::begin() {
  if (in_place_) line_.clear();
  if (in_place_ || lines_)
    print_line((repeated_ > 0 ? "repeated " + std::to_string(repeated_) + " recorded steps, going on in "
                              : std::string("exploring into ")) +
               run_.folder.string() + "; Ctrl-C ends the run after the current step");
}

void RunDisplay::repeated(std::size_t done, std::size_t recorded, double seconds) {
  constexpr double kEach = 5.0;  // [s] between two lines
  repeated_ = done;
  const std::string text = run_.folder.string() + ": repeated " + std::to_string(done) + " of " +
                           std::to_string(recorded) + " recorded steps, " + minutes(seconds) + " so far";
  if (in_place_) line_.show(text);
  if (!lines_ || seconds < last_line_ + kEach) return;
  last_line_ = seconds;
  print_line(text);
}

void RunDisplay::step(const ExplorationStep& step, const RunSums& sums, double seconds) {
  forecast_.note(seconds, {sums.observable, step.time, static_cast<double>(step.number)});
  const auto left = forecast_.left();
  const std::string to_go = left ? ", " + about(*left) + " to go" : "";
  const std::string clock = fixed(step.time, 1) + " s";
  if (in_place_)
    line_.show(run_.folder.string() + ": mapped " + percent(sums.observable) + " at " + clock + ", step " +
               std::to_string(step.number) + "; " + minutes(seconds) + " so far" + to_go);
  if (!lines_) return;
  std::string line = "step " + std::to_string(step.number) + ": mapped " + percent(sums.observable);
  line += " at " + clock + ", " + std::to_string(step.frontiers) + " frontiers";
  for (std::size_t r = 0; r < step.robots.size(); ++r)
    line +=
        "; " + setup_.head.robots[r].robot.name + " " + moves(step.robots[r], step.number, setup_.lockstep);
  if (step.number > 0) line += "; planned in " + fixed(step.planning_seconds(), 3) + " s";
  print_line(line + (left ? "; " + about(*left) + " to go" : ""));
}

void RunDisplay::ended(double seconds) {
  const std::string text = "the run has ended, its results are being made";
  if (in_place_) line_.show(run_.folder.string() + ": " + text + "; " + minutes(seconds) + " so far");
  if (lines_) print_line(text);
}

void RunDisplay::result(const RunResult& result, const std::optional<RunEnd>& end,
                        const std::string& run_json) {
  if (in_place_) line_.clear();
  if (run_.json)
    std::cout << result_line(run_json, run_);
  else if (!quiet_)
    print_summary(result, end);
  if (!run_.json) give_up_broken_output();  // the result is in the folder
  for (const std::string& warning : result.warnings)
    std::cerr << in_red("warning: " + on_one_line(warning), STDERR_FILENO) << '\n';
}

void RunDisplay::print_summary(const RunResult& result, const std::optional<RunEnd>& end) const {
  const auto& [sums, numbers, word, warnings, unseen, accuracy, seconds] = result;
  std::string times;
  for (const int part : {50, 90, 95, 99})
    if (const auto time = time_to(numbers, setup_.head.observable, part / 100.0))
      times += fixed(*time, 1) + " s to " + std::to_string(part) + " %, ";
  std::string why = row("end", end ? end->word + ": " + end->text : "stopped: by Ctrl-C or SIGTERM");
  if (!end || ends_badly(sums, *end)) {
    why.pop_back();
    why = in_red(why, STDOUT_FILENO) + '\n';
  }
  const std::string openings = unseen ? narrow_openings(*unseen, setup_.head.robots) : "";
  std::string out =
      row("run", run_.folder.string()) + row("world", setup_.head.world) + why +
      row("steps", std::to_string(sums.steps)) +
      row("mapped", percent(sums.observable) + " of the observable space, " + percent(sums.bounding) +
                        " of the world's box") +
      (unseen ? row("unseen", percent(unseen->narrow) + " where only " + others_than(setup_.head.robots) +
                                  " see it" + (openings.empty() ? "" : " (" + openings + ")") + ", " +
                                  percent(unseen->hidden) + " hidden from everywhere, " +
                                  percent(unseen->in_view) + " that they could have seen")
              : "") +
      (setup_.sourced.out_of_bounds >= sim::kMuchUnseen
           ? row("outside", percent(setup_.sourced.out_of_bounds) +
                                " of the world's surface: it is out of bounds (box_m), and not explored")
           : "") +
      row("map", accuracy_text(accuracy)) +
      row("clock", times + fixed(numbers.mapped.back().time, 1) + " s to the end");
  for (std::size_t r = 0; r < setup_.head.robots.size(); ++r) {
    const RobotNumbers& robot = numbers.robots[r];
    out += row(setup_.head.robots[r].robot.name,
               "travelled " + fixed(robot.length, 1) + " m, idle " + fixed(robot.idle, 1) + " s, held back " +
                   std::to_string(robot.held_back) + " times" +
                   (robot.failed ? ", failed after " + fixed(*robot.failed, 1) + " s" : "") +
                   (robot.joined ? ", joined after " + fixed(*robot.joined, 1) + " s" : "") +
                   (robot.goal.empty() ? "" : "; " + robot.goal));
  }
  out += row("contacts",
             std::to_string(numbers.contacts) +
                 (numbers.contacts > 0 && numbers.contacts_in_free
                      ? ", " + std::to_string(*numbers.contacts_in_free) + " with surfaces in free voxels"
                      : "") +
                 (numbers.clearance ? ", least clearance " + fixed(*numbers.clearance, 2) + " m" : "") +
                 (numbers.separation ? ", between robots " + fixed(*numbers.separation, 2) + " m" : "")) +
         row("planning", "mean " + fixed(sums.planning_mean(), 3) + " s, 99 % below " +
                             fixed(sums.planning_percentile(0.99), 3) + " s, max " +
                             fixed(sums.planning_percentile(1.0), 3) + " s; the clock charges " +
                             fixed(setup_.exploration.latency, 3) + " s") +
         row("wall time", fixed(seconds, 1) + " s");
  if (run_.report && std::filesystem::exists(report_of(run_))) out += row("report", report_of(run_).string());
  std::cout << out;
}

}  // namespace frontlux::app
