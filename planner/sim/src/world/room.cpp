#include "world/building.hpp"
#include "world/furniture.hpp"

namespace frontlux::sim {
namespace {

constexpr Rect kInside = {{0, 120}, {0, 120}};
constexpr int kHeight = 30;

}  // namespace

Building build_room(std::uint64_t seed) {
  LayoutRandom random(seed);
  Building building = make_hall(kInside, kHeight);
  Solid& solid = building.solid;

  // A partition across the room with one door; the start is south of it.
  const int wall = random.whole(60, 75);
  const Span wall_y = {wall, wall + 2};
  solid.add(kInside.x, wall_y, {0, kHeight});
  const int door = random.whole(5, 120 - 20 - 5);
  cut_door(solid, {{door, door + kPassage}, wall_y});

  FloorPlan south({kInside.x, {0, wall}}), north({kInside.x, {wall + 2, 120}});
  building.start = south.place(random, 12, 12).value().middle();
  if (const auto pillar = south.place(random, 5, 5)) solid.add(*pillar, {0, kHeight});
  if (const auto table = random.chance(50) ? south.place(random, 16, 8) : south.place(random, 8, 16))
    add_table(solid, *table, 0);
  // Along the north wall, where it needs no passage behind.
  const int shelf = random.whole(0, 70);
  const Rect against_wall{{shelf, shelf + 50}, {114, 120}};
  add_rack(solid, against_wall, 1, 70, random);
  solid.add(against_wall, {14, 15});
  if (const auto pile = north.place(random, 9, 9)) {
    if (!pile->grown(kPassage).overlaps(against_wall)) add_pile(solid, *pile, random.whole(8, 20), random);
  }
  const int locker = random.whole(0, 1) == 0 ? 0 : 115;
  solid.add({locker, locker + 5}, {0, 12}, {0, 18});
  return building;
}

}  // namespace frontlux::sim
