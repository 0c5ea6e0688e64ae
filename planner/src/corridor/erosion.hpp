#pragma once

#include "corridor/voxel_columns.hpp"

#include <array>

namespace frontlux::planner::detail {

/// A box of voxels relative to one, both ends included.
struct VoxelWindow {
  std::array<int, 3> low{}, high{};
};

/// The voxels of a box around which all voxels of a window are set.
///
/// A window is tested by ANDs along one axis after the other. The result of each axis is kept, so that a
/// change renews only the columns around it.
class Erosion {
 public:
  /// @param box     of the columns
  /// @param window  holds the origin
  /// @param beyond  whether voxels beyond the box count as set, as in the columns
  Erosion(const KeyBox& box, const VoxelWindow& window, bool beyond = false);

  /// Takes the columns that are stale; all others have to be as they were.
  void erode(const VoxelColumns& columns);

  [[nodiscard]] bool whole(const VoxelKey& key) const { return whole_.holds(key); }

 private:
  template <int kAxis>
  void erode_across(const VoxelColumns& from, VoxelColumns& to) const;

  VoxelWindow window_;
  bool beyond_;
  VoxelColumns along_z_, along_yz_, whole_;
};

}  // namespace frontlux::planner::detail
