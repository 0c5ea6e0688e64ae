#include "world/building.hpp"
#include "world/furniture.hpp"

#include <vector>

namespace frontlux::sim {
namespace {

constexpr Rect kInside = {{0, 250}, {0, 150}};
constexpr int kHeight = 60, kRackDepth = 8, kAisles = 4;
constexpr int kNarrowAisle = 18, kWideAisle = 25;
constexpr Span kRacks = {22, 178};  // along x

}  // namespace

Building build_storage(std::uint64_t seed) {
  LayoutRandom random(seed);
  Building building = make_hall(kInside, kHeight);
  Solid& solid = building.solid;

  // Racks along the walls, pairs between the aisles; a cross aisle cuts through all but the outermost.
  std::vector<int> aisle(kAisles, kNarrowAisle);
  random.widen(aisle, kWideAisle, kInside.y.to - 2 * kAisles * kRackDepth - kAisles * kNarrowAisle);
  const int cross = random.whole(kRacks.from + 40, kRacks.to - 40 - kPassage);
  int y = 0;
  for (int row = 0; row < 2 * kAisles; ++row) {
    const Span depth = {y, y + kRackDepth};
    y = depth.to;
    const int goods = random.whole(35, 85);
    const int levels = random.whole(2, 3);
    if (row == 0 || row == 2 * kAisles - 1) {
      add_rack(solid, {kRacks, depth}, levels, goods, random);
    } else {
      add_rack(solid, {{kRacks.from, cross}, depth}, levels, goods, random);
      add_rack(solid, {{cross + kPassage + 2, kRacks.to}, depth}, levels, goods, random);
    }
    if (row % 2 == 0) y += aisle[static_cast<std::size_t>(row / 2)];
  }

  // The office: its walls stand in the corner of the hall.
  const bool south = random.chance(50);
  const int width = random.whole(38, 46), depth = random.whole(40, 55);
  const Span office_y = south ? Span{0, depth} : Span{kInside.y.to - depth, kInside.y.to};
  const Rect office{{kInside.x.to - width, kInside.x.to}, office_y};
  add_room(solid, office, 27);
  const Span front = south ? Span{depth, depth + 2} : Span{office_y.from - 2, office_y.from};
  const int door = random.whole(office.x.from + 3, office.x.to - kPassage - 3);
  cut_door(solid, {{door, door + kPassage}, front});
  solid.cut({office.x.from - 2, office.x.from}, {office_y.middle() - 8, office_y.middle() + 8}, {11, 21});
  const Span desk_y = south ? Span{0, 8} : Span{kInside.y.to - 8, kInside.y.to};
  add_table(solid, {{office.x.to - 18, office.x.to - 2}, desk_y}, 0);
  solid.add({office.x.from, office.x.from + 10}, south ? Span{0, 5} : Span{kInside.y.to - 5, kInside.y.to},
            {0, 20});

  // The rest of that end of the hall is for goods that come and go.
  const Span yard_y = south ? Span{office.y.to + 2, kInside.y.to} : Span{0, office.y.from - 2};
  constexpr int kBay = 12;  // goods along the east wall, which need no passage behind
  for (int at = yard_y.from + kPassage; at + kBay + 3 < yard_y.to - kPassage; at += kBay + random.whole(1, 5))
    if (random.chance(60))
      add_pile(solid, {{kInside.x.to - kBay, kInside.x.to}, {at, at + kBay}}, random.whole(6, 24), random);
  FloorPlan yard({{kRacks.to, kInside.x.to - kBay}, yard_y});
  building.start = yard.place(random, 12, 12).value().middle();
  for (int i = 0; i < 4; ++i)
    if (const auto pallet = yard.place(random, Span{8, 14}, Span{8, 12}))
      add_pile(solid, *pallet, random.whole(6, 22), random);

  for (int x = random.whole(20, 35); x < kInside.x.to; x += 50) solid.add({x, x + 2}, kInside.y, {55, 58});
  return building;
}

}  // namespace frontlux::sim
