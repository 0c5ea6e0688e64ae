#include <frontlux/key_box.hpp>
#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/sim/unseen.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace frontlux::sim {
namespace {

using Keys = std::vector<VoxelKey>;
using Targets = std::map<VoxelKey, std::uint64_t>;  // to be seen, and how often each was drawn

constexpr std::uint64_t kSample = 4000;  // voxels
constexpr double kSpacing = 0.3;         // [m] of the cells that robots look from
constexpr int kStepsPerMetre = 20;       // by which bodies are made smaller
constexpr double kAnyHeight = -1e6;      // [m] as a minimum height

// What has to be free around robots at their starts, as far as it is in the world: a margin may reach far
// beyond.
std::set<VoxelKey> room_at_starts(const GroundTruth& truth, std::span<const planner::Robot> robots,
                                  std::span<const planner::Pose> starts) {
  const Lattice& lattice = truth.lattice();
  std::set<VoxelKey> room;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    planner::TravelOptions by_voxels = robots[r].travel;
    by_voxels.node_edge = 0.0;
    const planner::BodyStencil stencil(by_voxels, lattice.resolution());
    const auto at = lattice.key(starts[r].position);
    const auto box = at ? intersection(stencil.box_around(*at), truth.bounds()) : std::nullopt;
    if (!box) continue;
    for_each_key(*box, [&](const VoxelKey& key) {
      if (stencil.contains(*at, key)) room.insert(key);
    });
  }
  return room;
}

// The whole world as a map. Of two free voxels with a wall between them the upper one counts as occupied, or
// the lower one if a robot starts in the upper one, so that nobody looks or goes through. Of two robots that
// start beside such a wall on its both sides the lower one is not looked from.
VoxelGrid map_of(const GroundTruth& truth, const std::set<VoxelKey>& starts) {
  VoxelGrid grid(truth.lattice().resolution());
  const auto free = [&](const VoxelKey& key) { return truth.at(key) == Truth::kFree; };
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    bool open = free(key);
    for (std::size_t axis = 0; axis < 3 && open; ++axis) {
      const auto below = offset_key(key, axis == 0 ? -1 : 0, axis == 1 ? -1 : 0, axis == 2 ? -1 : 0);
      if (!below || !free(*below) || truth.open(*below, axis)) continue;
      if (starts.contains(key))
        grid.set(*below, Occupancy::kOccupied);
      else
        open = false;
    }
    grid.set(key, open ? Occupancy::kFree : Occupancy::kOccupied);
  });
  return grid;
}

// Some of the observable voxels that a map does not know, from all over the world.
struct Sample {
  Targets targets;
  double each = 0.0;  // part of the observable voxels that one stands for
};

// A surface is seen when the free voxel before it is: between centres a flat floor hides itself.
VoxelKey target_of(const GroundTruth& truth, const VoxelKey& key) {
  if (truth.at(key) == Truth::kFree) return key;
  for (int axis = 0; axis < 3; ++axis)
    for (const int by : {-1, 1})
      if (const auto next = offset_key(key, axis == 0 ? by : 0, axis == 1 ? by : 0, axis == 2 ? by : 0);
          next && truth.at(*next) == Truth::kFree)
        return *next;
  return key;
}

Sample sample_of_unseen(const GroundTruth& truth, const VoxelGrid& map) {
  const auto for_each_unseen = [&](const auto& visit) {
    for_each_key(truth.bounds(), [&](const VoxelKey& key) {
      if (map.at(key) == Occupancy::kUnknown && truth.contains(key)) visit(key);
    });
  };
  std::uint64_t count = 0;
  for_each_unseen([&](const VoxelKey&) { ++count; });
  const std::uint64_t step = count / kSample + 1;
  std::uint64_t number = 0, drawn = 0;
  Sample sample;
  for_each_unseen([&](const VoxelKey& key) {
    if (number++ % step != step / 2) return;
    ++sample.targets[target_of(truth, key)];
    ++drawn;
  });
  if (drawn > 0)
    sample.each = static_cast<double>(count) / static_cast<double>(drawn) /
                  static_cast<double>(truth.observable_voxels());
  return sample;
}

Keys one_of_each_cube(std::span<const VoxelKey> cells, int edge) {
  std::vector<std::pair<VoxelKey, VoxelKey>> by_cube;
  for (const VoxelKey& cell : cells)
    by_cube.emplace_back(make_key(cell.x / edge, cell.y / edge, cell.z / edge), cell);
  std::ranges::sort(by_cube);
  Keys some;
  for (std::size_t i = 0; i < by_cube.size(); ++i)
    if (i == 0 || by_cube[i].first != by_cube[i - 1].first) some.push_back(by_cube[i].second);
  return some;
}

// A robot as small as a voxel, which goes wherever its sensor has room.
planner::Robot small(planner::Robot robot, double resolution) {
  planner::TravelOptions& travel = robot.travel;
  travel.motion = planner::Motion::kSpace;
  travel.extents = Eigen::Vector3d::Constant(resolution / 2);
  travel.margin = travel.node_edge = 0.0;
  travel.min_height = kAnyHeight;
  return robot;
}

double width_of(const planner::TravelOptions& travel) {
  const double sides = std::max(travel.extents.x(), travel.extents.y());
  return travel.drives() ? sides : std::max({sides, travel.extents.z(), travel.node_edge});
}

// A robot with a smaller body [m], of which a hundredth is left at least.
planner::Robot smaller(planner::Robot robot, double by) {
  planner::TravelOptions& travel = robot.travel;
  travel.shape = travel.planned_shape();  // whose height may differ from its width
  const double height = travel.extents.z();
  travel.extents = (travel.extents.array() - by).max(travel.extents.array() / 100);
  if (travel.drives()) {
    travel.extents.z() = height;
    if (travel.ground_extents)
      travel.ground_extents = travel.ground_extents->cwiseMin(travel.extents.head<2>());
  } else {
    travel.min_height -= (height - travel.extents.z()) / 2;  // its lower face gets as low as before
    if (travel.node_edge > 0.0) travel.node_edge = std::max(travel.node_edge - by, travel.extents.maxCoeff());
  }
  return robot;
}

// What robots see of the true world.
class Sights {
 public:
  // @param truth, grid  live as long as this; `grid` is the map of the true world
  Sights(const GroundTruth& truth, const VoxelGrid& grid)
      : truth_(truth),
        grid_(grid),
        caster_(make_ray_caster(grid)),
        edge_(std::max(1, static_cast<int>(std::lround(kSpacing / truth.lattice().resolution())))) {}

  // Those of the targets that a robot sees from where it gets to.
  [[nodiscard]] Targets seen(const planner::Robot& robot, const planner::Pose& start,
                             const Targets& targets) const {
    const auto here = truth_.lattice().key(start.position);
    if (!here) return {};
    planner::TravelCorridor corridor(robot.travel, truth_.lattice(), truth_.bounds());
    corridor.update({grid_, {}}, *here);
    const Keys cells = one_of_each_cube(corridor.cells(), edge_);
    Keys keys;
    for (const auto& [key, drawn] : targets) keys.push_back(key);
    Targets seen;
    for (const std::uint32_t i :
         planner::find_visible_frontiers(*caster_, grid_, keys, {cells, robot.view}).frontiers)
      seen.insert(*targets.find(keys[i]));
    return seen;
  }

 private:
  const GroundTruth& truth_;
  const VoxelGrid& grid_;
  std::unique_ptr<RayCaster> caster_;
  int edge_;
};

// @param part_seen  of the observable voxels, by a robot, of the narrow ones
KeptOut what_keeps_out(const planner::Robot& robot, double narrow,
                       const std::function<double(const planner::Robot&)>& part_seen) {
  KeptOut kept;
  if (robot.travel.motion == planner::Motion::kSpace) {
    planner::Robot low = robot;
    low.travel.min_height = kAnyHeight;
    kept.without_min_height = part_seen(low);
  }
  // The largest first: often not even that will do.
  const int most = static_cast<int>(std::ceil(width_of(robot.travel) * kStepsPerMetre)) - 1;
  for (int low = 1, high = most, steps = most; low <= high; steps = std::midpoint(low, high)) {
    const double by = static_cast<double>(steps) / kStepsPerMetre, part = part_seen(smaller(robot, by));
    if (part < narrow / 2) {
      low = steps + 1;
      continue;
    }
    high = steps - 1;
    kept.narrow_by = by;
    kept.in_view_then = part;
  }
  return kept;
}

}  // namespace

Unseen explain_unseen(const GroundTruth& truth, const VoxelGrid& map, std::span<const planner::Robot> robots,
                      std::span<const planner::Pose> starts) {
  const double resolution = truth.lattice().resolution();
  if (map.resolution() != resolution)
    throw std::invalid_argument("unseen voxels: the map has voxels of " + std::to_string(map.resolution()) +
                                " m, the ground truth of " + std::to_string(resolution) + " m");
  const VoxelGrid grid = map_of(truth, room_at_starts(truth, robots, starts));
  Sample sample = sample_of_unseen(truth, map);
  if (sample.targets.empty()) return {};
  const Sights sights(truth, grid);
  const auto part_of = [&](const Targets& targets) {
    std::uint64_t all = 0;
    for (const auto& [key, drawn] : targets) all += drawn;
    return static_cast<double>(all) * sample.each;
  };
  // Takes out what the team sees.
  const auto look = [&](const auto& as) {
    Targets all;
    for (std::size_t r = 0; r < robots.size(); ++r) {
      const Targets seen = sights.seen(as(robots[r]), starts[r], sample.targets);
      for (const auto& [key, drawn] : seen) sample.targets.erase(key);
      all.insert(seen.begin(), seen.end());
    }
    return all;
  };
  const double all = part_of(sample.targets);
  look([](const planner::Robot& robot) { return robot; });
  const double without_in_view = part_of(sample.targets);
  const Targets narrow = look([&](const planner::Robot& robot) { return small(robot, resolution); });
  const double hidden = part_of(sample.targets);
  Unseen unseen{all - without_in_view, without_in_view - hidden, hidden, {}};
  if (unseen.narrow < kMuchUnseen) return unseen;
  for (std::size_t r = 0; r < robots.size(); ++r)
    unseen.robots.push_back(what_keeps_out(robots[r], unseen.narrow, [&](const planner::Robot& robot) {
      return part_of(sights.seen(robot, starts[r], narrow));
    }));
  return unseen;
}

}  // namespace frontlux::sim
