#include "support/test.hpp"

#include <frontlux/sim/world.hpp>

namespace frontlux::sim {
namespace {

// A tetrahedron with legs of 1, 2 and 3 m along the axes, far away, where floats are coarse.
TriangleMesh make_tetrahedron(float far) {
  TriangleMesh mesh;
  const Eigen::Vector3f apex(far, -far, far);
  mesh.vertices = {apex, apex + Eigen::Vector3f(1, 0, 0), apex + Eigen::Vector3f(0, 2, 0),
                   apex + Eigen::Vector3f(0, 0, 3)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(World, VolumeAndAreaOfATetrahedron) {
  for (const float far : {0.F, 1024.F}) {
    TriangleMesh mesh = make_tetrahedron(far);
    ASSERT_TRUE(solid_volume(mesh).has_value());
    EXPECT_NEAR(*solid_volume(mesh), 1.0, 1e-12);
    // The fourth side lies across (-1, 2, 0) and (-1, 0, 3), whose cross product is (6, 3, 2).
    EXPECT_NEAR(surface_area(mesh), (2.0 + 3.0 + 6.0 + 7.0) / 2.0, 1e-12);
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    EXPECT_NEAR(solid_volume(mesh).value(), -1.0, 1e-12);
  }
}

TEST(World, AreaOfATetrahedronWithinABox) {
  const TriangleMesh mesh = make_tetrahedron(0);
  const auto area = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    return surface_area(mesh, Eigen::AlignedBox3d(low, high));
  };
  EXPECT_NEAR(area({-1, -1, -1}, {4, 4, 4}), surface_area(mesh), 1e-12);
  EXPECT_NEAR(area({0, 0, 0}, {1, 2, 3}), surface_area(mesh), 1e-12) << "faces of the box belong to it";
  EXPECT_EQ(area({5, 5, 5}, {6, 6, 6}), 0.0);
  EXPECT_EQ(area({0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}), 0.0) << "inside";
  EXPECT_EQ(surface_area(mesh, Eigen::AlignedBox3d()), 0.0) << "an empty box";
  // Below z = 1.5 three quarters of each side that rises to the apex are left, and all of the floor.
  EXPECT_NEAR(area({-1, -1, -1}, {4, 4, 1.5}), 1.0 + 0.75 * (1.5 + 3.0 + 3.5), 1e-12);
}

TEST(World, OpenOrMixedSurfacesHaveNoVolume) {
  TriangleMesh open = make_tetrahedron(0);
  open.triangles.pop_back();
  EXPECT_FALSE(solid_volume(open).has_value());
  TriangleMesh mixed = make_tetrahedron(0);
  std::swap(mixed.triangles[2][0], mixed.triangles[2][1]);
  EXPECT_FALSE(solid_volume(mixed).has_value());
  EXPECT_EQ(solid_volume({}), 0.0);
}

TEST(World, BoundsLeaveOutVerticesOfNoTriangle) {
  TriangleMesh mesh = make_tetrahedron(0);
  mesh.vertices.emplace_back(100, 100, 100);
  EXPECT_EQ(bounds_of(mesh).min(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(bounds_of(mesh).max(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(bounds_of({}).isEmpty());
}

TEST(World, VoxelsAreCountedWithoutALimit) {
  using Vector = Eigen::Vector3d;
  const auto box = [](const Vector& min, const Vector& max) { return Eigen::AlignedBox3d(min, max); };
  EXPECT_EQ(voxel_count(box({0.1, 0.1, 0.1}, {0.4, 0.9, 0.2}), 0.5), 2.0);
  EXPECT_EQ(voxel_count(box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}), 0.5), 8.0);
  EXPECT_EQ(voxel_count(box({0, 0, 0}, {0, 0, 0}), 0.5), 1.0);
  EXPECT_NEAR(voxel_count(box({0, 0, 0}, {1e6, 1e6, 1e6}), 0.01), 1e24, 1e18);
  EXPECT_EQ(voxel_count({}, 0.5), 0.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double resolution : {0.0, -1.0, kInfinity, std::nan("")})
    EXPECT_THROW(static_cast<void>(voxel_count(box({0, 0, 0}, {1, 1, 1}), resolution)),
                 std::invalid_argument);
  EXPECT_THROW(static_cast<void>(voxel_count(box({0, 0, 0}, {1, 1, kInfinity}), 1)), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::sim
