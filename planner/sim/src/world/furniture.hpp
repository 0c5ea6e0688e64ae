#pragma once

#include "world/layout_random.hpp"
#include "world/solid.hpp"

namespace frontlux::sim {

/// Parts that several built-in worlds have. All lengths in decimetres.

/// The inside of a world: walls, floor and ceiling 3 dm thick around it.
void add_hall(Solid& solid, const Rect& inside, int height);

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

/// Solid stairs rising along x, from x.from to x.to or, if `down`, the other way round.
void add_stairs(Solid& solid, const Rect& rect, Span z, bool down);

/// A railing 11 dm high and 1 dm thick along a side of a floor.
void add_railing(Solid& solid, const Rect& rect, int floor);

/// A rack: uprights, boards every 15 dm along the longer side, goods on some of them.
/// @param goods percent of the places that hold something
void add_rack(Solid& solid, const Rect& rect, int levels, int goods, LayoutRandom& random);

/// A pile of boxes within the rectangle, from 6 to `height` dm high.
void add_pile(Solid& solid, const Rect& rect, int height, LayoutRandom& random);

}  // namespace frontlux::sim
