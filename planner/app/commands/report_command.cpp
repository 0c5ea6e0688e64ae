#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "draw/film.hpp"
#include "draw/stills.hpp"
#include "explore/explore_run.hpp"
#include "explore/run_json.hpp"
#include "interrupt.hpp"
#include "terminal.hpp"

#include <frontlux/planner/recording.hpp>
#include <frontlux/report/report.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

struct Options {
  std::vector<std::string> runs;
  std::string output;
  bool png = false, svg = false, pdf = false, video = false, gif = false;
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
                     ": the folder holds no run.frontlux; give a folder that frontlux explore has written");
    return run / "run.frontlux";
  }
  if (!std::filesystem::exists(run, error))
    throw BadInput((run.empty() ? "''" : run.string()) +
                   ": there is no such folder or recording; check the path");
  return run;
}

// The name of the folder, since all recordings are called run.frontlux; or the name that a user gave it.
std::string name_of(const std::filesystem::path& file) {
  const std::filesystem::path full = std::filesystem::absolute(file).lexically_normal();
  return full.filename() == "run.frontlux" ? full.parent_path().filename().string() : full.stem().string();
}

std::vector<Run> read_runs(const Options& options, const std::vector<std::string>& files) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& given = options.runs[i];
    const std::filesystem::path file = files[i];
    std::string name = name_of(file);
    const auto same = [&](const Run& run) { return run.name == name; };
    if (std::any_of(runs.begin(), runs.end(), same)) name = given;
    runs.push_back({file, std::move(name), planner::read_recording(file)});
    const planner::Recording& recording = runs.back().recording;
    if (recording.truncated) warn(file.string() + ": the last step is not complete and is left out");
    if (recording.steps.empty()) throw BadInput(file.string() + ": the recording holds no step");
  }
  return runs;
}

// The stills' endings that are asked for.
std::vector<const char*> still_endings(const Options& options) {
  std::vector<const char*> endings;
  const std::array wanted = {options.png, options.svg, options.pdf};
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i]) endings.push_back(kStillEndings[i]);
  return endings;
}

// Pictures and films lie beside their recordings, by fixed names.
void check_folders(const std::vector<std::string>& files) {
  std::map<std::filesystem::path, std::string> taken;
  for (const std::string& file : files) {
    const auto [other, is_new] = taken.emplace(std::filesystem::weakly_canonical(file).parent_path(), file);
    if (!is_new)
      throw BadInput(
          other->second + " and " + file +
          " are in one folder, where their pictures would have the same names; move one, or leave the "
          "pictures out");
  }
}

// Before the recordings are read. @return the page to write
std::filesystem::path check_outputs(const Options& options, const std::vector<std::string>& files) {
  if (options.output.empty() && files.size() > 1)
    throw BadInput("--output: give a file for the report of several runs");
  const std::filesystem::path output = options.output.empty()
                                           ? std::filesystem::path(files.front()).parent_path() / kReport
                                           : std::filesystem::path(options.output);
  check_output(output, {".html"}, files);
  if (options.video || options.gif || !still_endings(options).empty()) check_folders(files);
  for (const std::filesystem::path file : files) {
    const std::filesystem::path folder = file.parent_path();
    for (const std::string ending : still_endings(options))
      for (const std::string name : {kFinalMap, kCoverage})
        check_writable("--" + ending.substr(1), folder / (name + ending));
    if (options.video) check_writable("--video", folder / kFilms[0]);
    if (options.gif) check_writable("--gif", folder / kFilms[1]);
    std::error_code error;
    const std::filesystem::path frames = folder / kFrames;
    if (options.video && std::filesystem::exists(frames, error) && !has_ffmpeg())
      check_writable("--video", frames / "frame_0001.png");
  }
  return output;
}

// What run.json says besides the recording; empty if there is none, or none that can be used.
std::string run_json_of(const std::filesystem::path& folder, const planner::Recording& recording) {
  std::string json, wrong;
  try {
    json = read_run_json(folder);
    wrong = report::misfit(json, recording);
    if (!wrong.empty()) wrong = (folder / kRunJson).string() + " " + wrong;
  } catch (const std::runtime_error& error) {
    wrong = error.what();
  }
  if (wrong.empty()) return json;
  warn(wrong + "; the report leaves out what only run.json tells");
  return {};
}

// The pictures of a run beside its recording, each drawn once.
void write_stills(const Options& options, const Run& run) {
  const std::vector<const char*> endings = still_endings(options);
  if (endings.empty()) return;
  const auto write = [&](const char* name, const Picture& picture) {
    for (const char* ending : endings) {
      const std::filesystem::path file = run.file.parent_path() / (std::string(name) + ending);
      {
        const WorkingLine working("drawing " + file.string());
        picture.write(file);
      }
      std::cout << file.string() << '\n';
    }
  };
  write(kFinalMap, draw_final_map(run.recording, run.name));
  write(kCoverage, draw_coverage(run.recording, run.name));
}

// Frames that are gone in the end, however that comes, unless they are to be kept.
struct Frames {
  std::filesystem::path folder;
  bool keep = false;

  explicit Frames(std::filesystem::path of) : folder(std::move(of)) {}
  ~Frames() {
    if (!keep) remove_frames(folder);
  }
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;
};

// Films of a run beside its recording; its frames where there is no ffmpeg.
void write_films(const Options& options, const Run& run) {
  constexpr int kWidth = 1200;  // [px]
  const std::filesystem::path folder = run.file.parent_path();
  const InterruptNote note;
  const bool keeps_frames = !has_ffmpeg();
  // What is gone in the end takes no names that a user may have given to his own files.
  Frames frames(folder / (keeps_frames ? kFrames : kUnfinishedFrames));
  {
    const WorkingLine working("drawing the frames of a film");
    write_frames(frames.folder, run.recording, run.name, kWidth);
  }
  if (keeps_frames) {
    frames.keep = true;
    std::cout << (frames.folder / "").string() << '\n';
    return;
  }
  const auto write = [&](const char* name) {
    {
      const WorkingLine working("making " + (folder / name).string());
      write_film(folder / name, frames.folder);
    }
    std::cout << (folder / name).string() << '\n';
  };
  if (options.video) write(kFilms[0]);
  if (options.gif) write(kFilms[1]);
}

void report(const Options& options) {
  if (options.gif && !has_ffmpeg()) throw BadInput("--gif: needs ffmpeg, which is not installed here");
  std::vector<std::string> files;
  for (const std::string& given : options.runs) files.push_back(recording_of(given).string());
  const std::filesystem::path output = check_outputs(options, files);
  const std::vector<Run> runs = read_runs(options, files);
  std::vector<report::ReportedRun> reported;
  for (const Run& run : runs)
    reported.push_back({run.name, &run.recording, run_json_of(run.file.parent_path(), run.recording)});
  report::write_report(output, reported, FRONTLUX_VERSION);
  std::cout << output.string() << '\n';
  for (const Run& run : runs) {
    write_stills(options, run);
    if (options.video || options.gif) write_films(options, run);
  }
}

}  // namespace

void add_report_command(CLI::App& app) {
  Command command(app, "report", "Write a web page that shows runs");
  const auto options = std::make_shared<Options>();
  command
      .add("RUN", options->runs, "",
           "Folders that frontlux explore has written, or recordings (.frontlux);\n"
           "all runs are compared with the first")
      .required();
  command.add("-o,--output", options->output, "FILE.html", "Page to write [report.html beside a single run]");
  command.add_flag("--png", options->png, "Also write final_map.png and coverage.png beside each recording");
  command.add_flag("--svg", options->svg, "The same as .svg, with lines and letters as vectors");
  command.add_flag("--pdf", options->pdf, "The same as .pdf");
  command.add_flag(
      "--video", options->video,
      "Also write how the map grows: video.mp4 where ffmpeg is installed, else the frames video/*.png");
  command.add_flag("--gif", options->gif, "The same as a small video.gif; needs ffmpeg");
  command.examples(R"(Examples:
  frontlux report runs/station --png
  frontlux report runs/team runs/uav_alone -o comparison.html
The page needs no network and no other file. An incomplete recording is shown up to its last complete
step.)");
  command.run([options] { work_on("report", "report fewer runs", [&] { report(*options); }); });
}

}  // namespace frontlux::app
