#include "solids.hpp"

#include <frontlux/synthetic/scene.hpp>

#include <utility>

namespace frontlux::synthetic {
namespace {

// All in decimetres.
constexpr int kDoorHead = 21;

struct Draft {
  Rect inside;
  int height = 0;
  Solids solids;
  std::vector<Rect> passages;

  Draft(const Rect& floor_plan, int clear_height) : inside(floor_plan), height(clear_height) {
    solids.add_shell(inside, {0, height});
  }

  void add_wall(const WallLine& line, const std::vector<Opening>& openings) {
    solids.add_wall(line, {0, height}, openings);
    for (const Opening& opening : openings) passages.push_back(passage(line, opening));
  }

  Scene finish() && {
    const Box room(Eigen::Vector3d(metres(inside.x0), metres(inside.y0), metres(0)),
                   Eigen::Vector3d(metres(inside.x1), metres(inside.y1), metres(height)));
    return {BoxSet(std::move(solids.boxes)), room, {metres(0)}};
  }
};

Opening door(int from, int to, Random& random) {
  const int start = random.whole(from, to - 10);
  return {start, start + 10, 0, kDoorHead};
}

}  // namespace

Scene make_room_scene(std::uint64_t seed) {
  Random random(seed);
  Draft draft({-30, -25, 30, 25}, 27);
  const int wall = random.whole(8, 12);
  draft.add_wall({true, wall, -25, 25}, {door(-20, 20, random)});
  draft.solids.add_furniture({-30, -25, wall, 25}, 0, 14, draft.passages, random);
  draft.solids.add_furniture({wall, -25, 30, 25}, 0, 6, draft.passages, random);
  return std::move(draft).finish();
}

Scene make_corridor_scene(std::uint64_t seed) {
  Random random(seed);
  Draft draft({-100, -45, 100, 45}, 27);
  draft.add_wall({false, -10, -100, 100}, {door(-90, -50, random), door(-40, 0, random), {60, 85, 0, 27}});
  draft.add_wall({false, 10, -100, 100}, {door(-90, -30, random), door(-10, 90, random)});
  for (const int x : {-45, 5, 50}) draft.add_wall({true, x, -45, -10}, {});
  draft.add_wall({true, -20, 10, 45}, {door(14, 40, random)});
  for (int x = -95; x < 95; x += 25) draft.solids.add({x, 6, x + 3, 9}, {0, 27});
  draft.solids.add_furniture({-100, -45, -45, -10}, 0, 8, draft.passages, random);
  draft.solids.add_furniture({-45, -45, 5, -10}, 0, 8, draft.passages, random);
  draft.solids.add_furniture({-100, 10, -20, 45}, 0, 8, draft.passages, random);
  draft.solids.add_furniture({-20, 10, 100, 45}, 0, 8, draft.passages, random);
  return std::move(draft).finish();
}

Scene make_hall_scene(std::uint64_t seed) {
  Random random(seed);
  Draft draft({-90, -70, 90, 70}, 64);
  for (int x = -50; x <= 50; x += 50) {
    for (const int y : {-30, 30}) draft.solids.add({x - 2, y - 2, x + 2, y + 2}, {0, 64});
  }
  draft.solids.add({-90, 45, 90, 70}, {29, 31});
  draft.solids.add({-90, 45, 90, 46}, {31, 40});
  draft.solids.add_furniture({-90, -70, 90, 70}, 0, 40, {}, random);
  return std::move(draft).finish();
}

}  // namespace frontlux::synthetic
