#include "modules.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::synthetic {
namespace {

Rect on_line(const WallLine& line, int from, int to) {
  return line.along_y ? Rect{line.at, from, line.at + 1, to} : Rect{from, line.at, to, line.at + 1};
}

// Moved to a side of a room and grown one module into the wall there.
Rect lean_on_wall(const Rect& rect, const Rect& inside, int side) {
  if (side == 0) return {inside.x0 - 1, rect.y0, inside.x0 + rect.width(), rect.y1};
  if (side == 1) return {inside.x1 - rect.width(), rect.y0, inside.x1 + 1, rect.y1};
  if (side == 2) return {rect.x0, inside.y0 - 1, rect.x1, inside.y0 + rect.depth()};
  return {rect.x0, inside.y1 - rect.depth(), rect.x1, inside.y1 + 1};
}

}  // namespace

void Modules::add(const Rect& rect, const Rise& rise) {
  const Eigen::Vector3d inset = Eigen::Vector3d::Constant(kInset);
  boxes.emplace_back(kEdge * Eigen::Vector3d(rect.x0, rect.y0, rise.z0) + inset,
                     kEdge * Eigen::Vector3d(rect.x1, rect.y1, rise.z1) - inset);
}

void Modules::add_shell(const Rect& inside, const Rise& rise) {
  const Rect outside = inside.grown(2);
  const Rise whole{rise.z0 - 1, rise.z1 + 1};
  add(outside, {rise.z0 - 1, rise.z0});
  add(outside, {rise.z1, rise.z1 + 1});
  add({outside.x0, outside.y0, inside.x0, outside.y1}, whole);
  add({inside.x1, outside.y0, outside.x1, outside.y1}, whole);
  add({outside.x0, outside.y0, outside.x1, inside.y0}, whole);
  add({outside.x0, inside.y1, outside.x1, outside.y1}, whole);
}

void Modules::add_wall(const WallLine& line, const Rise& rise, const std::vector<Opening>& openings) {
  const Rise whole{rise.z0 - 1, rise.z1 + 1};
  int from = line.from;
  for (const Opening& hole : openings) {
    add(on_line(line, from, hole.from), whole);
    const Rect gap = on_line(line, hole.from - 1, hole.to + 1);
    if (hole.sill > 0) add(gap, {whole.z0, rise.z0 + hole.sill});
    if (rise.z0 + hole.head < rise.z1) add(gap, {rise.z0 + hole.head, whole.z1});
    from = hole.to;
  }
  add(on_line(line, from, line.to + 1), whole);
}

void Modules::add_furniture(const Rect& space, int floor, int count, std::vector<Rect>& keep_clear,
                            Random& random) {
  const Rect inside = between_walls(space), middle = inside.grown(-3);
  for (int i = 0; i < count; ++i) {
    const int kind = random.whole(0, 3);
    const int side = random.whole(0, 3);
    int width = kind == 0 ? random.whole(3, 8) : random.whole(2, 5);
    int depth = random.whole(2, kind == 0 ? 2 : 3);
    const int height = kind == 0 ? random.whole(5, 8) : random.whole(2, 4);
    if (side < 2) std::swap(width, depth);
    if (width > middle.width() || depth > middle.depth()) continue;
    const int x = random.whole(middle.x0, middle.x1 - width);
    const int y = random.whole(middle.y0, middle.y1 - depth);
    Rect rect{x, y, x + width, y + depth};
    if (kind < 2) rect = lean_on_wall(rect, inside, side);
    const bool blocked = std::any_of(keep_clear.begin(), keep_clear.end(),
                                     [&](const Rect& other) { return other.overlaps(rect.grown(3)); });
    if (blocked) continue;
    keep_clear.push_back(rect);
    if (kind == 3 && rect.width() > 3) {  // a table: a top on two panels
      add(rect, {floor + 2, floor + 3});
      add({rect.x0, rect.y0, rect.x0 + 1, rect.y1}, {floor - 1, floor + 3});
      add({rect.x1 - 1, rect.y0, rect.x1, rect.y1}, {floor - 1, floor + 3});
    } else {
      add(rect, {floor - 1, floor + height});
    }
  }
}

Rect module_passage(const WallLine& line, const Opening& opening) {
  constexpr int kDepth = 4;
  Rect rect = on_line(line, opening.from, opening.to);
  (line.along_y ? rect.x0 : rect.y0) -= kDepth;
  (line.along_y ? rect.x1 : rect.y1) += kDepth;
  return rect;
}

}  // namespace frontlux::synthetic
