#pragma once

#include <frontlux/sim/world.hpp>

#include <vector>

namespace frontlux::sim {

/// Units of built-in worlds: whole decimetres, so that walls meet exactly. From 0 to 30 is 3 m.
struct Span {
  int from = 0, to = 0;
  [[nodiscard]] int length() const { return to - from; }
  [[nodiscard]] int middle() const { return (from + to) / 2; }
  [[nodiscard]] Span grown(int by) const { return {from - by, to + by}; }
  /// Turned round within `frame`.
  [[nodiscard]] Span mirrored(const Span& frame) const {
    return {frame.from + frame.to - to, frame.from + frame.to - from};
  }
};

/// Seen from above.
struct Rect {
  Span x, y;
  [[nodiscard]] Rect grown(int by) const { return {x.grown(by), y.grown(by)}; }
  /// On the floor.
  [[nodiscard]] Eigen::Vector3i middle() const { return {x.middle(), y.middle(), 0}; }
  /// Touching does not count.
  [[nodiscard]] bool overlaps(const Rect& other) const {
    return x.from < other.x.to && other.x.from < x.to && y.from < other.y.to && other.y.from < y.to;
  }
};

/// What a world is built from: boxes added and cut away, the later ones over the earlier ones.
///
/// In the world, decimetre i lies at i / 10 + 0.04 m along x and y and at i / 10 - 0.05 m along z. No such
/// place is nearer than 4 cm to a face of voxels of 0.1, 0.2 or 0.3 m, and the floor, at 0, lies right.
class Solid {
 public:
  /// Empty spans add nothing.
  void add(Span x, Span y, Span z) { steps_.push_back({x, y, z, true}); }
  void add(const Rect& rect, Span z) { add(rect.x, rect.y, z); }
  void cut(Span x, Span y, Span z) { steps_.push_back({x, y, z, false}); }
  void cut(const Rect& rect, Span z) { cut(rect.x, rect.y, z); }

  /// Turns everything built so far left to right or front to back, within `frame`.
  void mirror(const Rect& frame, bool x, bool y);

  /// The surface of all that is left, facing outwards.
  [[nodiscard]] TriangleMesh surface() const;

 private:
  struct Step {
    Span x, y, z;
    bool add;
  };
  std::vector<Step> steps_;
};

/// A place in a built-in world [m].
[[nodiscard]] Eigen::Vector3d metres(const Eigen::Vector3i& place);

}  // namespace frontlux::sim
