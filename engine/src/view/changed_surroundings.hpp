#pragma once

#include "voxel/cell_box.hpp"
#include "view/target_index.hpp"
#include "view/view_reach.hpp"

#include <frontlux/view_quality.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>
#include <vector>

namespace frontlux::detail {

/// Where something changed that viewpoints may have looked at, as boxes: what is not in reach of any of them
/// from a viewpoint cannot have altered its value.
class ChangedSurroundings {
 public:
  /// @param changed  with every voxel that changed
  /// @throws std::invalid_argument if a block is not aligned or larger than the key range
  ChangedSurroundings(std::span<const Block> changed, const TargetIndex& targets_before,
                      const TargetIndex& targets_now, ViewQualityOptions::Sampling sampling);

  [[nodiscard]] std::span<const CellBox> boxes() const { return boxes_; }

 private:
  void add_voxels(std::span<const Block> changed);
  void add_targets(const TargetIndex& before, const TargetIndex& now, bool whole_cubes);

  std::vector<CellBox> boxes_;
};

}  // namespace frontlux::detail
