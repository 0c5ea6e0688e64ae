#pragma once

#include "floor_plan.hpp"

#include <frontlux/synthetic/box_set.hpp>
#include <frontlux/synthetic/random.hpp>

#include <vector>

namespace frontlux::synthetic {

/// Collects the boxes of a scene drawn in whole modules of 0.3 m, whose edges are voxel faces of a map with a
/// resolution of 0.1 m or 0.3 m. Every face is then pulled a little into its solid: surfaces lie just inside
/// their solid's own first layer of voxels, not between the voxels and not in the middle of one.
///
/// So that this opens no crack, solids are drawn one module into what they stand on or lean against.
///
/// Rects, rises, lines and openings are in modules. A wall on a line at n fills the module from n to n + 1.
class Modules {
 public:
  static constexpr double kEdge = 0.3;    ///< [m]
  static constexpr double kInset = 0.03;  ///< [m] from a module's edge to the face of the solid

  void add(const Rect& rect, const Rise& rise);

  /// Floor, roof and outer walls around `inside`, 1 and 2 modules thick.
  void add_shell(const Rect& inside, const Rise& rise);

  /// A wall with openings, one module into floor, ceiling and the crossing wall at its end.
  /// @pre openings in order, two modules or more apart from each other and from the line's ends
  void add_wall(const WallLine& line, const Rise& rise, const std::vector<Opening>& openings);

  /// Crates, shelves and tables in a room, as far as `count` tries find room beside each other and in front
  /// of the doors.
  /// @param space  between wall lines
  void add_furniture(const Rect& space, int floor, int count, std::vector<Rect>& keep_clear, Random& random);

  std::vector<Box> boxes;
};

/// What the walls on its lines leave of a space.
[[nodiscard]] inline Rect between_walls(const Rect& space) {
  return {space.x0 + 1, space.y0 + 1, space.x1, space.y1};
}

/// What has to stay free before and behind an opening.
[[nodiscard]] Rect module_passage(const WallLine& line, const Opening& opening);

}  // namespace frontlux::synthetic
