#include "truth/body_voxels.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <sstream>
#include <utility>

namespace frontlux::sim {
namespace {

using planner::BodyStencil, planner::Motion, planner::Pose, planner::Robot;

constexpr double kSearched = 15.0;          // [m] along each axis
constexpr double kDisc = 2.3, kBall = 1.0;  // [m] radius of a bubble on a plane, in space

// The voxels to search, around a centre within the bounds.
KeyBox search_box(const GroundTruth& truth, const VoxelKey& center) {
  const int reach = static_cast<int>(std::min(kSearched / truth.lattice().resolution(), 65535.0));
  return intersection(grown({center, center}, reach), truth.bounds()).value_or(KeyBox{center, center});
}

// Calls `visit(key)` for the free voxels of a box that can be reached from one of them within the box,
// without crossing a wall, through voxels for which `may_enter(key)`. Voxels of fewer steps come first; the
// order depends on nothing else. Ends when `visit` returns true.
template <class MayEnter, class Visit>
void flood_free(const GroundTruth& truth, const VoxelKey& from, const KeyBox& box, const MayEnter& may_enter,
                const Visit& visit) {
  if (!box.contains(from) || truth.at(from) != Truth::kFree || !may_enter(from)) return;
  std::vector<bool> seen(size_of(box));
  std::vector<VoxelKey> front{from}, next;
  seen[place_in(box, from)] = true;
  while (!front.empty()) {
    next.clear();
    for (const VoxelKey& here : front) {
      if (visit(here)) return;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const auto there =
              offset_key(here, axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
          if (!there || !box.contains(*there) || !truth.open(step < 0 ? *there : here, axis)) continue;
          auto is_seen = seen[place_in(box, *there)];
          if (is_seen || !may_enter(*there)) continue;
          is_seen = true;
          next.push_back(*there);
        }
    }
    std::swap(front, next);
  }
}

// The pose at the nearest voxel for which there is one.
template <class PoseAt>
std::optional<Pose> find(const GroundTruth& truth, const Eigen::Vector3d& around, const PoseAt& pose_at) {
  std::optional<Pose> found;
  const auto from = truth.lattice().key(around);
  if (!from) return found;
  flood_free(
      truth, *from, search_box(truth, *from), [](const VoxelKey&) { return true; },
      [&](const VoxelKey& key) { return (found = pose_at(key)).has_value(); });
  return found;
}

bool has_floor(const GroundTruth& truth, const VoxelKey& key) {
  return key.z > truth.bounds().min.z && !truth.open(make_key(key.x, key.y, key.z - 1), 2);
}

bool drives(const Robot& robot) { return robot.travel.drives(); }

// Whether the voxels of a box are free that are `among(key)`.
template <class Among>
bool all_free(const GroundTruth& truth, const KeyBox& box, const Among& among) {
  return all_of(box, [&](const VoxelKey& key) { return !among(key) || truth.at(key) == Truth::kFree; });
}

// Whether no wall lies between two of those voxels, which are free.
template <class Among>
bool no_wall_in(const GroundTruth& truth, const KeyBox& box, const Among& among) {
  return all_of(box, [&](const VoxelKey& key) {
    if (!among(key)) return true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto next = offset_key(key, axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0);
      if (next && box.contains(*next) && among(*next) && !truth.open(key, axis)) return false;
    }
    return true;
  });
}

// The node that holds a voxel, if the robot moves through nodes and all of it is free.
std::optional<KeyBox> free_node(const GroundTruth& truth, const Robot& robot, const VoxelKey& voxel) {
  if (drives(robot) || robot.travel.node_edge == 0.0) return std::nullopt;
  const Lattice& lattice = truth.lattice();
  const KeyBox node = voxels_of_cell(robot.travel, lattice, cell_of(robot.travel, lattice, voxel));
  const auto any = [](const VoxelKey&) { return true; };
  if (!all_free(truth, node, any) || !no_wall_in(truth, node, any)) return std::nullopt;
  return node;
}

// The body and, above it, the sensor.
KeyBox taken_by(const Lattice& lattice, const Robot& robot, const Pose& sensor_pose) {
  KeyBox taken = body_voxels(lattice, robot, sensor_pose);
  taken.max.z = std::max(taken.max.z, lattice.key(sensor_pose.position).value().z);
  return taken;
}

// A robot that is placed.
struct Placed {
  KeyBox taken;  // where no other one may be
  Eigen::AlignedBox3d body;
};

Eigen::AlignedBox3d body_at(const Robot& robot, const Pose& pose) {
  return planner::body_of(robot.travel).translated(pose.position);
}

// The pose, if the robot can be there beside those that are placed.
std::optional<Pose> if_free(const GroundTruth& truth, const Robot& robot, const Pose& pose,
                            std::span<const Placed> placed) {
  if (obstacle_at(truth, robot, pose)) return std::nullopt;
  const KeyBox box = taken_by(truth.lattice(), robot, pose);
  const Eigen::AlignedBox3d body = body_at(robot, pose);
  if (std::ranges::any_of(placed, [&](const Placed& other) {
        return intersection(box, other.taken).has_value() ||
               body.exteriorDistance(other.body) < planner::kSeparation;
      }))
    return std::nullopt;
  return pose;
}

// Whether there is room for all that planning keeps free around a robot, its margin too.
bool has_room(const GroundTruth& truth, const Robot& robot, const Pose& pose) {
  const BodyStencil stencil(robot.travel, truth.lattice().resolution());
  const VoxelKey cell = truth.lattice().key(pose.position).value();
  const KeyBox box = stencil.box_around(cell);
  const auto needed = [&](const VoxelKey& key) { return stencil.contains(cell, key); };
  return all_free(truth, box, needed) && no_wall_in(truth, box, needed);
}

// The nearest pose that is good and has room or, if there is none, that is good.
template <class Good>
std::optional<Pose> find_with_room(const GroundTruth& truth, const Eigen::Vector3d& around,
                                   const Robot& robot, const Good& good) {
  const auto with_room = find(truth, around, [&](const VoxelKey& key) -> std::optional<Pose> {
    const std::optional<Pose> pose = good(key);
    return pose && has_room(truth, robot, *pose) ? pose : std::nullopt;
  });
  return with_room ? with_room : find(truth, around, good);
}

std::optional<Pose> find_on_floor(const GroundTruth& truth, const Eigen::Vector3d& around, const Robot& robot,
                                  std::span<const Placed> placed) {
  return find_with_room(truth, around, robot, [&](const VoxelKey& key) -> std::optional<Pose> {
    if (!has_floor(truth, key)) return std::nullopt;
    Pose pose{truth.lattice().exact_center(key)};
    pose.position.z() = lower_face(truth.lattice(), key.z) + robot.travel.sensor_height;
    return if_free(truth, robot, pose, placed);
  });
}

std::optional<Pose> find_in_space(const GroundTruth& truth, const Eigen::Vector3d& around, const Robot& robot,
                                  double ground, std::span<const Placed> placed) {
  const Lattice& lattice = truth.lattice();
  constexpr double kRounding = 1e-9;
  const auto good = [&](const VoxelKey& key) -> std::optional<Pose> {
    const Pose pose{lattice.exact_center(key)};
    if (pose.position.z() < ground + robot.travel.min_height - kRounding) return std::nullopt;
    return if_free(truth, robot, pose, placed);
  };
  if (robot.travel.node_edge > 0.0) {
    const auto in_node = find(truth, around, [&](const VoxelKey& key) -> std::optional<Pose> {
      if (cell_of(robot.travel, lattice, key) != key || !free_node(truth, robot, key)) return std::nullopt;
      // It is the node's own centre, half a voxel below, that a corridor measures.
      if (lower_face(lattice, key.z) < ground + robot.travel.min_height - kRounding) return std::nullopt;
      return good(key);
    });
    return in_node ? in_node : find(truth, around, good);
  }
  return find_with_room(truth, around, robot, good);
}

}  // namespace

KeyBox body_voxels(const Lattice& lattice, const Robot& robot, const Pose& sensor_pose) {
  const Eigen::Vector3d& at = sensor_pose.position;
  const Eigen::Vector3d& extents = robot.travel.extents;
  if (!drives(robot)) return planner::voxels_of(lattice, {at - extents / 2, at + extents / 2});
  const Eigen::Vector3d half(extents.x() / 2, extents.y() / 2, 0.0);
  const Eigen::Vector3d bottom = at - Eigen::Vector3d(0, 0, robot.travel.sensor_height);
  return planner::voxels_of(lattice, {bottom - half, bottom + half + Eigen::Vector3d(0, 0, extents.z())});
}

std::optional<std::string> obstacle_at(const GroundTruth& truth, const Robot& robot,
                                       const Pose& sensor_pose) {
  const BodyVoxels voxels(truth.lattice(), robot, sensor_pose);
  const KeyBox& body = voxels.box();
  const auto in_body = [&](const VoxelKey& key) { return voxels.contains(key); };
  const auto sensor = truth.lattice().key(sensor_pose.position);
  const KeyBox& all = truth.bounds();
  if (!sensor || !all.contains(*sensor) || !all.contains(body.min) || !all.contains(body.max))
    return "it would reach beyond the world's bounds";
  std::optional<std::string> why;
  const auto is_free = [&](const VoxelKey& key) {
    if (truth.at(key) == Truth::kFree) return true;
    const Eigen::Vector3d at = truth.lattice().exact_center(key);
    std::ostringstream where;
    where << "its voxel at " << at.x() << ", " << at.y() << ", " << at.z() << " m";
    why = truth.holds_surface(key) ? "a surface passes through " + where.str()
                                   : where.str() + " cannot be reached from the start";
    return false;
  };
  if (!all_of(body, [&](const VoxelKey& key) { return !in_body(key) || is_free(key); }) || !is_free(*sensor))
    return why;
  if (!no_wall_in(truth, body, in_body)) return "a wall would run through it";
  if (!drives(robot)) return why;
  for (VoxelKey above = {sensor->x, sensor->y, body.max.z}; above.z < sensor->z; ++above.z)
    if (!truth.open(above, 2)) return "a ceiling would separate it from its sensor";
  KeyBox feet = body;
  feet.max.z = body.min.z;
  if (!all_of(feet, [&](const VoxelKey& key) { return !in_body(key) || has_floor(truth, key); }))
    return "there is no floor under all of it";
  return why;
}

double ground_below(const GroundTruth& truth, const Eigen::Vector3d& around) {
  auto below = truth.lattice().key(around);
  if (!below || truth.at(*below) != Truth::kFree) return lower_face(truth.lattice(), truth.bounds().min.z);
  while (below->z > truth.bounds().min.z && !has_floor(truth, *below)) --below->z;
  return lower_face(truth.lattice(), below->z);
}

std::vector<std::optional<Pose>> find_starts(const GroundTruth& truth, const Eigen::Vector3d& around,
                                             std::span<const Robot> robots) {
  std::vector<std::optional<Pose>> starts(robots.size());
  std::optional<double> ground;  // [m] the highest that a robot stands on
  // Beside robots of its kind a robot keeps a voxel free.
  const auto placed_beside = [&](const Robot& robot) {
    std::vector<Placed> placed;
    for (std::size_t i = 0; i < robots.size(); ++i)
      if (starts[i])
        placed.push_back({grown(taken_by(truth.lattice(), robots[i], *starts[i]),
                                drives(robots[i]) == drives(robot) ? 1 : 0),
                          body_at(robots[i], *starts[i])});
    return placed;
  };
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!drives(robots[i])) continue;
    starts[i] = find_on_floor(truth, around, robots[i], placed_beside(robots[i]));
    if (!starts[i]) continue;
    const double stands_on = starts[i]->position.z() - robots[i].travel.sensor_height;
    ground = ground ? std::max(*ground, stands_on) : stands_on;
  }
  if (!ground) ground = ground_below(truth, around);
  for (std::size_t i = 0; i < robots.size(); ++i)
    if (!drives(robots[i]))
      starts[i] = find_in_space(truth, around, robots[i], *ground, placed_beside(robots[i]));
  return starts;
}

std::vector<VoxelKey> start_bubble(const GroundTruth& truth, const Robot& robot, const Pose& sensor_pose) {
  const Lattice& lattice = truth.lattice();
  const Eigen::Vector3d& at = sensor_pose.position;
  const BodyVoxels body(lattice, robot, sensor_pose);
  const VoxelKey from = lattice.key(at).value();
  const std::optional<KeyBox> node = free_node(truth, robot, from);
  planner::TravelOptions by_voxels = robot.travel;
  by_voxels.node_edge = 0.0;
  const BodyStencil room(by_voxels, lattice.resolution());
  constexpr double kRounding = 1e-9;
  const auto in_bubble = [&](const VoxelKey& key) {
    if (body.contains(key) || room.contains(from, key) || (node && node->contains(key))) return true;
    const Eigen::Vector3d offset = lattice.exact_center(key) - at;
    if (!drives(robot)) return offset.norm() <= kBall + kRounding;
    return offset.head<2>().norm() <= kDisc + kRounding && offset.z() <= kRounding &&
           key.z >= body.box().min.z;
  };
  std::vector<VoxelKey> bubble;
  flood_free(
      truth, from, search_box(truth, from),
      [&](const VoxelKey& key) { return in_bubble(key) || key == from; },
      [&](const VoxelKey& key) {
        bubble.push_back(key);
        return false;
      });
  std::sort(bubble.begin(), bubble.end());
  return bubble;
}

}  // namespace frontlux::sim
