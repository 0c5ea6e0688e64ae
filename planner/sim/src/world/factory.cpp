#include "world/building.hpp"
#include "world/furniture.hpp"

#include <algorithm>

namespace frontlux::sim {
namespace {

constexpr Rect kInside = {{0, 450}, {0, 300}};
constexpr int kHeight = 90;
constexpr int kRoomsFrom = 242;   // y; the side rooms are north of it
constexpr Span kHall = {0, 240};  // y
constexpr int kDeck = 41;         // top of the mezzanine
constexpr int kUnderpass = 10;    // its height: the UGV fits, the UAV does not

// Side rooms along the north wall, each with a door to the hall and a cabinet or a table.
void add_side_rooms(Solid& solid, LayoutRandom& random) {
  constexpr int kRoomHeight = 30;
  const int rooms = random.whole(4, 6);
  solid.add(kInside.x, {kRoomsFrom - 2, kRoomsFrom}, {0, kRoomHeight + 2});
  solid.add(kInside.x, {kRoomsFrom, kInside.y.to}, {kRoomHeight, kRoomHeight + 2});
  int from = 0;
  for (int i = 0; i < rooms; ++i) {
    const bool last = i == rooms - 1;
    const int to = last ? kInside.x.to : kInside.x.to * (i + 1) / rooms + random.whole(-10, 10);
    if (!last) solid.add({to - 2, to}, {kRoomsFrom, kInside.y.to}, {0, kRoomHeight});
    const int inner_to = last ? to : to - 2;
    const int door = random.whole(from + 4, inner_to - kPassage - 4);
    cut_door(solid, {{door, door + kPassage + random.whole(0, 4)}, {kRoomsFrom - 2, kRoomsFrom}});
    const int at = random.whole(from + 2, inner_to - 20);
    const Rect place{{at, at + 18}, {kInside.y.to - 8, kInside.y.to}};
    random.chance(50) ? add_table(solid, place, 0) : solid.add(place, {0, random.whole(10, 20)});
    FloorPlan floor({{from, inner_to}, {kRoomsFrom, kInside.y.to - 8}});
    if (const auto crate = floor.place(random, Span{6, 12}, Span{6, 10}))
      add_pile(solid, *crate, random.whole(7, 18), random);
    from = to;
  }
}

// A deck over the south-west corner, on columns, with stairs along x and a railing.
Rect add_mezzanine(Solid& solid, LayoutRandom& random) {
  const Rect deck{{0, random.whole(85, 105)}, {0, random.whole(110, 150)}};
  solid.add(deck, {kDeck - 2, kDeck});
  for (const int x : {deck.x.middle(), deck.x.to - 4})
    for (int y = 26; y + 4 <= deck.y.to; y += 45) solid.add({x, x + 4}, {y, y + 4}, {0, kDeck - 2});
  const int stairs = random.whole(22, deck.y.to - 40);
  const Rect flight{{deck.x.to, deck.x.to + 62}, {stairs, stairs + 14}};
  add_stairs(solid, flight, {0, kDeck}, true);
  add_railing(solid, {deck.x, {deck.y.to - 1, deck.y.to}}, kDeck);
  add_railing(solid, {{deck.x.to - 1, deck.x.to}, {0, flight.y.from}}, kDeck);
  add_railing(solid, {{deck.x.to - 1, deck.x.to}, {flight.y.to, deck.y.to}}, kDeck);
  add_table(solid, {{10, 28}, {8, 16}}, kDeck);
  solid.add({0, 6}, {30, 30 + random.whole(20, 50)}, {kDeck, kDeck + 18});
  FloorPlan upstairs({{6, deck.x.to - 1}, {20, deck.y.to - 1}});
  for (int i = 0; i < 2; ++i)
    if (const auto crate = upstairs.place(random, 10, 10))
      solid.add(*crate, {kDeck, kDeck + random.whole(8, 16)});
  return flight;
}

// A machine: a body, a head on it and a console at its side.
void add_machine(Solid& solid, const Rect& rect, LayoutRandom& random) {
  const int body = random.whole(10, 16), head = body + random.whole(8, 14);
  const int split = rect.x.from + rect.x.length() * random.whole(4, 6) / 10;
  solid.add({rect.x.from, rect.x.to - 4}, rect.y, {0, body});
  solid.add({rect.x.from, split}, rect.y.grown(-2), {body, head});
  solid.add({rect.x.to - 4, rect.x.to}, {rect.y.from, rect.y.from + 5}, {0, 13});
  solid.add({split - 3, split - 1}, {rect.y.middle(), rect.y.middle() + 2},
            {head, head + random.whole(4, 12)});
}

// A belt with a skirt down to the floor and openings for the UGV.
void add_conveyor(Solid& solid, const Rect& rect, LayoutRandom& random) {
  solid.add(rect, {0, 13});
  solid.cut(rect.x, rect.y.grown(-2), {12, 13});
  for (const int part : {1, 2}) {
    const int at = rect.x.from + rect.x.length() * part / 3 + random.whole(-12, 12);
    solid.cut({at - 12, at + 12}, rect.y, {0, kUnderpass});
  }
  const int gate = rect.x.from + rect.x.length() / 2 + random.whole(-8, 8);
  for (const int y : {rect.y.from - 3, rect.y.to}) solid.add({gate, gate + 10}, {y, y + 3}, {0, 24});
  solid.add({gate, gate + 10}, {rect.y.from - 3, rect.y.to + 3}, {24, 28});
  for (int i = 0; i < 6; ++i) {
    const int at = random.whole(rect.x.from + 2, rect.x.to - 10);
    if (at < gate + 12 && at + 8 > gate - 2) continue;
    solid.add({at, at + random.whole(4, 7)}, rect.y.grown(-3), {12, random.whole(15, 18)});
  }
}

void add_ducts(Solid& solid, LayoutRandom& random) {
  constexpr Span kDuct = {60, 67};
  for (const int third : {0, 1}) {
    const int y = 60 + 110 * third + random.whole(-25, 25);
    const Span x = {random.whole(0, 60), random.whole(380, 450)};
    solid.add(x, {y, y + 8}, kDuct);
    for (int at = x.from + 10; at < x.to; at += 60)
      solid.add({at, at + 1}, {y + 3, y + 4}, {kDuct.to, kHeight});
    for (int branch = 0; branch < 2; ++branch) {
      const int at = random.whole(x.from + 20, x.to - 20);
      const bool up = third == 1;
      solid.add({at, at + 6}, up ? Span{y, kInside.y.to} : Span{random.whole(0, 30), y + 8}, {60, 66});
    }
  }
  for (int x = random.whole(20, 50); x < kInside.x.to; x += 75)
    solid.add({x, x + 3}, kInside.y, {82, kHeight});
}

}  // namespace

Building build_factory(std::uint64_t seed) {
  LayoutRandom random(seed);
  Building building = make_hall(kInside, kHeight);
  Solid& solid = building.solid;
  add_side_rooms(solid, random);
  const Rect flight = add_mezzanine(solid, random);

  // Shelving rows along y at the east end; the last stands at the wall.
  const int racks_from = 345;
  const int south = random.whole(22, 45), north = random.whole(170, 215);
  for (int x = racks_from; x <= 441; x += 32)
    add_rack(solid, {{x, x + 9}, {south, north}}, 3, random.whole(40, 80), random);

  // Everything between the deck and the shelves. The conveyor runs through the middle of it.
  const int west = flight.x.from;
  FloorPlan floor({{west, racks_from}, kHall});
  floor.occupy(flight);
  floor.occupy({{0, west + 2}, {0, flight.y.to + 120}});
  const int belt = random.whole(std::max(100, flight.y.to + 30), 180);
  const Rect conveyor{{west + random.whole(25, 40), racks_from - random.whole(25, 40)}, {belt, belt + 12}};
  add_conveyor(solid, conveyor, random);
  floor.occupy(conveyor.grown(3));
  building.start = floor.place(random, 12, 12).value().middle();
  for (int i = 0; i < 3; ++i) {
    const int diameter = 2 * random.whole(10, 16) + 1;
    if (const auto tank = floor.place(random, diameter, diameter))
      add_tank(solid, *tank, random.whole(30, 52));
  }
  for (int i = 0; i < 9; ++i)
    if (const auto machine = floor.place(random, Span{20, 40}, Span{14, 22}))
      add_machine(solid, *machine, random);

  // Under the deck and north of it.
  FloorPlan store({{0, west}, {160, kHall.to}});
  for (int i = 0; i < 3; ++i)
    if (const auto pile = store.place(random, Span{8, 16}, Span{8, 16}))
      add_pile(solid, *pile, random.whole(8, 25), random);
  add_table(solid, {{2, 10}, {4, 24}}, 0);

  add_ducts(solid, random);
  return building;
}

}  // namespace frontlux::sim
