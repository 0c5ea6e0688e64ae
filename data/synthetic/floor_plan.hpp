#pragma once

namespace frontlux::synthetic {

// Plans are drawn in whole units, decimetres or modules, so that walls meet without rounding.

/// A rectangle on a storey's plan.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int depth() const { return y1 - y0; }
  [[nodiscard]] Rect grown(int by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
  [[nodiscard]] bool overlaps(const Rect& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};

/// A range of heights.
struct Rise {
  int z0 = 0, z1 = 0;
};

/// A straight piece of wall's centre line: at x = `at` along y if `along_y`, else at y = `at` along x.
struct WallLine {
  bool along_y = false;
  int at = 0, from = 0, to = 0;
};

/// A hole in a wall: positions along the wall's line, heights above the floor.
struct Opening {
  int from = 0, to = 0, sill = 0, head = 0;
};

}  // namespace frontlux::synthetic
