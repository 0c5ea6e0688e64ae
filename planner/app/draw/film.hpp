#pragma once

#include <frontlux/planner/recording.hpp>

#include <array>
#include <filesystem>
#include <string>

namespace frontlux::app {

/// The names of films beside a run's recording, and of the folder of their frames.
inline constexpr std::array kFilms = {"video.mp4", "video.gif"};
inline constexpr const char* kFrames = "video";
/// Of those that are gone once the films are made.
inline constexpr const char* kUnfinishedFrames = "video.unfinished";

/// Whether there is an ffmpeg to make films with.
[[nodiscard]] bool has_ffmpeg();

/// Writes how a run's map grows, in 12 seconds and a last picture that stays, as frame_0001.png and so on.
/// @param folder  is made; what it holds under such names is replaced
/// @param width   of the map, at most [px]
/// @throws std::runtime_error naming the file, if one cannot be written; Interrupted
void write_frames(const std::filesystem::path& folder, const planner::Recording& recording,
                  const std::string& name, int width);

/// Removes what `write_frames` and `write_film` have written there, and the folder if nothing else is in it.
void remove_frames(const std::filesystem::path& folder);

/// Makes a film of a folder's frames by ffmpeg, in the format of the file's ending: .mp4, or .gif at a third
/// of the rate. The file appears complete or not at all.
/// @throws std::runtime_error naming the file, if it cannot be made; Interrupted
void write_film(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace frontlux::app
