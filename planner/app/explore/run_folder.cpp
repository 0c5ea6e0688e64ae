#include "explore/run_folder.hpp"

#include "bad_input.hpp"
#include "draw/film.hpp"
#include "draw/stills.hpp"

#include <frontlux/file.hpp>

#include <stdexcept>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using planner::Recording;

// As a shell takes it for one word.
std::string for_shell(const std::string& word) {
  constexpr std::string_view kPlain =
      "+,-./0123456789:=@_ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char letter : word) letter == '\'' ? quoted.append("'\\''") : quoted.append(1, letter);
  return quoted + "'";
}

// Whether there is nothing to lose: at most what runs left that were killed before they began.
bool is_unused(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename() != kRecording) return false;
    try {
      static_cast<void>(planner::read_recording(entry.path()));
      return false;
    } catch (const planner::UnbegunRecording&) {
      continue;
    } catch (const std::runtime_error&) {
      return false;
    }
  }
  return !error;
}

// What `frontlux report` makes of a run, beside the films' frames.
std::vector<std::string> views() {
  std::vector<std::string> names{kReport};
  for (const char* film : kFilms) names.emplace_back(film);
  for (const std::string still : {kFinalMap, kCoverage})
    for (const char* ending : kStillEndings) names.push_back(still + ending);
  return names;
}

[[noreturn]] void refuse_folder(const ExploreRun& run, const std::string& why) {
  throw BadInput("--output: " + run.folder.string() + " " + why);
}

[[noreturn]] void refuse_to_make(const ExploreRun& run, const std::string& why) {
  refuse_folder(run,
                "cannot be created: " + why + "; name a folder in one that exists and may be written to");
}

}  // namespace

void remove_unfinished_files(const fs::path& folder) {
  for (const std::string_view file : kRunFiles) remove_unfinished(folder / file);
  for (const std::string& file : views()) remove_unfinished(folder / file);
}

void check_folder(const ExploreRun& run, std::span<const std::string> inputs) {
  std::error_code error;
  if (!fs::exists(run.folder, error)) {
    fs::path folder = run.folder.has_filename() ? run.folder : run.folder.parent_path();
    do folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    while (run.make_parents && !fs::exists(folder, error));
    if (!fs::is_directory(folder, error)) refuse_to_make(run, "its parent folder does not exist");
    if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse_to_make(run, folder.string() + " is read-only");
    return;
  }
  if (!fs::is_directory(run.folder, error)) refuse_folder(run, "is a file; name a folder");
  if (::access(run.folder.c_str(), W_OK | X_OK) != 0)
    refuse_folder(run, "cannot be written to; check its permissions");
  remove_unfinished_files(run.folder);
  if (!run.force && !is_unused(run.folder))
    refuse_folder(
        run,
        "is not empty; name another folder, continue the run in it with --resume, or replace it with "
        "--force");
  for (const std::string_view file : kRunFiles) {
    if (fs::is_directory(run.folder / file, error))
      refuse_folder(run, "holds a folder " + std::string(file) + "; move it away, or name another folder");
    for (const std::string& input : inputs)
      if (fs::equivalent(run.folder / file, input, error))
        refuse_folder(run, "holds what is read, " + input + "; name another folder");
  }
  if (fs::exists(run.folder / kRecording, error)) return;
  std::vector<std::string> others(kRunFiles.begin(), kRunFiles.end());
  for (const std::string& view : views()) others.push_back(view);
  others.emplace_back(kFrames);
  for (const std::string& file : others)
    if (fs::exists(run.folder / file, error))
      refuse_folder(
          run, "holds " + file + ", but no run to which it belongs; move it away, or name another folder");
}

void make_folder(const ExploreRun& run, std::span<const std::string> inputs) {
  check_folder(run, inputs);  // again: another process may have begun a run there since
  std::error_code error;
  if (run.make_parents) fs::create_directories(run.folder.parent_path(), error);
  if (!fs::exists(run.folder, error) && !fs::create_directory(run.folder, error))
    refuse_to_make(run, error ? error.message() : "its parent folder does not exist");
}

void remove_link(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_symlink(file, ignored) && !fs::is_other(file, ignored)) fs::remove(file, ignored);
}

void remove_old_files(const fs::path& folder) {
  std::error_code ignored;
  for (const std::string_view file : kRunFiles)
    if (file != kRecording) fs::remove(folder / file, ignored);
}

void remove_views(const fs::path& folder) {
  std::error_code ignored;
  for (const std::string& file : views()) fs::remove(folder / file, ignored);
  for (const char* frames : {kFrames, kUnfinishedFrames}) remove_frames(folder / frames);
}

std::string how_to_resume(const ExploreRun& run) {
  return "frontlux explore --resume " + for_shell(run.folder.string()) + " continues the run";
}

std::string what_is_kept(const ExploreRun& run, const planner::RecordingHead& head, std::size_t steps) {
  const fs::path file = run.folder / kRecording;
  std::error_code error;
  const std::string nothing = "; no step of the run is left there";
  try {
    const Recording left = fs::exists(file, error) ? planner::read_recording(file) : Recording{};
    if (left.steps.empty() || left.head.options != head.options) return nothing;
    const std::string kept = left.steps.size() < steps
                                 ? "; " + std::to_string(left.steps.size()) + " of its " +
                                       std::to_string(steps) + " recorded steps are kept"
                                 : "; the recorded steps are kept";
    if (::access(file.c_str(), W_OK) != 0)
      return kept + ", but " + file.string() + " is read-only: make it writable to continue the run";
    return kept + ": " + how_to_resume(run);
  } catch (const planner::UnbegunRecording&) {
    return nothing;
  } catch (const std::runtime_error&) {
    return "; " + file.string() + " is damaged: the run cannot be continued";
  }
}

}  // namespace frontlux::app
