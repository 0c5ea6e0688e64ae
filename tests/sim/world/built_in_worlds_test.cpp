#include "sim/world/solid_voxels.hpp"
#include "support/complaint.hpp"
#include "support/maps.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground.hpp>

namespace frontlux::sim {
namespace {

using Cell = test::SolidVoxels::Cell;

std::uint64_t hash_of(const World& world) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  const auto eat = [&](const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001B3U;
  };
  eat(world.mesh.vertices.data(), world.mesh.vertices.size() * sizeof(Eigen::Vector3f));
  eat(world.mesh.triangles.data(), world.mesh.triangles.size() * 12);
  eat(world.start->data(), 24);
  return hash;
}

void for_all(const std::function<void(const World&, std::uint64_t seed)>& check, std::uint64_t seeds) {
  for (const auto& [name, description] : built_in_worlds())
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(seed));
      check(make_world(name, seed), seed);
      if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(BuiltInWorlds, AreTheSameForTheSameSeedOnly) {
  std::set<std::uint64_t> hashes;
  for_all(
      [&](const World& world, std::uint64_t seed) {
        EXPECT_EQ(hash_of(world), hash_of(make_world(world.name, seed)));
        EXPECT_TRUE(hashes.insert(hash_of(world)).second) << "another seed gave the same world";
      },
      4);
}

TEST(BuiltInWorlds, HaveTheSizesOfTheirDescription) {
  const std::map<std::string, Eigen::Vector3d> inside = {{"maze", {40, 40, 3}},
                                                         {"factory", {45, 30, 9}},
                                                         {"station", {80, 40, 12}},
                                                         {"storage", {25, 15, 6}},
                                                         {"room", {12, 12, 3}}};
  ASSERT_EQ(built_in_worlds().size(), inside.size());
  for_all(
      [&](const World& world, std::uint64_t) {
        const Eigen::Vector3d& size = inside.at(world.name);
        // 0.3 m of wall on each side; 1.1 m more below the station's floor.
        const double below = world.name == "station" ? 1.1 : 0.0;
        const Eigen::Vector3d expected = size + Eigen::Vector3d(0.6, 0.6, 0.6 + below);
        EXPECT_LT((world.bounds.sizes() - expected).cwiseAbs().maxCoeff(), 1e-4) << world.bounds.sizes();
        EXPECT_EQ(world.bounds.min(), bounds_of(world.mesh).min());
        EXPECT_EQ(world.bounds.max(), bounds_of(world.mesh).max());
      },
      3);
}

// Every side of a triangle is the side of another one that runs the other way, and none is split.
TEST(BuiltInWorlds, AreClosedWithoutCracks) {
  for_all(
      [](const World& world, std::uint64_t) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
        for (const auto& t : world.mesh.triangles) {
          for (std::size_t i = 0; i < 3; ++i) {
            const auto a = t[i], b = t[(i + 1) % 3];
            ASSERT_NE(a, b);
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
          }
          const Eigen::Vector3f u = world.mesh.vertices[t[1]] - world.mesh.vertices[t[0]];
          const Eigen::Vector3f v = world.mesh.vertices[t[2]] - world.mesh.vertices[t[0]];
          ASSERT_GT(u.cross(v).norm(), 1e-4F);
        }
        for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0) << edge.first << " to " << edge.second;
      },
      5);
}

// The volume within the surface equals that of the voxels of 0.1 m whose centres lie inside.
TEST(BuiltInWorlds, FaceAwayFromTheirSolids) {
  const World world = make_world("room", 3);
  // The room's lattice: x and y at 0.04 m, z at -0.05 m, and decimetres from there.
  double inside = 0.0;
  for (int x = -4; x < 125; ++x)
    for (int y = -4; y < 125; ++y) {
      const Eigen::Vector2d p(x / 10.0 + 0.0909, y / 10.0 + 0.0877);
      for (std::size_t triangle = 0; triangle < world.mesh.triangles.size(); ++triangle) {
        const auto c = corners_of(world.mesh, triangle);
        int left = 0, right = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const Eigen::Vector2d a = c[i].head<2>() - p, b = c[(i + 1) % 3].head<2>() - p;
          (a.x() * b.y() - a.y() * b.x() > 0 ? left : right)++;
        }
        if (left == 3) inside += c[0].z() * 0.01;
        if (right == 3) inside -= c[0].z() * 0.01;
      }
    }
  ASSERT_TRUE(solid_volume(world.mesh).has_value());
  EXPECT_NEAR(*solid_volume(world.mesh), inside, 1e-3);
  EXPECT_GT(inside, 100.0);
}

TEST(BuiltInWorlds, KeepOffTheFacesOfVoxels) {
  for_all(
      [](const World& world, std::uint64_t) {
        for (const double resolution : {0.1, 0.2, 0.3})
          for (const auto& t : world.mesh.triangles)
            for (int axis = 0; axis < 3; ++axis) {
              const auto along = [&](std::size_t i) {
                return static_cast<double>(world.mesh.vertices[t[i]][axis]);
              };
              if (along(0) != along(1) || along(1) != along(2)) continue;
              const double off = std::remainder(along(0), resolution);
              ASSERT_GT(std::abs(off), 0.039) << along(0) << " at " << resolution;
            }
      },
      3);
}

TEST(BuiltInWorlds, StandOnTheirFloor) {
  for_all(
      [](const World& world, std::uint64_t) {
        ASSERT_TRUE(world.start.has_value());
        EXPECT_FLOAT_EQ(static_cast<float>(world.start->z()), -0.05F);
        const auto floor = floor_below(world.mesh, *world.start);
        ASSERT_TRUE(floor.has_value());
        EXPECT_NEAR(*floor, -0.05, 1e-6);
      },
      20);
}

TEST(BuiltInWorlds, RefuseOtherNames) {
  for (const char* name : {"", "mazes", "Maze", "hangar"}) {
    frontlux::test::expect_complaint(
        [&] { static_cast<void>(make_world(name, 1)); },
        {std::string("'") + name + "'", "maze, factory, station, storage, room"});
  }
}

struct Reach {
  std::size_t all = 0, reached = 0;
};

// How many of the places where a robot fits it can get to, by steps through the six faces.
Reach flood(const Cell& size, const Cell& start, const std::function<bool(const Cell&)>& fits) {
  const auto index = [&](const Cell& c) {
    return (static_cast<std::size_t>(c[0]) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(c[1])) *
               static_cast<std::size_t>(size[2]) +
           static_cast<std::size_t>(c[2]);
  };
  std::vector<char> open(index({size[0], 0, 0}));
  Reach reach;
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z)
        if (fits({x, y, z})) {
          open[index({x, y, z})] = 1;
          ++reach.all;
        }
  std::vector<Cell> trail;
  const auto enter = [&](const Cell& c) {
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] < 0 || c[i] >= size[i]) return;
    if (open[index(c)] != 1) return;
    open[index(c)] = 2;
    ++reach.reached;
    trail.push_back(c);
  };
  enter(start);
  while (!trail.empty()) {
    const Cell c = trail.back();
    trail.pop_back();
    for (std::size_t i = 0; i < 3; ++i)
      for (const int step : {-1, 1}) {
        Cell next = c;
        next[i] += step;
        enter(next);
      }
  }
  return reach;
}

// Wherever a robot fits, it can get to from the start, at voxels of 0.3 m: the UGV's box of 1 m takes 5 x 5 x
// 3 voxels around a voxel's centre, over a floor, and the UAV's of 0.8 m takes 3 x 3 x 3, at 1.2 m or higher.
TEST(BuiltInWorlds, CanBeExplored) {
  for_all(
      [&](const World& world, std::uint64_t) {
        const test::SolidVoxels voxels(world, 0.3);
        Cell start = voxels.local(*world.start + Eigen::Vector3d(0, 0, 0.1));
        const int ground = start[2];
        const auto ugv_fits = [&](const Cell& c) {
          if (c[2] != ground || !voxels.free({c[0] - 2, c[1] - 2, ground}, {c[0] + 2, c[1] + 2, ground + 2}))
            return false;
          return voxels.all_solid({c[0] - 2, c[1] - 2, ground - 1}, {c[0] + 2, c[1] + 2, ground - 1});
        };
        const auto uav_fits = [&](const Cell& c) {
          return voxels.center_z(c[2]) >= 1.2 &&
                 voxels.free({c[0] - 1, c[1] - 1, c[2] - 1}, {c[0] + 1, c[1] + 1, c[2] + 1});
        };
        ASSERT_TRUE(ugv_fits(start));
        const Reach ugv = flood(voxels.size(), start, ugv_fits);
        while (voxels.center_z(start[2]) < 1.2) ++start[2];
        ASSERT_TRUE(uav_fits(start));
        const Reach uav = flood(voxels.size(), start, uav_fits);
        EXPECT_EQ(ugv.reached, ugv.all);
        EXPECT_EQ(uav.reached, uav.all);
      },
      test::long_mode() ? 200 : 4);
}

// Each robot has places of its own: tunnels and underpasses, where there is no room above 1.2 m, and floors
// that stand on others.
TEST(BuiltInWorlds, NeedBothRobots) {
  for (std::uint64_t seed = 1; seed <= (test::long_mode() ? 20 : 4); ++seed)
    for (const char* name : {"maze", "factory", "station"}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(seed));
      const World world = make_world(name, seed);
      const test::SolidVoxels voxels(world, 0.3);
      const int ground = voxels.local(*world.start + Eigen::Vector3d(0, 0, 0.1))[2];
      int low = 0, raised = 0;
      for (int x = 2; x + 2 < voxels.size()[0]; ++x)
        for (int y = 2; y + 2 < voxels.size()[1]; ++y) {
          low += voxels.free({x - 2, y - 2, ground}, {x + 2, y + 2, ground + 2}) &&
                 voxels.solid({x, y, ground + 3});
          for (int z = ground + 4; z + 2 < voxels.size()[2]; ++z)
            raised += voxels.solid({x, y, z - 1}) && voxels.free({x - 1, y - 1, z}, {x + 1, y + 1, z + 2});
        }
      if (std::string(name) != "station") {
        EXPECT_GT(low, 0);
      }
      EXPECT_GT(raised, 10);
    }
}

}  // namespace
}  // namespace frontlux::sim
