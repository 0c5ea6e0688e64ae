#include "truth/open_walk.hpp"

#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/start_pose.hpp>
#include <frontlux/sim/surface.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace frontlux::sim {
namespace {

using planner::Motion;
using planner::Pose;
using planner::Robot;

constexpr double kSearched = 15.0;          // [m] along each axis
constexpr double kDisc = 2.3, kBall = 1.0;  // [m] radius of a bubble on a plane, in space

std::string to_text(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << p.x() << ", " << p.y() << ", " << p.z();
  return text.str();
}

Eigen::Vector3d center_of(const Lattice& lattice, const VoxelKey& key) {
  return {lattice.center(key.x), lattice.center(key.y), lattice.center(key.z)};
}

std::optional<VoxelKey> key_of(const Lattice& lattice, const Eigen::Vector3d& point) {
  const auto x = lattice.key(point.x()), y = lattice.key(point.y()), z = lattice.key(point.z());
  if (!x || !y || !z) return std::nullopt;
  return VoxelKey{*x, *y, *z};
}

// [m] the lower end of a layer of voxels
double lower_end(const Lattice& lattice, std::uint16_t layer) {
  return (static_cast<int>(layer) - Lattice::kOrigin) * lattice.resolution();
}

bool overlap(const KeyBox& a, const KeyBox& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

// The voxels around a search's centre, within the bounds.
KeyBox search_box(const GroundTruth& truth, const VoxelKey& center) {
  const int reach = static_cast<int>(std::min(kSearched / truth.lattice().resolution(), 65535.0));
  const auto low = [&](std::uint16_t at, std::uint16_t bound) {
    return static_cast<std::uint16_t>(std::max<int>(at - reach, bound));
  };
  const auto high = [&](std::uint16_t at, std::uint16_t bound) {
    return static_cast<std::uint16_t>(std::min<int>(at + reach, bound));
  };
  const KeyBox& all = truth.bounds();
  return {{low(center.x, all.min.x), low(center.y, all.min.y), low(center.z, all.min.z)},
          {high(center.x, all.max.x), high(center.y, all.max.y), high(center.z, all.max.z)}};
}

// The nearest place whose pose, made of its voxel, is good.
template <class PoseAt>
std::optional<Pose> find(const GroundTruth& truth, const Eigen::Vector3d& around, const PoseAt& pose_at) {
  std::optional<Pose> found;
  const auto from = key_of(truth.lattice(), around);
  if (!from) return found;
  walk_open(
      truth, *from, search_box(truth, *from), [](const VoxelKey&) { return true; },
      [&](const VoxelKey& key) { return (found = pose_at(key)).has_value(); });
  return found;
}

bool has_floor(const GroundTruth& truth, const VoxelKey& key) {
  return key.z > truth.bounds().min.z &&
         !truth.open({key.x, key.y, static_cast<std::uint16_t>(key.z - 1)}, 2);
}

bool drives(const Robot& robot) { return robot.travel.motion == Motion::kPlane; }

bool all_free(const GroundTruth& truth, const KeyBox& box) {
  return all_of(box, [&](const VoxelKey& key) { return truth.at(key) == Truth::kFree; });
}

// Free voxels aside: one can go from each to the next.
bool no_wall_in(const GroundTruth& truth, const KeyBox& box) {
  return all_of(box, [&](const VoxelKey& key) {
    return (key.x == box.max.x || truth.open(key, 0)) && (key.y == box.max.y || truth.open(key, 1)) &&
           (key.z == box.max.z || truth.open(key, 2));
  });
}

// The node that holds a voxel, if the robot moves through nodes and all of it is free.
std::optional<KeyBox> free_node(const GroundTruth& truth, const Robot& robot, const VoxelKey& voxel) {
  if (drives(robot) || robot.travel.node_edge == 0.0) return std::nullopt;
  const Lattice& lattice = truth.lattice();
  const KeyBox node = voxels_of_cell(robot.travel, lattice, cell_of(robot.travel, lattice, voxel));
  if (!all_free(truth, node) || !no_wall_in(truth, node)) return std::nullopt;
  return node;
}

// The body and, above it, the sensor.
KeyBox taken_by(const Lattice& lattice, const Robot& robot, const Pose& sensor_pose) {
  KeyBox taken = body_voxels(lattice, robot, sensor_pose);
  taken.max.z = std::max(taken.max.z, key_of(lattice, sensor_pose.position).value().z);
  return taken;
}

bool overlaps_one(const KeyBox& box, std::span<const KeyBox> others) {
  return std::ranges::any_of(others, [&](const KeyBox& other) { return overlap(box, other); });
}

std::optional<Pose> find_on_floor(const GroundTruth& truth, const Eigen::Vector3d& around, const Robot& robot,
                                  std::span<const KeyBox> taken) {
  return find(truth, around, [&](const VoxelKey& key) -> std::optional<Pose> {
    if (!has_floor(truth, key)) return std::nullopt;
    Pose pose{center_of(truth.lattice(), key)};
    pose.position.z() = lower_end(truth.lattice(), key.z) + robot.travel.sensor_height;
    if (obstacle_at(truth, robot, pose)) return std::nullopt;
    if (overlaps_one(taken_by(truth.lattice(), robot, pose), taken)) return std::nullopt;
    return pose;
  });
}

std::optional<Pose> find_in_space(const GroundTruth& truth, const Eigen::Vector3d& around, const Robot& robot,
                                  double ground, std::span<const KeyBox> taken) {
  const Lattice& lattice = truth.lattice();
  constexpr double kRounding = 1e-9;
  const auto good = [&](const VoxelKey& key) -> std::optional<Pose> {
    const Pose pose{center_of(lattice, key)};
    if (pose.position.z() < ground + robot.travel.min_height - kRounding) return std::nullopt;
    if (obstacle_at(truth, robot, pose)) return std::nullopt;
    if (overlaps_one(taken_by(lattice, robot, pose), taken)) return std::nullopt;
    return pose;
  };
  if (robot.travel.node_edge > 0.0) {
    const auto in_node = find(truth, around, [&](const VoxelKey& key) -> std::optional<Pose> {
      if (cell_of(robot.travel, lattice, key) != key || !free_node(truth, robot, key)) return std::nullopt;
      // It is the node's own centre, half a voxel below, that a corridor measures.
      if (lower_end(lattice, key.z) < ground + robot.travel.min_height - kRounding) return std::nullopt;
      return good(key);
    });
    if (in_node) return in_node;
  }
  return find(truth, around, good);
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
  const KeyBox body = body_voxels(truth.lattice(), robot, sensor_pose);
  const auto sensor = key_of(truth.lattice(), sensor_pose.position);
  const KeyBox& all = truth.bounds();
  if (!sensor || !all.contains(*sensor) || !all.contains(body.min) || !all.contains(body.max))
    return "it would reach beyond the world's bounds";
  std::optional<std::string> why;
  const auto is_free = [&](const VoxelKey& key) {
    if (truth.at(key) == Truth::kFree) return true;
    const std::string where = to_text(center_of(truth.lattice(), key));
    why = truth.holds_surface(key) ? "a surface passes through its voxel at " + where + " m"
                                   : "its voxel at " + where + " m cannot be reached from the start";
    return false;
  };
  if (!all_of(body, is_free) || !is_free(*sensor)) return why;
  if (!no_wall_in(truth, body)) return "a wall would run through it";
  if (!drives(robot)) return why;
  for (VoxelKey above = {sensor->x, sensor->y, body.max.z}; above.z < sensor->z; ++above.z)
    if (!truth.open(above, 2)) return "a ceiling would part it from its sensor";
  KeyBox feet = body;
  feet.max.z = body.min.z;
  if (!all_of(feet, [&](const VoxelKey& key) { return has_floor(truth, key); }))
    return "there is no floor under all of it";
  return why;
}

Eigen::Vector3d free_start(const World& world, double resolution, bool faces_away) {
  if (!world.start) throw std::runtime_error(world.name + ": no start is known; give one in free space");
  const Eigen::Vector3d& start = *world.start;
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error(world.name + ": the start " + to_text(start) + " " + why);
  };
  if (!start.allFinite() || !world.bounds.contains(start)) refuse("is outside of the world's bounds");
  const Lattice lattice(resolution);
  Eigen::Vector3d free = start;
  const auto floor = floor_below(world.mesh, start);
  const auto layer = lattice.key(start.z());
  // What lies on a voxel's face, but for rounding, is in the voxel below.
  constexpr double kOnFace = 1e-3;  // [m]
  const auto floor_layer = floor ? lattice.key(*floor - kOnFace) : std::nullopt;
  const bool on_floor = floor && start.z() - *floor < kOnFace;
  if (layer && floor_layer && (on_floor || *floor_layer >= *layer) &&
      *floor_layer < Lattice::kKeysPerAxis - 1) {
    free.z() = lattice.center(static_cast<std::uint16_t>(*floor_layer + 1));
    const auto still = floor_below(world.mesh, free);
    if (!world.bounds.contains(free) || !still || *still > *floor + kOnFace)
      refuse("has no room above the floor that it is on, at z = " + std::to_string(*floor));
  }
  if (!faces_away) return free;
  const Surface surface(world.mesh);
  const Eigen::Vector3f from = free.cast<float>();
  const std::array<Surface::Ray, 2> rays{{{.origin = from, .direction = -Eigen::Vector3f::UnitZ()},
                                          {.origin = from, .direction = Eigen::Vector3f::UnitZ()}}};
  std::array<Surface::Hit, 2> hits;
  surface.cast(rays, hits);
  for (std::size_t i = 0; i < 2; ++i) {
    if (hits[i].triangle == Surface::kNone) continue;
    const auto& [a, b, c] = world.mesh.triangles[hits[i].triangle];
    const auto& vertices = world.mesh.vertices;
    const Eigen::Vector3d u = (vertices[b] - vertices[a]).cast<double>(),
                          v = (vertices[c] - vertices[a]).cast<double>();
    if (u.cross(v).dot(rays[i].direction.cast<double>()) > 0.0)
      refuse("is within a solid; give one in free space");
  }
  return free;
}

double ground_below(const GroundTruth& truth, const Eigen::Vector3d& around) {
  auto below = key_of(truth.lattice(), around);
  if (!below || truth.at(*below) != Truth::kFree) return lower_end(truth.lattice(), truth.bounds().min.z);
  while (below->z > truth.bounds().min.z && !has_floor(truth, *below)) --below->z;
  return lower_end(truth.lattice(), below->z);
}

std::vector<std::optional<Pose>> find_starts(const GroundTruth& truth, const Eigen::Vector3d& around,
                                             std::span<const Robot> robots) {
  std::vector<std::optional<Pose>> starts(robots.size());
  std::vector<KeyBox> taken;
  std::optional<double> ground;  // [m] the highest that a robot stands on
  const auto place = [&](std::size_t i, const std::optional<Pose>& pose) {
    if (!pose) return;
    starts[i] = pose;
    taken.push_back(taken_by(truth.lattice(), robots[i], *pose));
  };
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!drives(robots[i])) continue;
    place(i, find_on_floor(truth, around, robots[i], taken));
    if (!starts[i]) continue;
    const double stands_on = starts[i]->position.z() - robots[i].travel.sensor_height;
    ground = ground ? std::max(*ground, stands_on) : stands_on;
  }
  if (!ground) ground = ground_below(truth, around);
  for (std::size_t i = 0; i < robots.size(); ++i)
    if (!drives(robots[i])) place(i, find_in_space(truth, around, robots[i], *ground, taken));
  return starts;
}

std::vector<VoxelKey> start_bubble(const GroundTruth& truth, const Robot& robot, const Pose& sensor_pose) {
  const Lattice& lattice = truth.lattice();
  const Eigen::Vector3d& at = sensor_pose.position;
  const KeyBox body = body_voxels(lattice, robot, sensor_pose);
  const VoxelKey from = key_of(lattice, at).value();
  const std::optional<KeyBox> node = free_node(truth, robot, from);
  constexpr double kRounding = 1e-9;
  const auto in_bubble = [&](const VoxelKey& key) {
    if (body.contains(key) || (node && node->contains(key))) return true;
    const Eigen::Vector3d offset = center_of(lattice, key) - at;
    if (!drives(robot)) return offset.norm() <= kBall + kRounding;
    return offset.head<2>().norm() <= kDisc + kRounding && offset.z() <= kRounding && key.z >= body.min.z;
  };
  std::vector<VoxelKey> bubble;
  walk_open(
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
