// With exact sensing a map invents nothing: every occupied voxel touches a true surface, and every free one
// can be seen into from where the robot was, without looking through a wall.
#include "mesh/triangle_overlap.hpp"
#include "sim/world/place.hpp"
#include "support/maps.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/mesh_file.hpp>
#include <frontlux/sim/scan_world.hpp>

#include <algorithm>

namespace frontlux::sim {
namespace {

using planner::Mapping;

Eigen::AlignedBox3d box_of(const Lattice& lattice, const KeyBox& keys, double grown = 0.0) {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(lattice.resolution() / 2 + grown);
  return {lattice.exact_center(keys.min) - half, lattice.exact_center(keys.max) + half};
}

// The voxels that a surface comes within 2 mm of, triangle by triangle.
std::set<VoxelKey> touched_voxels(const World& world, const GroundTruth& truth) {
  constexpr double kNear = 2e-3;
  std::set<VoxelKey> touched;
  for (std::size_t i = 0; i < world.mesh.triangles.size(); ++i) {
    const TriangleOverlap triangle(corners_of(world.mesh, i));
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(kNear);
    const auto reach = intersection(
        planner::voxels_of(truth.lattice(), {triangle.bounds().min() - room, triangle.bounds().max() + room}),
        truth.bounds());
    if (!reach) continue;
    for_each_key(*reach, [&](const VoxelKey& key) {
      if (triangle.touches(box_of(truth.lattice(), {key, key}, kNear))) touched.insert(key);
    });
  }
  return touched;
}

// Whether a triangle crosses or touches a segment, by the signs of volumes.
bool is_blocked(const TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(mesh, i);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.dot(from - a) * normal.dot(to - a) > 0.0) continue;  // both ends are on one side
    const std::array<double, 3> volumes = {along.dot((a - from).cross(b - from)),
                                           along.dot((b - from).cross(c - from)),
                                           along.dot((c - from).cross(a - from))};
    const auto [least, greatest] = std::ranges::minmax(volumes);
    if (least >= 0.0 || greatest <= 0.0) return true;
  }
  return false;
}

// Gaps that are narrower than a voxel let rays through, so what the ground truth does not reach at the map's
// resolution may be seen into all the same: some point of it is in the line of sight of a sensor that looked,
// or a ray of a view enters it before it meets a surface.
class LinesOfSight {
 public:
  LinesOfSight(const World& world, const GroundTruth& truth, const std::vector<View>& views)
      : world_(world), truth_(truth), surface_(world.mesh), views_(views), scans_(views.size()) {
    for (const View& view : views)
      if (sensors_.empty() || view.sensor_pose.position != sensors_.back())
        sensors_.push_back(view.sensor_pose.position);
  }

  [[nodiscard]] bool enter(const VoxelKey& voxel) {
    constexpr double kRange = 10.0;  // [m] the longer one's
    const Eigen::AlignedBox3d box = box_of(truth_.lattice(), {voxel, voxel});
    for (const int samples : {3, 12})  // most are seen at a glance
      for (const Eigen::Vector3d& sensor : sensors_)
        if (box.exteriorDistance(sensor) < kRange && sees_into(sensor, box, samples)) return true;
    for (std::size_t view = 0; view < views_.size(); ++view)
      if (crosses(view, box)) return true;
    return false;
  }

 private:
  // Whether a ray of this view enters the box by more than a rounding before it meets a surface: by what the
  // sensor measures, which made the map, and by every triangle.
  [[nodiscard]] bool crosses(std::size_t view, const Eigen::AlignedBox3d& box) {
    const auto& [robot, pose] = views_[view];
    const Sensor sensor = sensor_of(robot == 1 ? planner::uav_description() : planner::ugv_description());
    if (box.exteriorDistance(pose.position) > sensor.field_of_view().max_range) return false;
    if (!scans_[view]) scans_[view] = sense(surface_, sensor, pose, 1);
    const planner::Scan& scan = *scans_[view];
    constexpr double kRounding = 1e-5;  // [m] of the end points, which are floats
    const Eigen::Vector3d origin = scan.origin.cast<double>();
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const Eigen::Vector3d direction = scan.directions[i].cast<double>();
      double enters = 0.0, leaves = std::min<double>(scan.ranges[i], scan.max_range) + kRounding;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double a = (box.min()[axis] - kRounding - origin[axis]) / direction[axis],
                     b = (box.max()[axis] + kRounding - origin[axis]) / direction[axis];
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
      }
      if (enters <= leaves &&
          !is_blocked(world_.mesh, origin, origin + std::max(0.0, enters - 2 * kRounding) * direction))
        return true;
    }
    return false;
  }

  // @param samples  along each axis
  [[nodiscard]] bool sees_into(const Eigen::Vector3d& sensor, const Eigen::AlignedBox3d& box,
                               int samples) const {
    std::vector<Surface::Ray> rays;
    for (int x = 0; x < samples; ++x)
      for (int y = 0; y < samples; ++y)
        for (int z = 0; z < samples; ++z) {
          const Eigen::Array3d part = (Eigen::Array3d(x, y, z) + 0.5) / samples;
          const Eigen::Vector3d point = box.min() + (part * box.sizes().array()).matrix();
          const Eigen::Vector3f from = sensor.cast<float>();
          const Eigen::Vector3f to = point.cast<float>() - from;
          rays.push_back({from, to, static_cast<double>(to.norm())});
        }
    std::vector<Surface::Hit> hits(rays.size());
    surface_.cast(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d from = rays[i].origin.cast<double>();
      if (hits[i].triangle == Surface::kNone &&
          !is_blocked(world_.mesh, from, from + rays[i].direction.cast<double>()))
        return true;
    }
    return false;
  }

  const World& world_;
  const GroundTruth& truth_;
  Surface surface_;
  const std::vector<View>& views_;
  std::vector<std::optional<planner::Scan>> scans_;  // of those views that were asked for
  std::vector<Eigen::Vector3d> sensors_;
};

struct Mapped {
  std::size_t free = 0, occupied = 0;
  std::size_t cleared = 0;  // surface that is mapped free
  std::size_t beyond = 0;   // seen through gaps that are narrower than a voxel
};

// Checks every voxel of a map.
Mapped expect_no_leak(const test::Place& place, const std::vector<View>& views, const Mapping& mapping) {
  const World& world = place.world;
  const GroundTruth& truth = place.truth;
  const std::set<VoxelKey> touched = touched_voxels(world, truth);
  LinesOfSight lines(world, truth, views);
  Mapped mapped;
  int complaints = 0;
  const auto complain = [&](const char* what, const VoxelKey& key) {
    if (++complaints <= 5)
      ADD_FAILURE() << what << " voxel at " << truth.lattice().center(key).transpose() << " of " << world.name
                    << " at " << truth.lattice().resolution() << " m";
  };
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    switch (mapping.grid().at(key)) {
      case Occupancy::kUnknown:
        return;
      case Occupancy::kOccupied:
        ++mapped.occupied;
        if (!touched.contains(key)) complain("no surface touches the occupied", key);
        return;
      case Occupancy::kFree:
        ++mapped.free;
        if (truth.at(key) == Truth::kFree) return;
        if (truth.at(key) == Truth::kSurface) {
          ++mapped.cleared;
          return;
        }
        ++mapped.beyond;
        if (complaints < 5 && !lines.enter(key)) complain("beyond a wall lies the free", key);
        return;
    }
  });
  EXPECT_EQ(complaints, 0);
  return mapped;
}

// What both robots map on a sweep from the world's start, bubbles included.
Mapped sweep_and_check(const World& world, double resolution, double spacing, bool faces_away) {
  const test::Place place(world, faces_away, resolution);
  const GroundTruth& truth = place.truth;
  Mapping mapping({.resolution = resolution, .bounds = truth.bounds()});
  std::vector<View> views;
  const std::vector<planner::RobotDescription> team = {planner::ugv_description(),
                                                       planner::uav_description()};
  const auto starts = place.starts({team[0].robot, team[1].robot});
  for (std::size_t i = 0; i < team.size(); ++i) {
    if (!starts[i]) continue;
    mapping.mark_free(start_bubble(truth, team[i].robot, *starts[i]));
    for (const planner::Pose& pose : sweep(truth, team[i].robot, *starts[i], spacing))
      views.push_back({i, pose});
  }
  EXPECT_FALSE(views.empty());
  EXPECT_EQ(scan_world(Surface(world.mesh), team, views, {}, mapping), views.size());
  const Mapped mapped = expect_no_leak(place, views, mapping);
  EXPECT_GT(mapped.free, 0U);
  EXPECT_GT(mapped.occupied, 0U);
  // Rays that graze a surface clear some of its voxels; not many.
  EXPECT_LT(static_cast<double>(mapped.cleared), 0.12 * static_cast<double>(mapped.occupied));
  // Nor many what is beyond a gap.
  EXPECT_LT(static_cast<double>(mapped.beyond), 0.005 * static_cast<double>(mapped.free));
  return mapped;
}

class NoLeakIn : public testing::TestWithParam<const char*> {};

TEST_P(NoLeakIn, ABuiltInWorld) {
  sweep_and_check(make_world(GetParam(), 2), 0.3, frontlux::test::long_mode() ? 2.0 : 6.0, true);
}

INSTANTIATE_TEST_SUITE_P(Worlds, NoLeakIn, testing::Values("maze", "factory", "station", "storage", "room"),
                         [](const auto& world) { return std::string(world.param); });

TEST(NoLeak, SmallVoxels) { sweep_and_check(make_world("room", 2), 0.1, 4.0, true); }

TEST(NoLeakLong, BuiltInWorldsInDetail) {
  for (const auto& [name, description] : built_in_worlds())
    for (const std::uint64_t seed : {1U, 3U}) {
      sweep_and_check(make_world(name, seed), 0.3, 1.5, true);
      sweep_and_check(make_world(name, seed), 0.1, 3.0, true);
    }
}

// Meshes made by others. A mesh does not say where it is free, so a file starts.csv beside them does, a line
// for each: file,x,y,z.
TEST(NoLeak, ExtraWorlds) {
  const char* folder = std::getenv("FRONTLUX_EXTRA_WORLDS");
  if (folder == nullptr) GTEST_SKIP() << "FRONTLUX_EXTRA_WORLDS names no folder of meshes";
  const auto list = std::filesystem::path(folder) / "starts.csv";
  std::ifstream lines(list);
  ASSERT_TRUE(lines) << list;
  int worlds = 0;
  for (std::string line; std::getline(lines, line); ++worlds) {
    std::istringstream fields(line);
    std::string name;
    Eigen::Vector3d start;
    char comma = 0;
    std::getline(fields, name, ',');
    fields >> start.x() >> comma >> start.y() >> comma >> start.z();
    ASSERT_FALSE(fields.fail()) << line;
    World world = read_mesh_world(std::filesystem::path(folder) / name);
    world.start = start;
    align_ground(world, std::nullopt, 0.3);
    sweep_and_check(world, 0.3, 3.0, false);
    if (frontlux::test::long_mode()) sweep_and_check(world, 0.1, 5.0, false);
  }
  EXPECT_GT(worlds, 0);
}

// A closed box of 12 x 9 x 3 m, its walls rectangles without thickness, with a closed room inside of it and a
// screen that ends in the open; all at `shift` from the voxel faces.
World thin_rooms(double shift) {
  World world;
  world.name = "thin rooms shifted by " + std::to_string(shift);
  const auto add = [&](const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    const auto first = static_cast<std::uint32_t>(world.mesh.vertices.size());
    for (const Eigen::Vector3d& p :
         {corner, Eigen::Vector3d(corner + u), Eigen::Vector3d(corner + v), Eigen::Vector3d(corner + u + v)})
      world.mesh.vertices.push_back((p + Eigen::Vector3d::Constant(shift)).cast<float>());
    world.mesh.triangles.push_back({first, first + 1, first + 2});
    world.mesh.triangles.push_back({first + 1, first + 3, first + 2});
  };
  const auto add_box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& size) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d along = size[axis] * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d u = size[(axis + 1) % 3] * Eigen::Vector3d::Unit((axis + 1) % 3);
      const Eigen::Vector3d v = size[(axis + 2) % 3] * Eigen::Vector3d::Unit((axis + 2) % 3);
      add(low, u, v);
      add(low + along, u, v);
    }
  };
  add_box({0, 0, 0}, {12, 9, 3});
  add_box({6, 0, 0}, {2.4, 3.6, 3});
  add({3, 3, 0}, {0, 6, 0}, {0, 0, 2.1});
  world.bounds = bounds_of(world.mesh);
  world.bounds.extend(world.bounds.min() - Eigen::Vector3d::Constant(1.5));
  world.bounds.extend(world.bounds.max() + Eigen::Vector3d::Constant(1.5));
  world.start = Eigen::Vector3d(1.5, 1.5, 1.0) + Eigen::Vector3d::Constant(shift);
  return world;
}

TEST(NoLeak, WallsWithoutThickness) {
  for (const double resolution : {0.3, 0.1})
    for (const double shift : {0.0, 0.0005, -0.0005, 0.05, 0.1234}) {
      if (resolution == 0.1 && shift != 0.05 && !frontlux::test::long_mode()) continue;
      const World world = thin_rooms(shift);
      const Mapped mapped = sweep_and_check(world, resolution, resolution == 0.1 ? 4.0 : 2.0, false);
      const double voxel = resolution * resolution * resolution;
      // All of the hall, not the closed room, nothing outside.
      const double hall = (12 * 9 - 2.4 * 3.6) * 3;
      EXPECT_LT(static_cast<double>(mapped.free) * voxel, hall * (shift == 0.0 ? 1.0 : 1.15)) << shift;
      EXPECT_GT(static_cast<double>(mapped.free) * voxel, hall * 0.75) << shift;
    }
}

}  // namespace
}  // namespace frontlux::sim
