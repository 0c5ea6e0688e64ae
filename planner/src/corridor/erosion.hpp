#pragma once

#include "corridor/voxel_columns.hpp"

#include <frontlux/planner/body_stencil.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// A box of voxels relative to one, both ends included.
struct VoxelWindow {
  std::array<int, 3> low{}, high{};
};

/// The voxels of a box around which all voxels of a window or of a stencil are set.
///
/// A window is tested by ANDs along one axis after the other. Of a stencil that is no window, all columns
/// with the same layers are tested along z first, and then each with the others of the stencil. The result of
/// each stage is kept, so that a change renews only the columns around it.
class Erosion {
 public:
  /// @param box     of the columns
  /// @param window  holds the origin
  /// @param beyond  whether voxels beyond the box count as set, as in the columns
  Erosion(const KeyBox& box, const VoxelWindow& window, bool beyond = false);

  /// Voxels beyond the box do not count as set.
  Erosion(const KeyBox& box, const BodyStencil& stencil);

  /// Takes the columns that are stale; all others have to be as they were.
  void erode(const VoxelColumns& columns);

  [[nodiscard]] bool whole(const VoxelKey& key) const { return whole_.holds(key); }
  [[nodiscard]] const VoxelColumns& whole() const { return whole_; }

 private:
  // Columns of the stencil with the same layers, relative to the middle.
  struct Part {
    int low, high;
    std::vector<std::array<int, 2>> columns;
    std::vector<std::ptrdiff_t> offsets;  // of the columns' first words
    VoxelColumns along_z;
  };

  void erode_along_z(const VoxelColumns& from, int low, int high, VoxelColumns& to) const;
  template <int kAxis>
  void erode_across(const VoxelColumns& from, VoxelColumns& to);
  void erode_parts();

  VoxelWindow window_;
  bool beyond_;
  std::vector<VoxelColumns> along_;  // z, and y and z; of a window
  std::vector<Part> parts_;          // of a stencil that is none
  VoxelColumns whole_;
  ColumnSet hit_;  // columns to renew; empty between calls
};

}  // namespace frontlux::planner::detail
