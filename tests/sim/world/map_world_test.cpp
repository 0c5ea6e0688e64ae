#include "support/random.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/map_world.hpp>

namespace frontlux::sim {
namespace {

constexpr int kEdge = 12, kLow = Lattice::kOrigin - 5;  // across the origin and across bricks

constexpr KeyBox kBox = cube({kLow, kLow, kLow}, kEdge);

VoxelKey key(int x, int y, int z) { return make_key(kLow + x, kLow + y, kLow + z); }

VoxelGrid random_grid(std::uint64_t seed, int one_in) {
  VoxelGrid grid(0.25);
  test::Random random(seed);
  for_each_key(kBox, [&](const VoxelKey& at) {
    const bool occupied = random.one_in(one_in);
    if (occupied || random.one_in(2)) grid.set(at, occupied ? Occupancy::kOccupied : Occupancy::kFree);
  });
  return grid;
}

// By axis, plane and the voxel's two other keys: +1 for each face upwards, -1 downwards.
using Faces = std::map<std::array<int, 4>, int>;

Faces faces_of(const VoxelGrid& grid, std::size_t& occupied) {
  Faces faces;
  const auto is_occupied = [&](const std::array<int, 3>& c) {
    return grid.at(key(c[0], c[1], c[2])) == Occupancy::kOccupied;
  };
  for_each_key(kBox, [&](const VoxelKey& at) {
    const std::array<int, 3> c = {at.x - kLow, at.y - kLow, at.z - kLow};
    if (!is_occupied(c)) return;
    ++occupied;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        auto beyond = c;
        beyond[axis] += 2 * side - 1;
        if (!is_occupied(beyond))
          faces[{static_cast<int>(axis), c[axis] + side, c[(axis + 1) % 3], c[(axis + 2) % 3]}] +=
              2 * side - 1;
      }
  });
  return faces;
}

// Which voxel faces the triangles cover, found at a point of each face that lies on no triangle's side.
Faces faces_of(const World& world, double resolution) {
  Faces faces;
  for (std::size_t t = 0; t < world.mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3d, 3> corner = corners_of(world.mesh, t);
    for (auto& c : corner) c = (c / resolution).array() + (Lattice::kOrigin - kLow);
    int axis = 0;
    while (axis < 3 && !(corner[0][axis] == corner[1][axis] && corner[1][axis] == corner[2][axis])) ++axis;
    if (axis == 3) {
      ADD_FAILURE() << "a triangle lies in no lattice plane";
      continue;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    EXPECT_EQ(corner[0][axis], std::round(corner[0][axis]));
    for (int i = 0; i < kEdge; ++i)
      for (int j = 0; j < kEdge; ++j) {
        const double pu = i + 0.4971, pv = j + 0.5083;
        int left = 0, right = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto &a = corner[k], &b = corner[(k + 1) % 3];
          const double side = (a[u] - pu) * (b[v] - pv) - (a[v] - pv) * (b[u] - pu);
          left += side > 0 ? 1 : 0;
          right += side < 0 ? 1 : 0;
        }
        if (left == 3 || right == 3)
          faces[{axis, static_cast<int>(std::round(corner[0][axis])), i, j}] += left == 3 ? 1 : -1;
      }
  }
  return faces;
}

TEST(MapWorld, HasTheFacesOfItsOccupiedVoxels) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const VoxelGrid grid = random_grid(seed, seed % 3 == 0 ? 2 : seed % 3 == 1 ? 9 : 40);
    const World world = make_map_world(grid);
    std::size_t occupied = 0;
    const Faces expected = faces_of(grid, occupied);
    ASSERT_EQ(faces_of(world, 0.25), expected) << seed;
    EXPECT_NEAR(surface_area(world.mesh), static_cast<double>(expected.size()) / 16, 1e-9);
    ASSERT_TRUE(solid_volume(world.mesh).has_value()) << "cracks, seed " << seed;
    EXPECT_NEAR(*solid_volume(world.mesh), static_cast<double>(occupied) / 64, 1e-9);
    const KeyBox known = grid.known_bounds().value();
    EXPECT_EQ(world.bounds.min().x(), (known.min.x - Lattice::kOrigin) * 0.25);
    EXPECT_EQ(world.bounds.max().z(), (known.max.z + 1 - Lattice::kOrigin) * 0.25);
    EXPECT_FALSE(world.start.has_value());
  }
}

TEST(MapWorld, MergesFaces) {
  VoxelGrid grid(0.5);
  grid.fill({{32768, 32768, 32768}, 5}, Occupancy::kOccupied);  // a cube of 16 m
  const World cube = make_map_world(grid);
  EXPECT_EQ(cube.mesh.triangles.size(), 12U);
  EXPECT_EQ(cube.mesh.vertices.size(), 8U);
  EXPECT_EQ(solid_volume(cube.mesh), 16.0 * 16.0 * 16.0);
  EXPECT_EQ(surface_area(cube.mesh), 6.0 * 16.0 * 16.0);
  EXPECT_EQ(cube.bounds.min(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(cube.bounds.max(), Eigen::Vector3d(16, 16, 16));
}

TEST(MapWorld, ReachesTheEndsOfTheKeyRange) {
  VoxelGrid grid(0.1);
  grid.set({0, 0, 0}, Occupancy::kOccupied);
  grid.set({65535, 65535, 65535}, Occupancy::kOccupied);
  const World world = make_map_world(grid);
  EXPECT_EQ(world.mesh.triangles.size(), 24U);
  EXPECT_NEAR(world.bounds.max().x(), 3276.8, 1e-9);
  EXPECT_NEAR(world.bounds.min().x(), -3276.8, 1e-9);
}

TEST(MapWorld, RefusesMapsWithoutAWorld) {
  VoxelGrid grid(0.1);
  EXPECT_THROW(static_cast<void>(make_map_world(grid)), std::runtime_error);
  grid.set({1, 2, 3}, Occupancy::kFree);
  EXPECT_THROW(static_cast<void>(make_map_world(grid)), std::runtime_error);
  grid.fill({{0, 0, 0}, 15}, Occupancy::kOccupied);  // 6 * 2^30 faces
  EXPECT_THROW(static_cast<void>(make_map_world(grid)), std::runtime_error);
}

// A file of 2 kB may hold as many blocks of 64 voxels a side, none of which touches another one.
TEST(MapWorld, RefusesManyBlocksWithMoreFacesThanTheirNumberBrings) {
  VoxelGrid grid(0.1);
  constexpr int kBlocks = 720, kSpacing = 128;  // 6 * 64^2 faces each
  for (int i = 0; i < kBlocks; ++i)
    grid.fill({make_key(i % 20 * kSpacing, i / 20 * kSpacing, 0), 6}, Occupancy::kOccupied);
  EXPECT_THROW(static_cast<void>(make_map_world(grid)), std::runtime_error);
}

}  // namespace
}  // namespace frontlux::sim
