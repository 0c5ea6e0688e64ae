#pragma once

#include "world/layout_random.hpp"
#include "world/solid.hpp"

#include <optional>
#include <vector>

namespace frontlux::sim {

/// Free in the clear between any two things on the floor [dm]: at 0.3 m voxels, five whole ones lie within it
/// wherever it begins, which is what a UGV of 1 m takes.
constexpr int kPassage = 20;

/// A part of a floor that things are placed on, each with a passage all around. So whatever is placed, no
/// part of the floor is cut off.
class FloorPlan {
 public:
  /// @param area between walls or other things: nothing is placed nearer than a passage to its sides
  explicit FloorPlan(const Rect& area) : area_(area) {}

  /// Nothing will be placed nearer than a passage to this.
  void occupy(const Rect& rect) { taken_.push_back(rect); }

  /// Finds a place of this size and occupies it; nothing if no place was found in 300 draws.
  std::optional<Rect> place(LayoutRandom& random, int along_x, int along_y);

 private:
  Rect area_;
  std::vector<Rect> taken_;
};

}  // namespace frontlux::sim
