#include "solids.hpp"

#include <algorithm>

namespace frontlux::synthetic {
namespace {

Rect on_line(const WallLine& line, int from, int to, int half) {
  return line.along_y ? Rect{line.at - half, from, line.at + half, to}
                      : Rect{from, line.at - half, to, line.at + half};
}

Rect place_in(const Rect& space, int width, int depth, Random& random) {
  const int x = random.whole(space.x0, space.x1 - width);
  const int y = random.whole(space.y0, space.y1 - depth);
  return {x, y, x + width, y + depth};
}

Rect push_to_wall(Rect rect, const Rect& space, int side) {
  int dx = 0;
  int dy = 0;
  if (side == 0) dx = space.x0 - rect.x0;
  if (side == 1) dx = space.x1 - rect.x1;
  if (side == 2) dy = space.y0 - rect.y0;
  if (side == 3) dy = space.y1 - rect.y1;
  return {rect.x0 + dx, rect.y0 + dy, rect.x1 + dx, rect.y1 + dy};
}

}  // namespace

void Solids::add(const Rect& rect, const Rise& rise) {
  boxes.emplace_back(Eigen::Vector3d(metres(rect.x0), metres(rect.y0), metres(rise.z0)),
                     Eigen::Vector3d(metres(rect.x1), metres(rect.y1), metres(rise.z1)));
}

void Solids::add_shell(const Rect& inside, const Rise& rise) {
  constexpr int kSlab = 3;
  constexpr int kWall = 5;
  const Rect outside = inside.grown(kWall);
  add(outside, {rise.z0 - kSlab, rise.z0});
  add(outside, {rise.z1, rise.z1 + kSlab});
  add({outside.x0, outside.y0, inside.x0, outside.y1}, rise);
  add({inside.x1, outside.y0, outside.x1, outside.y1}, rise);
  add({inside.x0, outside.y0, inside.x1, inside.y0}, rise);
  add({inside.x0, inside.y1, inside.x1, outside.y1}, rise);
}

void Solids::add_wall(const WallLine& line, const Rise& rise, const std::vector<Opening>& openings) {
  // Half a thickness more at both ends closes the corners.
  int from = line.from - kHalfWall;
  const int to = line.to + kHalfWall;
  for (const Opening& hole : openings) {
    add(on_line(line, from, hole.from, kHalfWall), rise);
    const Rect gap = on_line(line, hole.from, hole.to, kHalfWall);
    if (hole.sill > 0) add(gap, {rise.z0, rise.z0 + hole.sill});
    if (rise.z0 + hole.head < rise.z1) add(gap, {rise.z0 + hole.head, rise.z1});
    from = hole.to;
  }
  add(on_line(line, from, to, kHalfWall), rise);
}

void Solids::add_furniture(const Rect& space, int floor, int count, std::vector<Rect> keep_clear,
                           Random& random) {
  const Rect inside = space.grown(-kHalfWall);
  for (int i = 0; i < count; ++i) {
    const int kind = random.whole(0, 3);
    const int side = random.whole(0, 3);
    int width = kind == 0 ? random.whole(10, 25) : random.whole(5, 16);
    int depth = kind == 0 ? 4 : random.whole(5, 10);
    const int height = kind == 0 ? random.whole(16, 24) : random.whole(6, 14);
    if (side < 2) std::swap(width, depth);
    if (width > inside.width() || depth > inside.depth()) continue;
    Rect rect = place_in(inside, width, depth, random);
    if (kind < 2) rect = push_to_wall(rect, inside, side);
    // 0.7 m between pieces: wide enough that nothing but rays has to squeeze through.
    const bool blocked = std::any_of(keep_clear.begin(), keep_clear.end(),
                                     [&](const Rect& other) { return other.overlaps(rect.grown(7)); });
    if (blocked) continue;
    keep_clear.push_back(rect);
    if (kind == 3) {  // a table: a top on two panels
      add(rect, {floor + 7, floor + 8});
      add({rect.x0, rect.y0, rect.x0 + 1, rect.y1}, {floor, floor + 7});
      add({rect.x1 - 1, rect.y0, rect.x1, rect.y1}, {floor, floor + 7});
    } else {
      add(rect, {floor, floor + height});
    }
  }
}

Rect passage(const WallLine& line, const Opening& opening) {
  constexpr int kDepth = 12;
  return on_line(line, opening.from, opening.to, kDepth);
}

}  // namespace frontlux::synthetic
