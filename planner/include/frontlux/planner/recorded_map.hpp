#pragma once

#include <frontlux/planner/recording.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <memory>
#include <optional>

namespace frontlux::planner {

/// The map of a recorded run, step by step, and which robot made each voxel known first.
///
///     RecordedMap map(recording.head);
///     for (const RecordedStep& step : recording.steps) map.apply(step);
///
/// Takes some megabytes for a map of a million known voxels. Thread safety: as a standard container.
class RecordedMap {
 public:
  /// Before step 0: unknown but for what the robots know to be free at their starts.
  /// @throws std::invalid_argument if the resolution is no length
  explicit RecordedMap(const RecordingHead& head);
  ~RecordedMap();
  RecordedMap(RecordedMap&&) noexcept;
  RecordedMap& operator=(RecordedMap&&) noexcept;

  /// The next step. Where several robots changed one voxel, it does not matter who did so first.
  /// @throws std::invalid_argument naming a voxel whose changes do not begin with what it is; the map stays
  /// as it was
  void apply(const RecordedStep& step);

  /// After the steps applied; a copy is a snapshot.
  [[nodiscard]] const VoxelGrid& grid() const;

  /// The robot that made a voxel known first, in the team's order; nothing if it was never known.
  [[nodiscard]] std::optional<std::size_t> first_seen_by(const VoxelKey& key) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
