#pragma once

#include "corridor/erosion.hpp"

#include <frontlux/voxel_grid.hpp>

#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Where what is known of the floor carries a robot.
///
/// A voxel of floor does if one near it is known to be the ground, and none under the robot is known to be a
/// hole: free, with no ground a little above or below it, and none on both sides within the width of a gap
/// that the robot gets over. Where floor need not be known and ground has several heights, only a hole of two
/// voxels counts.
class Terrain {
 public:
  struct Options {
    KeyBox box;                  ///< of the floor; beyond it is unknown
    int half_x = 0, half_y = 0;  ///< [voxels] from the middle, within which there may be no hole
    int reach = 1;               ///< [voxels] from the middle: ground has to be within it
    int above = 0, below = 0;    ///< [voxels] along z: where there is ground, there is no hole
    /// [voxels] How far ground may be below the middle. If it is not given, ground is any occupied voxel at
    /// the height of the middle; else one on top of which none is occupied.
    std::optional<int> depth = {};
    int gap_width = 0;                ///< [voxels] gaps along x or y that are no wider are no holes
    std::vector<KeyBox> exempt = {};  ///< where floor need not be known, but holes all around count
  };
  explicit Terrain(Options options);

  void read(const VoxelGrid& grid);
  void read(const VoxelGrid& grid, std::span<const VoxelKey> changed);

  /// @param floor  the voxel below the middle of the robot
  [[nodiscard]] bool carries(const VoxelKey& floor) const;

 private:
  // Holes and ground before gaps are closed.
  struct Gaps {
    VoxelColumns holes;     // free without ground
    VoxelColumns grounded;  // ground a little above or below
  };
  // Of a robot on ground of several heights, where floor need not be known.
  struct StartArea {
    VoxelColumns filled;  // no holes of two voxels
    Erosion level;
  };

  void decide();
  void close_gaps();
  [[nodiscard]] bool is_open_all_around(const VoxelKey& floor) const;

  Options options_;
  VoxelColumns free_, occupied_;
  std::optional<Gaps> gaps_;  // if some are bridged
  VoxelColumns no_hole_, no_ground_;
  Erosion level_, without_ground_;
  std::optional<StartArea> start_area_;
};

}  // namespace frontlux::planner::detail
