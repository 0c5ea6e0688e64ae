#pragma once

#include "world/building.hpp"

#include <optional>
#include <vector>

namespace frontlux::sim {

/// Parts of several built-in worlds. All lengths in decimetres.

/// The distance between any two things on the floor [dm]. At voxels of 0.3 m it holds five whole ones
/// wherever it begins, as many as a UGV of 1 m needs.
constexpr int kPassage = 20;

/// A part of a floor. Things are placed on it with a passage around each, so none of it is ever cut off.
class FloorPlan {
 public:
  /// @param area between walls or other things: nothing is placed nearer than a passage to its sides
  explicit FloorPlan(const Rect& area) : area_(area) {}

  /// Nothing will be placed nearer than a passage to this.
  void occupy(const Rect& rect) { taken_.push_back(rect); }

  /// Draws a free rectangle of this size and occupies it; nothing if 300 draws found none.
  std::optional<Rect> place(LayoutRandom& random, int along_x, int along_y);
  /// The same for a piece whose sides are drawn, from and to inclusive. The order is part of the worlds: y
  /// before x.
  std::optional<Rect> place(LayoutRandom& random, Span along_x, Span along_y) {
    const int y = random.whole(along_y.from, along_y.to);
    return place(random, random.whole(along_x.from, along_x.to), y);
  }

 private:
  Rect area_;
  std::vector<Rect> taken_;
};

/// A world that is still empty: walls, floor and ceiling 3 dm thick around its inside.
[[nodiscard]] Building make_hall(const Rect& inside, int height);

/// A room of walls 2 dm thick and a ceiling slab of the same around `inside`. Cut its doors afterwards.
void add_room(Solid& solid, const Rect& inside, int height);

/// A door in the wall `wall`: as wide as the rectangle, 23 dm high.
void cut_door(Solid& solid, const Rect& wall);

/// A table: a plate 7 dm above the floor on four legs.
void add_table(Solid& solid, const Rect& rect, int floor);

/// A bench with its back along the side of greater y.
void add_bench(Solid& solid, const Rect& rect);

/// An upright tank, round as far as decimetres allow. @pre the rectangle is square
void add_tank(Solid& solid, const Rect& rect, int height);

/// Solid stairs rising along x, or falling if `down`.
void add_stairs(Solid& solid, const Rect& rect, Span z, bool down);

/// A railing 11 dm high and 1 dm thick along a side of a floor.
void add_railing(Solid& solid, const Rect& rect, int floor);

/// A rack: uprights, boards every 15 dm along the longer side, goods on some of them.
/// @param goods percent of the places that hold something
void add_rack(Solid& solid, const Rect& rect, int levels, int goods, LayoutRandom& random);

/// A pile of boxes within the rectangle, from 6 to `height` dm high.
void add_pile(Solid& solid, const Rect& rect, int height, LayoutRandom& random);

}  // namespace frontlux::sim
