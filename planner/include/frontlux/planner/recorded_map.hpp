#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::planner {

/// The map of a recorded run, step by step.
///
///     RecordedMap map(recording.head.resolution);
///     for (const RecordedStep& step : recording.steps) map.apply(step);
///
/// Thread safety: as a standard container.
class FRONTLUX_EXPORT RecordedMap {
 public:
  /// The map before step 0: all is unknown.
  /// @param resolution [m]
  /// @throws std::invalid_argument if it is no length
  explicit RecordedMap(double resolution);

  /// Applies the next step: what its robots changed, in their order. Step 0 includes what they knew to be
  /// free at their starts.
  /// @throws std::invalid_argument naming a voxel that was not what the step says; the map stays as it is
  void apply(const RecordedStep& step);

  /// The map after the steps applied so far; a copy is a snapshot.
  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }

 private:
  VoxelGrid grid_;
};

}  // namespace frontlux::planner
