#include "modules.hpp"

#include <frontlux/synthetic/scene.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace frontlux::synthetic {
namespace {

// All in modules of 0.3 m. The walls on the lower lines lie within the outer walls.
constexpr Rect kPlan{-127, -127, 126, 126};
constexpr int kStoreys = 2;
constexpr int kPitch = 16;
constexpr int kSlab = 1;
constexpr int kHeight = kStoreys * kPitch - kSlab;
constexpr int kCorridorWidth = 10;
constexpr int kDoorHead = 7;

enum class Use { kRoom, kCorridor, kHall };

struct Space {
  Rect rect;
  Use use = Use::kRoom;
  bool tall = false;  // as high as the house
};

// A stretch of wall line between two neighbouring spaces.
struct Border {
  WallLine line;
  std::size_t a = 0, b = 0;
};

void split(const Rect& rect, bool tall, Random& random, std::vector<Space>& spaces) {
  constexpr int kShortest = 24;
  const bool across_x = rect.width() >= rect.depth();
  const int length = across_x ? rect.width() : rect.depth();
  if (length < 2 * kShortest + random.whole(0, 20)) {
    spaces.push_back({rect, Use::kRoom, tall});
    return;
  }
  const int cut = random.whole(kShortest, length - kShortest);
  Rect first = rect, second = rect;
  if (across_x) {
    first.x1 = second.x0 = rect.x0 + cut;
  } else {
    first.y1 = second.y0 = rect.y0 + cut;
  }
  split(first, tall, random, spaces);
  split(second, tall, random, spaces);
}

// The hall in the middle, a corridor around it, four more from there to the outer walls, rooms in between. On
// the east side they are as high as the house, so that the upper storey has none there.
std::vector<Space> plan_storey(int storey, const Rect& hall, Random& random) {
  const Rect ring = hall.grown(kCorridorWidth);
  const Rect& all = kPlan;
  const int west = random.whole(hall.y0, hall.y1 - kCorridorWidth);
  const int east = random.whole(hall.y0, hall.y1 - kCorridorWidth);
  const int south = random.whole(hall.x0 + 13, hall.x1 - kCorridorWidth - 13);
  const int north = random.whole(hall.x0 + 13, hall.x1 - kCorridorWidth - 13);
  std::vector<Space> spaces{{hall, Use::kHall},
                            {{ring.x0, ring.y0, hall.x0, ring.y1}, Use::kCorridor},
                            {{hall.x1, ring.y0, ring.x1, ring.y1}, Use::kCorridor},
                            {{hall.x0, ring.y0, hall.x1, hall.y0}, Use::kCorridor},
                            {{hall.x0, hall.y1, hall.x1, ring.y1}, Use::kCorridor},
                            {{all.x0, west, ring.x0, west + kCorridorWidth}, Use::kCorridor},
                            {{south, all.y0, south + kCorridorWidth, ring.y0}, Use::kCorridor},
                            {{north, ring.y1, north + kCorridorWidth, all.y1}, Use::kCorridor}};
  split({all.x0, all.y0, ring.x0, west}, false, random, spaces);
  split({all.x0, west + kCorridorWidth, ring.x0, all.y1}, false, random, spaces);
  split({ring.x0, all.y0, south, ring.y0}, false, random, spaces);
  split({south + kCorridorWidth, all.y0, ring.x1, ring.y0}, false, random, spaces);
  split({ring.x0, ring.y1, north, all.y1}, false, random, spaces);
  split({north + kCorridorWidth, ring.y1, ring.x1, all.y1}, false, random, spaces);
  if (storey == 0) {
    spaces.push_back({{ring.x1, east, all.x1, east + kCorridorWidth}, Use::kCorridor, true});
    split({ring.x1, all.y0, all.x1, east}, true, random, spaces);
    split({ring.x1, east + kCorridorWidth, all.x1, all.y1}, true, random, spaces);
  }
  return spaces;
}

std::vector<Border> find_borders(const std::vector<Space>& spaces) {
  std::vector<Border> borders;
  for (std::size_t a = 0; a < spaces.size(); ++a) {
    for (std::size_t b = 0; b < spaces.size(); ++b) {
      const Rect &p = spaces[a].rect, &q = spaces[b].rect;
      const int y0 = std::max(p.y0, q.y0), y1 = std::min(p.y1, q.y1);
      const int x0 = std::max(p.x0, q.x0), x1 = std::min(p.x1, q.x1);
      if (p.x1 == q.x0 && y0 < y1) borders.push_back({{true, p.x1, y0, y1}, a, b});
      if (p.y1 == q.y0 && x0 < x1) borders.push_back({{false, p.y1, x0, x1}, a, b});
    }
  }
  return borders;
}

std::size_t root(const std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i];
  return i;
}

std::vector<Opening> door(const WallLine& line, Random& random) {
  constexpr int kJamb = 2;
  const int longest = line.to - line.from - 2 * kJamb;
  const int width = random.whole(4, 6);
  if (longest < width) return {};
  const int from = line.from + kJamb + random.whole(0, longest - width);
  return {{from, from + width, 0, kDoorHead}};
}

// Pillars with openings between them: gates below, balustrades above.
std::vector<Opening> arcade(const WallLine& line, int sill) {
  std::vector<Opening> openings;
  for (int from = line.from + 4; from + 13 <= line.to - 3; from += 20)
    openings.push_back({from, from + 13, sill, 12});
  return openings;
}

std::vector<Rect> hall_pillars(const Rect& hall) {
  std::vector<Rect> pillars;
  for (int x = hall.x0 + 13; x < hall.x1 - 7; x += 23) {
    for (int y = hall.y0 + 13; y < hall.y1 - 7; y += 23) pillars.push_back({x, y, x + 2, y + 2});
  }
  return pillars;
}

void build_storey(int storey, const Rect& hall, Random& random, Modules& solids) {
  const std::vector<Space> spaces = plan_storey(storey, hall, random);
  std::vector<Border> borders = find_borders(spaces);
  for (std::size_t i = borders.size(); i > 1; --i)
    std::swap(borders[i - 1], borders[static_cast<std::size_t>(random.whole(0, static_cast<int>(i) - 1))]);
  const int floor = storey * kPitch;
  std::vector<std::size_t> parent(spaces.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  std::vector<Rect> keep_clear = hall_pillars(hall);
  for (const Border& border : borders) {
    const Use a = spaces[border.a].use, b = spaces[border.b].use;
    std::vector<Opening> openings;
    if (a == Use::kHall || b == Use::kHall) {
      openings = arcade(border.line, storey == 0 ? 0 : 3);
    } else if (a == Use::kCorridor && b == Use::kCorridor) {
      parent[root(parent, border.a)] = root(parent, border.b);
      keep_clear.push_back(module_passage(border.line, {border.line.from, border.line.to}));
      // The storey above ends here.
      if (spaces[border.a].tall != spaces[border.b].tall)
        solids.add_wall(border.line, {floor + kPitch, kHeight}, {});
      continue;
    } else if (root(parent, border.a) != root(parent, border.b) || random.one_in(5)) {
      openings = door(border.line, random);
    }
    if (!openings.empty()) parent[root(parent, border.a)] = root(parent, border.b);
    for (const Opening& opening : openings) keep_clear.push_back(module_passage(border.line, opening));
    const bool tall = spaces[border.a].tall || spaces[border.b].tall;
    solids.add_wall(border.line, {floor, tall ? kHeight : floor + kPitch - kSlab}, openings);
  }
  for (const Space& space : spaces) {
    if (space.use == Use::kHall && storey > 0) continue;
    const int area = space.rect.width() * space.rect.depth();  // [modules^2]
    const int count = area / (space.use == Use::kRoom ? 45 : 110);
    solids.add_furniture(space.rect, floor, count, keep_clear, random);
  }
}

// The floor of the storey above the hall's, as far as that has one. Its pieces overlap by a module.
void add_slab_around(const Rect& hall, const Rise& slab, Modules& solids) {
  const Rect hole = between_walls(hall);
  const int y1 = kPlan.y1 + 1, x1 = hall.x1 + kCorridorWidth + 1;
  solids.add({kPlan.x0, kPlan.y0, hole.x0, y1}, slab);
  solids.add({hole.x1, kPlan.y0, x1, y1}, slab);
  solids.add({hole.x0 - 1, kPlan.y0, hole.x1 + 1, hole.y0}, slab);
  solids.add({hole.x0 - 1, hole.y1, hole.x1 + 1, y1}, slab);
}

}  // namespace

Scene make_building_scene(std::uint64_t seed) {
  Random random(seed);
  const int half_x = random.whole(53, 63);
  const int half_y = random.whole(63, 73);
  const Rect hall{-half_x, -half_y, half_x, half_y};

  Modules solids;
  solids.add_shell(between_walls(kPlan), {0, kHeight});
  std::vector<double> floors;
  for (int storey = 0; storey < kStoreys; ++storey) {
    const int floor = storey * kPitch;
    floors.push_back(Modules::kEdge * floor - Modules::kInset);
    build_storey(storey, hall, random, solids);
    if (storey > 0) add_slab_around(hall, {floor - kSlab, floor}, solids);
  }
  for (const Rect& pillar : hall_pillars(hall)) solids.add(pillar, {-1, kHeight + 1});
  const Rect inside = between_walls(kPlan);
  const Eigen::Vector3d inset = Eigen::Vector3d::Constant(Modules::kInset);
  const Box room(Modules::kEdge * Eigen::Vector3d(inside.x0, inside.y0, 0) - inset,
                 Modules::kEdge * Eigen::Vector3d(inside.x1, inside.y1, kHeight) + inset);
  return {BoxSet(std::move(solids.boxes)), room, std::move(floors)};
}

}  // namespace frontlux::synthetic
