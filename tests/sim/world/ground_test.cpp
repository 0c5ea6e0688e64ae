#include "support/random.hpp"

#include <frontlux/sim/ground.hpp>

namespace frontlux::sim {
namespace {

// A square floor of 10 m at `z`, and a table of 2 m at `z` + 0.8 m around (3, 3).
World make_floor(double z) {
  World world;
  const auto add = [&](float low, float high, double height) {
    const auto first = static_cast<std::uint32_t>(world.mesh.vertices.size());
    const auto at = static_cast<float>(height);
    for (const auto& [x, y] :
         {std::pair(low, low), std::pair(high, low), std::pair(high, high), std::pair(low, high)})
      world.mesh.vertices.emplace_back(x, y, at);
    world.mesh.triangles.push_back({first, first + 1, first + 2});
    world.mesh.triangles.push_back({first + 2, first, first + 3});  // wound the other way
  };
  add(-5, 5, z);
  add(2, 4, z + 0.8);
  world.bounds = bounds_of(world.mesh);
  world.bounds.extend(Eigen::Vector3d(0, 0, z + 3));
  world.start = Eigen::Vector3d(0, 0, z + 1);
  return world;
}

TEST(Ground, IsTheFirstSurfaceBelow) {
  const World world = make_floor(2.5);
  EXPECT_FLOAT_EQ(static_cast<float>(floor_below(world.mesh, {0.3, 0.1, 9}).value()), 2.5F);
  EXPECT_FLOAT_EQ(static_cast<float>(floor_below(world.mesh, {3.3, 3.1, 9}).value()), 3.3F);
  EXPECT_FLOAT_EQ(static_cast<float>(floor_below(world.mesh, {3.3, 3.1, 3.2}).value()), 2.5F);
  EXPECT_FLOAT_EQ(static_cast<float>(floor_below(world.mesh, {3.3, 3.1, 3.295}).value()), 3.3F)
      << "1 cm above";
  EXPECT_FLOAT_EQ(static_cast<float>(floor_below(world.mesh, {1, 1, 9}).value()), 2.5F) << "on a diagonal";
  EXPECT_FALSE(floor_below(world.mesh, {5.1, 0, 9}).has_value());
  EXPECT_FALSE(floor_below(world.mesh, {0, 0, 2.4}).has_value());
  TriangleMesh wall;
  wall.vertices = {{0, -1, 0}, {0, 1, 0}, {0, 0, 1}};
  wall.triangles = {{0, 1, 2}};
  EXPECT_FALSE(floor_below(wall, {0, 0, 2}).has_value());
}

TEST(Ground, OfASlopeIsRightBelow) {
  TriangleMesh slope;
  slope.vertices = {{0, 0, 0}, {10, 0, 5}, {0, 10, 0}};
  slope.triangles = {{0, 2, 1}};
  EXPECT_NEAR(floor_below(slope, {4, 1, 8}).value(), 2.0, 1e-12);
}

TEST(Ground, ComesToLieJustBelowABoundary) {
  test::Random random(11);
  for (int i = 0; i < 500; ++i) {
    const double z = i == 0 ? 0.0 : random.uniform(-20, 20);
    const double resolution = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 0.05 : random.uniform(0.02, 2.0);
    World world = make_floor(z);
    const World before = world;
    const bool by_height = i % 2 == 0;
    const double shift = align_ground(world, by_height ? std::optional(z) : std::nullopt, resolution);
    EXPECT_LE(std::abs(shift), resolution / 2 + 1e-6);
    const double below = std::min(0.05, resolution / 2);
    const double layers = (world.mesh.vertices[0].z() + below) / resolution;
    EXPECT_NEAR(layers, std::round(layers), 1e-5 / resolution) << z << " at " << resolution;
    // Everything moved by the shift, and along z only.
    for (std::size_t v = 0; v < world.mesh.vertices.size(); ++v) {
      const Eigen::Vector3f moved = world.mesh.vertices[v] - before.mesh.vertices[v];
      EXPECT_EQ(moved.head<2>().norm(), 0.0F);
      EXPECT_NEAR(moved.z(), shift, 1e-5);
    }
    EXPECT_NEAR((*world.start - *before.start - Eigen::Vector3d(0, 0, shift)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(world.bounds.min().z() - before.bounds.min().z(), shift, 1e-12);
    EXPECT_NEAR(world.bounds.max().z() - before.bounds.max().z(), shift, 1e-12);
    EXPECT_EQ(align_ground(world, std::nullopt, resolution), 0.0) << "a second time";
  }
}

TEST(Ground, RefusesWhatItCannotFind) {
  World world = make_floor(0);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(align_ground(world, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(align_ground(world, 0.0, kNan), std::invalid_argument);
  EXPECT_THROW(align_ground(world, kNan, 0.3), std::invalid_argument);
  world.start = Eigen::Vector3d(0, 0, -1);
  EXPECT_THROW(align_ground(world, std::nullopt, 0.3), std::runtime_error);
  world.start.reset();
  EXPECT_THROW(align_ground(world, std::nullopt, 0.3), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::sim
