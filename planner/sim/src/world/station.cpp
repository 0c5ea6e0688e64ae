#include "world/building.hpp"
#include "world/furniture.hpp"

#include <algorithm>
#include <vector>

namespace frontlux::sim {
namespace {

// A terminus: platforms and tracks in the west end at a concourse in the east.
constexpr Rect kInside = {{0, 800}, {0, 400}};
constexpr int kHeight = 120;
constexpr int kTrackBed = -11, kPlatform = 0;
constexpr int kDeck = 48;  // top of the mezzanine
constexpr int kColumnPitch = 60, kColumn = 4;
constexpr int kTruss = 100;  // its lower chord

struct Layout {
  int head = 0;  // x where the tracks end
  Span trench;   // y of the tracks
  Rect deck;     // the mezzanine
  Rect flight;   // its stairs
};

void add_shell(Solid& solid, const Layout& plan) {
  solid.add(kInside.grown(3), {kTrackBed - 3, kHeight + 3});
  solid.cut(kInside, {kPlatform, kHeight});
  solid.cut({0, plan.head}, plan.trench, {kTrackBed, kPlatform});
}

// Cars on both tracks, with a gap between them, and a buffer stop at the end of each.
void add_trains(Solid& solid, const Layout& plan, LayoutRandom& random) {
  constexpr int kCarWidth = 29, kFromEdge = 3, kCoupling = 6;
  for (const bool north : {false, true}) {
    const int y = north ? plan.trench.to - kFromEdge - kCarWidth : plan.trench.from + kFromEdge;
    for (const int rail : {y + 7, y + 21})
      solid.add({0, plan.head - 8}, {rail, rail + 1}, {kTrackBed, kTrackBed + 2});
    solid.add({plan.head - 8, plan.head}, {y + 5, y + 24}, {kTrackBed, 2});
    const int cars = random.whole(2, 3), length = random.whole(110, 140);
    int to = plan.head - random.whole(15, 60);
    for (int i = 0; i < cars; ++i, to -= length + kCoupling) {
      const Span x = {std::max(2, to - length), to};
      solid.add(x, {y, y + kCarWidth}, {-6, 30});
      for (const int wheels : {x.from + 15, x.to - 35})
        solid.add({wheels, wheels + 20}, {y + 5, y + 24}, {kTrackBed, -6});
      solid.add(x.grown(-10), {y + 8, y + 21}, {30, 33});
      if (i + 1 < cars) solid.add({x.from - kCoupling, x.from}, {y + 13, y + 16}, {-3, 0});
    }
  }
}

// The deck lies over the concourse's east end, its stairs come down towards the tracks.
void add_mezzanine(Solid& solid, const Layout& plan, LayoutRandom& random) {
  const Rect& deck = plan.deck;
  solid.add(deck, {kDeck - 3, kDeck});
  for (int y = deck.y.from + 28; y + kColumn < deck.y.to - 10; y += kColumnPitch)
    for (const int x : {deck.x.from + 2, deck.x.from + 47})
      solid.add({x, x + kColumn}, {y, y + kColumn}, {kPlatform, kDeck - 3});
  add_stairs(solid, plan.flight, {kPlatform, kDeck}, false);
  add_railing(solid, {{deck.x.from, deck.x.from + 1}, {deck.y.from, plan.flight.y.from}}, kDeck);
  add_railing(solid, {{deck.x.from, deck.x.from + 1}, {plan.flight.y.to, deck.y.to}}, kDeck);
  // Shops upstairs at the east wall, open towards the deck.
  for (int y = 5 + random.whole(0, 20); y + 50 < deck.y.to; y += random.whole(70, 100)) {
    const Rect shop{{deck.x.to - 30, deck.x.to}, {y, y + 46}};
    solid.add(shop, {kDeck, kDeck + 30});
    solid.cut({shop.x.from + 2, shop.x.to}, shop.y.grown(-2), {kDeck, kDeck + 28});
    const int door = random.whole(y + 4, y + 20);
    solid.cut({shop.x.from, shop.x.from + 2}, {door, door + 22}, {kDeck, kDeck + 24});
  }
}

// Two rows, a passage away from the edge of the platforms.
std::vector<Rect> columns(const Layout& plan) {
  std::vector<Rect> all;
  for (const int y : {plan.trench.from - 26, plan.trench.to + 22})
    for (int x = 30; x + kColumn < plan.deck.x.from - 20; x += kColumnPitch)
      if (const Rect column{{x, x + kColumn}, {y, y + kColumn}};
          !column.grown(kPassage).overlaps(plan.flight))
        all.push_back(column);
  return all;
}

void add_columns_and_roof(Solid& solid, const Layout& plan) {
  for (const Rect& column : columns(plan)) solid.add(column, {kPlatform, kTruss});
  for (int x = 30; x < kInside.x.to; x += 2 * kColumnPitch) {
    solid.add({x, x + 3}, kInside.y, {kTruss, kTruss + 3});
    for (int y = 20; y < kInside.y.to; y += 40) solid.add({x + 1, x + 2}, {y, y + 2}, {kTruss + 3, kHeight});
  }
  for (int y = 40; y < kInside.y.to; y += 80) solid.add(kInside.x, {y, y + 2}, {kTruss + 10, kTruss + 12});
}

// A kiosk: walls around a floor, a wide door, a counter window opposite.
void add_kiosk(Solid& solid, const Rect& rect, LayoutRandom& random) {
  solid.add(rect, {kPlatform, 27});
  solid.cut(rect.grown(-2), {kPlatform, 25});
  const bool west = random.chance(50);
  const Span wall_west = {rect.x.from, rect.x.from + 2}, wall_east = {rect.x.to - 2, rect.x.to};
  const int middle = rect.y.middle();
  cut_door(solid, {west ? wall_west : wall_east, {middle - 11, middle + 11}});
  solid.cut(west ? wall_east : wall_west, {middle - 9, middle + 9}, {11, 20});
}

void furnish_platforms(Solid& solid, const Layout& plan, LayoutRandom& random) {
  for (const Span y : {Span{0, plan.trench.from - 26}, Span{plan.trench.to + 26, kInside.y.to}}) {
    FloorPlan platform({{0, plan.head - 30}, y});
    for (int i = 0; i < 7; ++i)
      if (const auto bench = platform.place(random, 18, 6)) add_bench(solid, *bench);
    for (int i = 0; i < 3; ++i)
      if (const auto box = platform.place(random, Span{6, 14}, Span{5, 8}))
        solid.add(*box, {kPlatform, random.whole(10, 22)});  // vending machines, ticket machines, boards
  }
}

void furnish_concourse(Solid& solid, const Layout& plan, LayoutRandom& random, Building& building) {
  // A row of gates between platforms and concourse; every gap is a passage, those around columns too.
  const int gates = plan.head + 25;
  const auto stand = columns(plan);
  for (int y = 22; y + 14 < kInside.y.to - 20; y += 14 + kPassage + 4) {
    const Rect gate{{gates, gates + 5}, {y, y + 14}};
    if (std::none_of(stand.begin(), stand.end(),
                     [&](const Rect& column) { return gate.grown(kPassage).overlaps(column); }))
      solid.add(gate, {0, 12});
  }

  FloorPlan floor({{gates + 5, plan.deck.x.from + 30}, kInside.y});
  floor.occupy(plan.flight);
  for (const Rect& column : stand) floor.occupy(column);
  floor.occupy({{plan.deck.x.from, kInside.x.to}, kInside.y});
  building.start = floor.place(random, 12, 12).value().middle();
  for (int i = 0; i < 4; ++i)
    if (const auto kiosk = floor.place(random, Span{32, 44}, Span{30, 44})) add_kiosk(solid, *kiosk, random);
  for (int i = 0; i < 8; ++i)
    if (const auto bench = floor.place(random, 18, 6)) add_bench(solid, *bench);
  for (int i = 0; i < 3; ++i)
    if (const auto pillar = floor.place(random, 8, 8)) solid.add(*pillar, {kPlatform, random.whole(18, 40)});

  // Rooms below the deck, at the east wall.
  for (int y = random.whole(0, 30); y + 60 < kInside.y.to; y += random.whole(75, 110)) {
    const Rect room{{kInside.x.to - 50, kInside.x.to}, {y, y + random.whole(45, 58)}};
    solid.add(room, {kPlatform, kDeck - 3});
    solid.cut({room.x.from + 2, room.x.to}, room.y.grown(-2), {kPlatform, 30});
    const int door = random.whole(y + 4, room.y.to - 4 - kPassage);
    cut_door(solid, {{room.x.from, room.x.from + 2}, {door, door + kPassage}});
  }
}

}  // namespace

Building build_station(std::uint64_t seed) {
  LayoutRandom random(seed);
  Building building;
  building.inside = kInside;
  Layout plan;
  plan.head = random.whole(440, 500);
  const int middle = random.whole(185, 215), half = random.whole(62, 75);
  plan.trench = {middle - half, middle + half};
  plan.deck = {{random.whole(640, 670), kInside.x.to}, kInside.y};
  const int stairs = random.whole(25, 355);
  plan.flight = {{plan.deck.x.from - 72, plan.deck.x.from}, {stairs, stairs + 22}};
  add_shell(building.solid, plan);
  add_trains(building.solid, plan, random);
  add_mezzanine(building.solid, plan, random);
  add_columns_and_roof(building.solid, plan);
  furnish_platforms(building.solid, plan, random);
  furnish_concourse(building.solid, plan, random, building);
  return building;
}

}  // namespace frontlux::sim
