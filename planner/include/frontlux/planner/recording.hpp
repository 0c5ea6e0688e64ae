#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::planner {

/// The format that recordings are written in; docs/recording.md describes it.
inline constexpr int kRecordingFormat = 5;

/// The head of a recording: what holds for the whole run.
struct RecordingHead {
  std::string world;                     ///< for people
  double resolution = 0.3;               ///< [m]
  KeyBox bounds = kAllVoxels;            ///< of the map
  std::vector<RobotDescription> robots;  ///< in the team's order
  std::vector<ExplorationStart> starts;  ///< of each of them
  std::uint64_t observable = 0;          ///< voxels that can be observed; 0: unknown
  std::uint64_t bounding = 0;            ///< voxels within the bounds; 0: unknown
  std::string options = "{}";            ///< JSON object of the run's options, as its maker writes it; not
                                         ///< checked here, but by who reads them
};

/// How many voxels of a world one robot has mapped first, up to the end of a step.
struct KnownVoxels {
  std::uint64_t observable = 0;  ///< of the observable voxels
  std::uint64_t bounding = 0;    ///< of all within the bounds
  friend bool operator==(const KnownVoxels&, const KnownVoxels&) = default;
};

/// A step, and what is mapped at its end.
struct RecordedStep {
  /// As the exploration returned it.
  ExplorationStep step;
  /// One for each robot of the head, zeros if nobody counts; a voxel counts for the robot that mapped it
  /// first.
  std::vector<KnownVoxels> known;
  std::uint64_t contacts = 0;  ///< of robots with the true world, in this step
};

/// A run as it was recorded.
struct Recording {
  /// What holds for all steps.
  RecordingHead head;
  std::vector<RecordedStep> steps;  ///< from step 0
  std::optional<std::string> end;   ///< `name_of(ExplorationEnd)`, or a word of who ran it, as "coverage",
                                    ///< "time_limit" and "stopped"; nothing if it was cut off
  bool truncated = false;           ///< an unfinished step at the end of the file was left out
  int format = kRecordingFormat;    ///< of the file; steps of format 4 have no trajectories and no
                                    ///< reassigned frontiers, of 3 no tours
  std::uint64_t bytes = 0;          ///< of the file, up to the end of the last finished step
};

/// Writes a recording step by step: step 0, as `begin` returned it; then each as `Exploration::step` did, or
/// in motion the step of each `ContinuousExploration::plan` and at last that of `finish`; then the end. After
/// each call the file holds all steps, even if the process is killed.
class FRONTLUX_EXPORT RecordingWriter {
 public:
  /// A new recording; a file of that name is replaced, unless another process is writing it.
  /// @throws std::invalid_argument naming what a reader would refuse: in the head a value out of bounds, or
  ///         not one start for each robot
  /// @throws std::runtime_error naming the file, if it cannot be written; so do the others, also if it is not
  ///         as this writer left it any more
  RecordingWriter(const std::filesystem::path& file, const RecordingHead& head);
  /// Goes on with a recording, in its format: cuts the file after its last finished step, and removes its
  /// end.
  RecordingWriter(const std::filesystem::path& file, const Recording& recording);
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;

  /// The next step.
  /// @throws std::invalid_argument naming what a reader would refuse: a step that is not the next by its
  ///         number, `known` or robots that are not one for each robot of the head, a value out of bounds; or
  ///         after the end
  void write(const RecordedStep& step);
  /// Why the run ended: one word of small letters and `_`.
  /// @throws std::invalid_argument if it is no such word of up to 40 letters, or for a second end
  void write_end(const std::string& reason);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The file ends before the head of a recording does: the run had not begun when its process was killed.
class FRONTLUX_EXPORT UnbegunRecording : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a whole recording. Everything in the file is checked: lengths, checksums, ranges of all values.
/// @throws std::runtime_error naming the file, what is wrong, where, and what to do: it is not a recording,
/// it has another format, or it is damaged; UnbegunRecording
[[nodiscard]] FRONTLUX_EXPORT Recording read_recording(const std::filesystem::path& file);

}  // namespace frontlux::planner
