#include "commands/report_command.hpp"

#include "bad_input.hpp"
#include "draw/coverage_still.hpp"
#include "draw/map_still.hpp"
#include "draw/png_file.hpp"

#include <frontlux/planner/recording.hpp>
#include <frontlux/report/report.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace frontlux::app {
namespace {

struct Options {
  std::vector<std::string> runs;
  std::string output;
  bool png = false;
};

struct Run {
  std::filesystem::path file;
  std::string name;
  planner::Recording recording;
};

std::filesystem::path recording_of(const std::filesystem::path& run) {
  std::error_code error;
  if (std::filesystem::is_directory(run, error)) {
    if (!std::filesystem::exists(run / "run.frontlux", error))
      throw BadInput(run.string() +
                     ": this folder holds no run.frontlux; give a folder that frontlux explore has written");
    return run / "run.frontlux";
  }
  if (!std::filesystem::exists(run, error))
    throw BadInput(run.string() + ": there is no such folder or recording");
  return run;
}

// The folder's name says more than run.frontlux; a file with a name of its own is called by it.
std::string name_of(const std::filesystem::path& file) {
  const std::filesystem::path full = std::filesystem::absolute(file).lexically_normal();
  return full.filename() == "run.frontlux" ? full.parent_path().filename().string() : full.stem().string();
}

std::vector<Run> read_runs(const Options& options) {
  std::vector<Run> runs;
  for (const std::string& given : options.runs) {
    const std::filesystem::path file = recording_of(given);
    std::string name = name_of(file);
    const auto same = [&](const Run& run) { return run.name == name; };
    if (std::any_of(runs.begin(), runs.end(), same)) name = given;
    runs.push_back({file, std::move(name), planner::read_recording(file)});
    const planner::Recording& recording = runs.back().recording;
    if (recording.truncated)
      std::cerr << "frontlux: " << file.string() << ": its last step is not complete and is left out\n";
    if (recording.steps.empty()) throw BadInput(file.string() + ": it holds no step; explore first");
  }
  return runs;
}

std::filesystem::path output_of(const Options& options, const std::vector<Run>& runs) {
  if (!options.output.empty()) {
    const std::filesystem::path file = options.output;
    if (file.extension() != ".html")
      throw BadInput("--output: " + options.output + " is no name for a report; give one that ends in .html");
    std::error_code error;
    if (file.has_parent_path() && !std::filesystem::is_directory(file.parent_path(), error))
      throw BadInput("--output: there is no folder " + file.parent_path().string() + "; make it first");
    return file;
  }
  if (runs.size() > 1) throw BadInput("--output: several runs make one report; say where it goes");
  return runs.front().file.parent_path() / "report.html";
}

void report(const Options& options) {
  const std::vector<Run> runs = read_runs(options);
  const std::filesystem::path output = output_of(options, runs);
  std::vector<report::ReportedRun> reported;
  for (const Run& run : runs) reported.push_back({run.name, &run.recording});
  report::write_report(output, reported, FRONTLUX_VERSION);
  std::cout << output.string() << '\n';
  if (!options.png) return;
  for (const Run& run : runs) {
    const std::filesystem::path folder = run.file.parent_path();
    write_png(folder / "final_map.png", draw_final_map(run.recording, run.name));
    write_png(folder / "coverage.png", draw_coverage(run.recording, run.name));
    std::cout << (folder / "final_map.png").string() << '\n' << (folder / "coverage.png").string() << '\n';
  }
}

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Make a page that shows runs, for any browser, offline");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("RUN", options->runs,
                   "Folders that frontlux explore has written, or recordings (.frontlux); the first is the "
                   "one that others are compared with")
      ->required();
  command->add_option("-o,--output", options->output,
                      "Report to write, .html; of one run report.html in its folder if not given");
  command->add_flag("--png", options->png,
                    "Also stills, beside each recording: final_map.png and coverage.png");
  command->footer(
      "Examples:\n"
      "  frontlux report runs/station --png\n"
      "  frontlux report runs/team runs/uav_alone -o comparison.html\n"
      "The page needs no network and no other file. A recording that was cut off is shown up to its last\n"
      "complete step.");
  command->callback([options] {
    try {
      report(*options);
    } catch (const std::invalid_argument& error) {
      throw BadInput(error.what());
    } catch (const BadInput&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw BadInput(error.what());
    }
  });
}

}  // namespace frontlux::app
