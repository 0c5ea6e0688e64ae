#include "world/furniture.hpp"

#include <algorithm>

namespace frontlux::sim {
namespace {

constexpr int kOuterWall = 3, kInnerWall = 2, kDoorHeight = 23, kBay = 25, kShelf = 15;

}  // namespace

std::optional<Rect> FloorPlan::place(LayoutRandom& random, int along_x, int along_y) {
  const Rect inner = area_.grown(-kPassage);
  if (inner.x.length() < along_x || inner.y.length() < along_y) return std::nullopt;
  for (int draw = 0; draw < 300; ++draw) {
    const int x = random.whole(inner.x.from, inner.x.to - along_x);
    const int y = random.whole(inner.y.from, inner.y.to - along_y);
    const Rect rect{{x, x + along_x}, {y, y + along_y}};
    if (std::none_of(taken_.begin(), taken_.end(), [with_passage = rect.grown(kPassage)](const Rect& other) {
          return with_passage.overlaps(other);
        })) {
      taken_.push_back(rect);
      return rect;
    }
  }
  return std::nullopt;
}

Building make_hall(const Rect& inside, int height) {
  Building hall;
  hall.inside = inside;
  hall.solid.add(inside.grown(kOuterWall), {-kOuterWall, height + kOuterWall});
  hall.solid.cut(inside, {0, height});
  return hall;
}

void add_room(Solid& solid, const Rect& inside, int height) {
  solid.add(inside.grown(kInnerWall), {0, height + kInnerWall});
  solid.cut(inside, {0, height});
}

void cut_door(Solid& solid, const Rect& wall) { solid.cut(wall, {0, kDoorHeight}); }

void add_table(Solid& solid, const Rect& rect, int floor) {
  for (const int x : {rect.x.from, rect.x.to - 1})
    for (const int y : {rect.y.from, rect.y.to - 1}) solid.add({x, x + 1}, {y, y + 1}, {floor, floor + 7});
  solid.add(rect, {floor + 7, floor + 8});
}

void add_bench(Solid& solid, const Rect& rect) {
  solid.add(rect, {4, 5});
  solid.add(rect.x, {rect.y.to - 1, rect.y.to}, {4, 10});
  for (const int x : {rect.x.from, rect.x.middle(), rect.x.to - 1}) solid.add({x, x + 1}, rect.y, {0, 4});
}

void add_tank(Solid& solid, const Rect& rect, int height) {
  const int diameter = rect.x.length();
  for (int i = 0; i < diameter; ++i) {
    // The chord through the middle of slice i, in whole decimetres; all doubled to stay whole.
    const int off = 2 * i + 1 - diameter;
    int inset = 0;
    while ((2 * inset + 1 - diameter) * (2 * inset + 1 - diameter) + off * off > diameter * diameter) ++inset;
    solid.add({rect.x.from + i, rect.x.from + i + 1}, rect.y.grown(-inset), {0, height});
  }
  solid.add({rect.x.middle() - 2, rect.x.middle() + 2}, {rect.y.middle() - 2, rect.y.middle() + 2},
            {height, height + 5});
}

void add_stairs(Solid& solid, const Rect& rect, Span z, bool down) {
  const int steps = std::max(1, z.length() / 2);
  for (int i = 0; i < steps; ++i) {
    const Span tread = {rect.x.length() * i / steps, rect.x.length() * (i + 1) / steps};
    const Span x = down ? Span{rect.x.to - tread.to, rect.x.to - tread.from}
                        : Span{rect.x.from + tread.from, rect.x.from + tread.to};
    solid.add(x, rect.y, {z.from, z.from + z.length() * (i + 1) / steps});
  }
}

void add_railing(Solid& solid, const Rect& rect, int floor) {
  solid.add(rect, {floor + 10, floor + 11});
  solid.add(rect, {floor + 4, floor + 5});
  const bool along_x = rect.x.length() > rect.y.length();
  const Span along = along_x ? rect.x : rect.y;
  for (int at = along.from; at < along.to; at += 12) {
    const Span post = {at, at + 1};
    solid.add(along_x ? post : rect.x, along_x ? rect.y : post, {floor, floor + 11});
  }
}

void add_rack(Solid& solid, const Rect& rect, int levels, int goods, LayoutRandom& random) {
  const bool along_x = rect.x.length() >= rect.y.length();
  const Span along = along_x ? rect.x : rect.y, across = along_x ? rect.y : rect.x;
  const auto add = [&](Span a, Span b, Span z) { along_x ? solid.add(a, b, z) : solid.add(b, a, z); };
  const int bays = std::max(1, along.length() / kBay);
  const auto bay_from = [&](int i) { return along.from + (along.length() - 1) * i / bays; };
  for (int i = 0; i <= bays; ++i)
    for (const int b : {across.from, across.to - 1})
      add({bay_from(i), bay_from(i) + 1}, {b, b + 1}, {0, levels * kShelf});
  for (int level = 0; level < levels; ++level) {
    const int board = std::max(1, level * kShelf);
    if (level > 0) add(along, across, {board - 1, board});
    for (int i = 0; i < bays; ++i)
      for (const Span half : {Span{1, 12}, Span{13, 24}}) {
        if (!random.chance(goods)) continue;
        const int from = bay_from(i) + half.from;
        const int to = std::min(bay_from(i) + half.to, bay_from(i + 1));
        const int inset = random.whole(0, 1), height = random.whole(5, 12);
        add({from, to}, across.grown(-inset), {level > 0 ? board : 0, board + height});
      }
  }
}

void add_pile(Solid& solid, const Rect& rect, int height, LayoutRandom& random) {
  const auto part = [&](Span span) {
    return Span{span.from + random.whole(0, 2), span.to - random.whole(0, 2)};
  };
  Rect layer = rect;
  int top = 0;
  while (top < height) {
    const int next = std::min(height, top + random.whole(6, 9));
    solid.add(layer, {top, next});
    top = next;
    layer = {part(layer.x), part(layer.y)};
    if (layer.x.length() < 4 || layer.y.length() < 4) return;
  }
}

}  // namespace frontlux::sim
