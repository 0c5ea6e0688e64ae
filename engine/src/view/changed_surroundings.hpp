#pragma once

#include "view/target_index.hpp"
#include "view/view_reach.hpp"
#include "voxel/cell_box.hpp"

#include <frontlux/view_quality.hpp>

#include <span>
#include <vector>

namespace frontlux::detail {

/// Where something changed that viewpoints may have looked at, as boxes: what is not in reach of any of them
/// from a viewpoint cannot have altered its value.
class ChangedSurroundings {
 public:
  /// @param changed  every voxel that changed
  ChangedSurroundings(std::span<const VoxelKey> changed, const TargetIndex& targets_before,
                      const TargetIndex& targets_now, ViewQualityOptions::Sampling sampling);

  [[nodiscard]] std::span<const CellBox> boxes() const { return boxes_; }

 private:
  void add_voxels(std::span<const VoxelKey> changed);
  void add_targets(const TargetIndex& before, const TargetIndex& now, bool whole_cubes);

  std::vector<CellBox> boxes_;
};

}  // namespace frontlux::detail
