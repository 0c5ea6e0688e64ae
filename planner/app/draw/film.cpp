#include "draw/film.hpp"

#include "draw/map_view.hpp"
#include "interrupt.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <spawn.h>
#include <stdexcept>
#include <unistd.h>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

constexpr int kRate = 15, kSeconds = 12, kGrowing = kRate * kSeconds,
              kLast = 2 * kRate;  // frames a second; [s]; frames at the end

// A film beside its frames until it is whole: "film.mp4".
std::string unfinished_film(const std::filesystem::path& film) { return "film" + film.extension().string(); }

std::string frame_name(int number) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frame_%04d.png", number);
  return name.data();
}

// Runs ffmpeg in a folder. @return its exit code, or -1 if there is none
int ffmpeg(const std::filesystem::path& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y"});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  if (::posix_spawn_file_actions_init(&actions) != 0) return -1;
  pid_t child = 0;
  int error = ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  if (error == 0) error = ::posix_spawnp(&child, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (error != 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status) == 127 ? -1 : WEXITSTATUS(status);
}

}  // namespace

void remove_frames(const std::filesystem::path& folder) {
  std::error_code ignored;
  // A file of that name, or what a link points to, is none of ours.
  if (!std::filesystem::is_directory(std::filesystem::symlink_status(folder, ignored))) return;
  for (int i = 1; i <= kGrowing + kLast; ++i) std::filesystem::remove(folder / frame_name(i), ignored);
  for (const char* film : kFilms) std::filesystem::remove(folder / unfinished_film(film), ignored);
  std::filesystem::remove(folder, ignored);  // unless it holds other files
}

bool has_ffmpeg() {
  return ffmpeg("/", {"-f", "lavfi", "-i", "nullsrc=s=2x2:d=0.1", "-f", "null", "-"}) == 0;
}

void write_frames(const std::filesystem::path& folder, const planner::Recording& recording,
                  const std::string& name, int width) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot be made: " + error.message());
  RunMap map(recording);
  const double end = map.end();
  RunMap all(recording);
  all.go_to(end);
  MapView view(recording, all, {.width = width, .height = width * 3 / 4, .fine = 2});
  double shown = -1.0;
  for (int i = 1; i <= kGrowing + kLast; ++i) {
    if (InterruptNote::taken()) throw Interrupted("stopped; no film was written");
    const double moment = i >= kGrowing ? end : end * i / kGrowing;
    const std::string file = frame_name(i);
    if (std::exchange(shown, moment) != moment) {
      map.go_to(moment);
      view.draw(map, map.title(name)).write(folder / file);
      continue;
    }
    std::filesystem::copy_file(folder / frame_name(i - 1), folder / file,
                               std::filesystem::copy_options::overwrite_existing, error);
    if (error) throw std::runtime_error((folder / file).string() + ": cannot be written: " + error.message());
  }
}

void write_film(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const bool gif = file.extension() == ".gif";
  const std::string made = unfinished_film(file);
  std::vector<std::string> words = {"-framerate", std::to_string(kRate), "-i", "frame_%04d.png"};
  // A GIF holds 256 colours, chosen for this film, and what has changed from frame to frame.
  const std::vector<std::string> format =
      gif ? std::vector<
                std::string>{"-vf",
                             "fps=5,scale=640:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=64:"
                             "stats_mode=diff[p];[b][p]paletteuse=dither=none:diff_mode=rectangle"}
          : std::vector<std::string>{"-c:v", "libx264", "-pix_fmt",  "yuv420p",
                                     "-crf", "20",      "-movflags", "+faststart"};
  words.insert(words.end(), format.begin(), format.end());
  words.insert(words.end(), {"-fflags", "+bitexact", "-flags:v", "+bitexact", made});
  const int code = ffmpeg(folder, words);  // which Ctrl-C reaches as well
  if (InterruptNote::taken()) throw Interrupted("stopped; " + file.string() + " was not written");
  if (code != 0) throw std::runtime_error(file.string() + ": cannot be made by ffmpeg");
  std::error_code error;
  std::filesystem::rename(folder / made, file, error);
  if (error) throw std::runtime_error(file.string() + ": cannot be written: " + error.message());
}

}  // namespace frontlux::app
