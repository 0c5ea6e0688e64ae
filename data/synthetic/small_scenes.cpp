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

}  // namespace frontlux::synthetic
