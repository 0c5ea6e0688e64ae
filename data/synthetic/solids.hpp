#pragma once

#include <frontlux/synthetic/box_set.hpp>
#include <frontlux/synthetic/random.hpp>

#include <vector>

namespace frontlux::synthetic {

// Plans are drawn in whole decimetres, so that walls meet without rounding.

/// A rectangle on a storey's plan [dm].
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int depth() const { return y1 - y0; }
  [[nodiscard]] Rect grown(int by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
  [[nodiscard]] bool overlaps(const Rect& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};

/// A range of heights [dm].
struct Rise {
  int z0 = 0, z1 = 0;
};

/// A straight piece of wall's centre line: at x = `at` along y if `along_y`, else at y = `at` along x [dm].
struct WallLine {
  bool along_y = false;
  int at = 0, from = 0, to = 0;
};

/// A hole in a wall: positions along the wall's line, heights above the floor [dm].
struct Opening {
  int from = 0, to = 0, sill = 0, head = 0;
};

/// [m] of a plan's coordinate.
inline double metres(int decimetres) { return 0.1 * decimetres - 0.07; }

/// Collects the boxes of a scene.
class Solids {
 public:
  static constexpr int kHalfWall = 1;  ///< [dm] half the thickness of an inner wall

  void add(const Rect& rect, const Rise& rise);

  /// Floor, roof and outer walls around `inside`, 3 dm and 5 dm thick.
  void add_shell(const Rect& inside, const Rise& rise);

  /// A wall with openings. @pre openings in order, apart from each other, within the line
  void add_wall(const WallLine& line, const Rise& rise, const std::vector<Opening>& openings);

  /// Crates, shelves and tables in a room, as far as `count` tries find room beside each other and in front
  /// of the doors.
  void add_furniture(const Rect& space, int floor, int count, std::vector<Rect> keep_clear, Random& random);

  std::vector<Box> boxes;
};

/// What has to stay free before and behind an opening [dm].
[[nodiscard]] Rect passage(const WallLine& line, const Opening& opening);

}  // namespace frontlux::synthetic
