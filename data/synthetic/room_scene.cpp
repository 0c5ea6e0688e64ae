#include "floor_plan.hpp"

#include <frontlux/synthetic/random.hpp>
#include <frontlux/synthetic/scene.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace frontlux::synthetic {
namespace {

// All in decimetres.
constexpr int kSlab = 3, kOuterWall = 5;
constexpr int kHalfWall = 1;  // half the thickness of an inner wall
constexpr int kDoorHead = 21;
constexpr int kPassage = 12;   // what has to stay free before and behind a door
constexpr int kClearance = 7;  // between pieces: wide enough that nothing but rays has to squeeze through

// [m] of a plan's coordinate.
double metres(int decimetres) { return 0.1 * decimetres - 0.07; }

Box box_of(const Rect& rect, const Rise& rise) {
  return {Eigen::Vector3d(metres(rect.x0), metres(rect.y0), metres(rise.z0)),
          Eigen::Vector3d(metres(rect.x1), metres(rect.y1), metres(rise.z1))};
}

Rect on_line(const WallLine& line, int from, int to, int half) {
  return line.along_y ? Rect{line.at - half, from, line.at + half, to}
                      : Rect{from, line.at - half, to, line.at + half};
}

Rect push_to_wall(const Rect& rect, const Rect& space, int side) {
  const int dx = side == 0 ? space.x0 - rect.x0 : side == 1 ? space.x1 - rect.x1 : 0;
  const int dy = side == 2 ? space.y0 - rect.y0 : side == 3 ? space.y1 - rect.y1 : 0;
  return {rect.x0 + dx, rect.y0 + dy, rect.x1 + dx, rect.y1 + dy};
}

// Collects the boxes of a house of one storey.
class House {
 public:
  // Floor, roof and outer walls.
  House(const Rect& inside, int height) : inside_(inside), height_(height) {
    const Rise rise{0, height};
    const Rect outside = inside.grown(kOuterWall);
    add(outside, {-kSlab, 0});
    add(outside, {height, height + kSlab});
    add({outside.x0, outside.y0, inside.x0, outside.y1}, rise);
    add({inside.x1, outside.y0, outside.x1, outside.y1}, rise);
    add({inside.x0, outside.y0, inside.x1, inside.y0}, rise);
    add({inside.x0, inside.y1, inside.x1, outside.y1}, rise);
  }

  // A wall with a door. Half a thickness more at both ends closes the corners.
  void add_wall(const WallLine& line, int door_from, int door_to) {
    add(on_line(line, line.from - kHalfWall, door_from, kHalfWall), {0, height_});
    add(on_line(line, door_from, door_to, kHalfWall), {kDoorHead, height_});
    add(on_line(line, door_to, line.to + kHalfWall, kHalfWall), {0, height_});
    passages_.push_back(on_line(line, door_from, door_to, kPassage));
  }

  // Crates, shelves and tables in a room, as far as `count` tries find space beside others and before doors.
  void add_furniture(const Rect& space, int count, Random& random) {
    const Rect inside = space.grown(-kHalfWall);
    std::vector<Rect> keep_clear = passages_;
    for (int i = 0; i < count; ++i) {
      const int kind = random.whole(0, 3);
      const int side = random.whole(0, 3);
      int width = kind == 0 ? random.whole(10, 25) : random.whole(5, 16);
      int depth = kind == 0 ? 4 : random.whole(5, 10);
      const int height = kind == 0 ? random.whole(16, 24) : random.whole(6, 14);
      if (side < 2) std::swap(width, depth);
      if (width > inside.width() || depth > inside.depth()) continue;
      const int x = random.whole(inside.x0, inside.x1 - width);
      const int y = random.whole(inside.y0, inside.y1 - depth);
      Rect rect{x, y, x + width, y + depth};
      if (kind < 2) rect = push_to_wall(rect, inside, side);
      const bool blocked = std::any_of(keep_clear.begin(), keep_clear.end(), [&](const Rect& other) {
        return other.overlaps(rect.grown(kClearance));
      });
      if (blocked) continue;
      keep_clear.push_back(rect);
      if (kind == 3) {  // a table: a top on two panels
        add(rect, {7, 8});
        add({rect.x0, rect.y0, rect.x0 + 1, rect.y1}, {0, 7});
        add({rect.x1 - 1, rect.y0, rect.x1, rect.y1}, {0, 7});
      } else {
        add(rect, {0, height});
      }
    }
  }

  Scene finish() && { return {BoxSet(std::move(boxes_)), box_of(inside_, {0, height_}), {metres(0)}}; }

 private:
  void add(const Rect& rect, const Rise& rise) { boxes_.push_back(box_of(rect, rise)); }

  Rect inside_;
  int height_;
  std::vector<Box> boxes_;
  std::vector<Rect> passages_;
};

}  // namespace

Scene make_room_scene(std::uint64_t seed) {
  Random random(seed);
  House house({-30, -25, 30, 25}, 27);
  const int wall = random.whole(8, 12);
  const int door = random.whole(-20, 10);
  house.add_wall({true, wall, -25, 25}, door, door + 10);
  house.add_furniture({-30, -25, wall, 25}, 14, random);
  house.add_furniture({wall, -25, 30, 25}, 6, random);
  return std::move(house).finish();
}

}  // namespace frontlux::synthetic
