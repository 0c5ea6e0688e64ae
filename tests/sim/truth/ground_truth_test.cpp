// Against box worlds in closed form, flooded by another method; against rays; and what must be refused.

#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/surface.hpp>

#include <tbb/task_arena.h>

namespace frontlux::sim {
namespace {

using frontlux::test::Random;

constexpr double kEdge = 0.3;

World world_of(const std::vector<Eigen::AlignedBox3f>& boxes, const Eigen::AlignedBox3d& bounds) {
  World world{"boxes", {}, bounds, std::nullopt};
  for (const auto& box : boxes) test::add_box(world.mesh, box);
  return world;
}

using frontlux::test::key_at;

// Each of them alone is painted in a moment.
TEST(GroundTruth, RefusesLargeTrianglesThatLieOnEachOther) {
  World world{"sheets", {}, Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(60, 60, 60)), {}};
  world.mesh.vertices = {{0, 0, 1}, {60, 0, 59}, {0, 60, 30}};
  world.mesh.triangles = {{0, 1, 2}};
  const Eigen::Vector3d start(1, 1, 5);
  EXPECT_EQ(GroundTruth(world, kEdge, start).at(key_at(0, 0, 3)), Truth::kSurface);
  for (int i = 0; i < 100'000; ++i) world.mesh.triangles.push_back({0, 1, 2});
  frontlux::test::expect_parts(
      frontlux::test::complaint_of<std::invalid_argument>([&] { GroundTruth(world, kEdge, start); }),
      {"leave out triangles that are there twice"});
}

std::vector<std::pair<VoxelKey, Truth>> observable_voxels(const GroundTruth& truth) {
  std::vector<std::pair<VoxelKey, Truth>> voxels;
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    if (truth.contains(key)) voxels.emplace_back(key, truth.at(key));
  });
  return voxels;
}

// The truth of a world of boxes (their surfaces; a box may be flat) over [0, n) voxels on each axis, with the
// definitions taken by the word: nothing here knows of triangles.
class BoxTruth {
 public:
  BoxTruth(std::vector<Eigen::AlignedBox3f> boxes, int n, const Eigen::Vector3i& start)
      : boxes_(std::move(boxes)), n_(n), reached_(static_cast<std::size_t>(n * n * n)) {
    reached_[index(start)] = true;
    // Sweeps over everything until nothing changes: slow, and not how the ground truth floods.
    for (bool changed = true; changed;) {
      changed = false;
      for_each([&](const Eigen::Vector3i& cell) {
        if (reached_[index(cell)] || solid(cell)) return;
        for_each_neighbour(cell, [&](const Eigen::Vector3i& other, int axis) {
          if (!reached_[index(other)] || wall(cell.cwiseMax(other), axis)) return;
          reached_[index(cell)] = true;
          changed = true;
        });
      });
    }
  }

  [[nodiscard]] Truth at(const Eigen::Vector3i& cell) const {
    if (reached_[index(cell)]) return Truth::kFree;
    Truth truth = Truth::kHidden;
    for_each_neighbour(cell, [&](const Eigen::Vector3i& other, int) {
      if (reached_[index(other)]) truth = Truth::kSurface;
    });
    return truth;
  }

  [[nodiscard]] bool solid(const Eigen::Vector3i& cell) const { return on_a_surface(inside(cell)); }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x) visit(Eigen::Vector3i(x, y, z));
  }

 private:
  [[nodiscard]] static Eigen::AlignedBox3d inside(const Eigen::Vector3i& cell) {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(0.001);
    const Eigen::Vector3d low = cell.cast<double>() * kEdge;
    return {low + margin, low + Eigen::Vector3d::Constant(kEdge) - margin};
  }
  // A box's surface meets what the box meets and does not swallow.
  [[nodiscard]] bool on_a_surface(const Eigen::AlignedBox3d& region) const {
    for (const auto& single : boxes_) {
      const Eigen::AlignedBox3d box = single.cast<double>();
      const bool meets = (box.min().array() <= region.max().array()).all() &&
                         (box.max().array() >= region.min().array()).all();
      const bool swallows = (box.min().array() < region.min().array()).all() &&
                            (box.max().array() > region.max().array()).all();
      if (meets && !swallows) return true;
    }
    return false;
  }
  [[nodiscard]] bool wall(const Eigen::Vector3i& upper, int axis) const {
    Eigen::AlignedBox3d face = inside(upper);
    face.min()[axis] = upper[axis] * kEdge - 0.001;
    face.max()[axis] = upper[axis] * kEdge + 0.001;
    return on_a_surface(face);
  }
  template <class Visit>
  void for_each_neighbour(const Eigen::Vector3i& cell, const Visit& visit) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        Eigen::Vector3i other = cell;
        other[axis] += step;
        if (other[axis] >= 0 && other[axis] < n_) visit(other, axis);
      }
  }
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& cell) const {
    return static_cast<std::size_t>((cell.z() * n_ + cell.y()) * n_ + cell.x());
  }

  std::vector<Eigen::AlignedBox3f> boxes_;
  int n_;
  std::vector<bool> reached_;
};

// Boxes with sides anywhere, on voxel faces, within the margin of them, and just beyond it; some of them
// flat.
std::vector<Eigen::AlignedBox3f> random_boxes(Random& random, int count, int n) {
  std::vector<Eigen::AlignedBox3f> boxes;
  for (int i = 0; i < count; ++i) {
    Eigen::AlignedBox3f box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto coordinate = [&] {
        const double anywhere = random.uniform(-0.5, n * kEdge + 0.5);
        const double face = std::round(anywhere / kEdge) * kEdge;
        const int kind = random.below(4);
        if (kind == 0) return anywhere;
        return kind == 1 ? face + random.pick(std::array{0.0009, -0.0009, 0.0011, -0.0011}) : face;
      };
      const auto a = static_cast<float>(coordinate()), b = static_cast<float>(coordinate());
      box.min()[axis] = std::min(a, b);
      box.max()[axis] = std::max(a, b);
    }
    if (random.one_in(3)) {
      const int axis = random.below(3);
      box.max()[axis] = box.min()[axis];
    }
    boxes.push_back(box);
  }
  return boxes;
}

TEST(GroundTruth, RandomBoxWorldsByTheDefinition) {
  Random random(1);
  constexpr int kCells = 14;
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(kCells * kEdge));
  std::size_t compared = 0, partly = 0;
  for (int round = 0; round < 150; ++round) {
    const auto boxes = random_boxes(random, 1 + random.below(7), kCells);
    const Eigen::Vector3i start(random.below(kCells), random.below(kCells), random.below(kCells));
    const World world = world_of(boxes, bounds);
    const Eigen::Vector3d point = (start.cast<double>() + Eigen::Vector3d::Constant(0.5)) * kEdge;
    const BoxTruth expected(boxes, kCells, start);
    if (expected.solid(start)) {
      EXPECT_THROW(GroundTruth(world, kEdge, point), std::invalid_argument);
      continue;
    }
    const GroundTruth truth(world, kEdge, point);
    std::array<std::uint64_t, 3> counts{};
    expected.for_each([&](const Eigen::Vector3i& cell) {
      const VoxelKey key = key_at(cell.x(), cell.y(), cell.z());
      ASSERT_EQ(truth.at(key), expected.at(cell)) << "round " << round << ", cell " << cell.transpose();
      ASSERT_EQ(truth.holds_surface(key), expected.solid(cell)) << cell.transpose();
      ++counts[static_cast<std::size_t>(truth.at(key))];
    });
    EXPECT_EQ(truth.free_voxels(), counts[1]);
    EXPECT_EQ(truth.surface_voxels(), counts[2]);
    EXPECT_EQ(truth.bounding_voxels(), counts[0] + counts[1] + counts[2]);
    ++compared;
    partly += counts[0] > 100 && counts[1] > 100 ? 1 : 0;
  }
  EXPECT_GT(compared, 80U);
  EXPECT_GT(partly, 15U);
}

// A room of 8 x 8 x 8 voxels, its walls within voxels, and then exactly on the faces between voxels.
TEST(GroundTruth, CountsOfARoom) {
  for (const float wall : {0.15F, 0.3F}) {
    const World world = world_of({{Eigen::Vector3f::Constant(wall), Eigen::Vector3f::Constant(3.0F - wall)}},
                                 {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(3.0)});
    const GroundTruth truth(world, 0.3, {1.5, 1.5, 1.5});
    EXPECT_EQ(truth.bounding_voxels(), 1000U);
    EXPECT_EQ(truth.free_voxels(), 512U);
    EXPECT_EQ(truth.surface_voxels(), 384U);
    EXPECT_EQ(truth.at(key_at(0, 5, 5)), Truth::kSurface);
    EXPECT_EQ(truth.at(key_at(0, 0, 5)), Truth::kHidden);
    EXPECT_EQ(truth.at(key_at(-1, 5, 5)), Truth::kHidden);
    EXPECT_EQ(truth.holds_surface(key_at(0, 5, 5)), wall == 0.15F);
    EXPECT_EQ(observable_voxels(truth).size(), truth.observable_voxels());
  }
}

// As a mesh file gives it: the bounds end with the walls.
TEST(GroundTruth, WallsOnTheOuterFacesOfTheBoundsAreObservable) {
  for (const float shift : {0.0F, -0.0009F, 0.0009F}) {
    World world = world_of({{Eigen::Vector3f::Constant(shift), Eigen::Vector3f::Constant(2.4F + shift)}}, {});
    world.bounds = bounds_of(world.mesh);
    const GroundTruth truth(world, 0.3, {1.2, 1.2, 1.2});
    EXPECT_EQ(truth.bounds(), (KeyBox{key_at(-1, -1, -1), key_at(8, 8, 8)})) << shift;
    EXPECT_EQ(truth.free_voxels(), 512U);
    EXPECT_EQ(truth.surface_voxels(), 384U);
    EXPECT_EQ(truth.at(key_at(-1, 5, 5)), Truth::kSurface);
    EXPECT_EQ(truth.at(key_at(5, 5, 8)), Truth::kSurface);
  }
  World room = world_of({{Eigen::Vector3f::Zero(), Eigen::Vector3f::Constant(2.4F)}}, {});
  room.bounds = bounds_of(room.mesh);
  frontlux::test::expect_complaint([&] { GroundTruth(room, 0.3, {2.5, 1.2, 1.2}); }, {"outside"});
  room.mesh.triangles.back()[1] = 1'000'000'000;
  frontlux::test::expect_complaint(
      [&] {
        GroundTruth(room, 0.3, {1.2, 1.2, 1.2});
      },
      {"names vertex 1000000000"});
  World solid = world_of({{Eigen::Vector3f::Zero(), Eigen::Vector3f::Constant(2.4F)},
                          {Eigen::Vector3f::Constant(0.35F), Eigen::Vector3f::Constant(2.05F)}},
                         {});
  solid.bounds = bounds_of(solid.mesh);
  const GroundTruth within(solid, 0.3, {1.2, 1.2, 1.2});
  EXPECT_EQ(within.bounds(), (KeyBox{key_at(0, 0, 0), key_at(7, 7, 7)})) << "outsides that nobody sees";
  EXPECT_EQ(within.free_voxels(), 64U);
  EXPECT_EQ(within.at(key_at(1, 3, 3)), Truth::kSurface);
  EXPECT_EQ(within.at(key_at(2, 3, 3)), Truth::kFree);
  World part = world_of({{Eigen::Vector3f::Zero(), Eigen::Vector3f::Constant(2.4F)}}, {});
  part.bounds = {Eigen::Vector3d(0, 0.3, 0.3), Eigen::Vector3d(2.4, 2.1, 2.1)};
  EXPECT_EQ(GroundTruth(part, 0.3, {1.2, 1.2, 1.2}).bounds(), (KeyBox{key_at(0, 1, 1), key_at(7, 6, 6)}))
      << "a box that somebody chose stays as it is";
}

// A house whose door leads to where its mesh ends.
TEST(GroundTruth, NobodySeesOutOfTheWorld) {
  const auto house = [](float low, float high) {
    const auto box = [](float x0, float y0, float z0, float x1, float y1, float z1) {
      return Eigen::AlignedBox3f(Eigen::Vector3f(x0, y0, z0), Eigen::Vector3f(x1, y1, z1));
    };
    World world =
        world_of({box(low, low, low, high, high, 0.35F), box(low, low, 2.65F, high, high, 3 - low),
                  box(low, low, low, 0.35F, high, 3 - low), box(low, low, low, high, 0.35F, 3 - low),
                  box(low, 5.65F, low, high, high, 3 - low), box(5.65F, low, low, high, 2.4F, 3 - low),
                  box(5.65F, 3.6F, low, high, high, 3 - low)},
                 {});
    world.bounds = bounds_of(world.mesh);
    return world;
  };
  const Eigen::Vector3d start(3.05, 3.05, 1.55);
  // Its outer faces are on those of voxels, or within them.
  const World on_faces = house(0, 6), off_faces = house(0.02F, 5.98F);
  const GroundTruth truth(on_faces, 0.3, start), expected(off_faces, 0.3, start);
  EXPECT_EQ(truth.at(key_at(19, 9, 5)), Truth::kFree) << "the door";
  EXPECT_EQ(observable_voxels(truth), observable_voxels(expected));
  EXPECT_EQ(truth.bounds(), expected.bounds());
}

TEST(GroundTruth, SealedRoomsAreNotObservable) {
  const Eigen::AlignedBox3f room(Eigen::Vector3f(0.1F, 0.1F, 0.1F), Eigen::Vector3f(8.9F, 5.9F, 2.9F));
  const Eigen::AlignedBox3f vault(Eigen::Vector3f(5.0F, 1.0F, 0.4F), Eigen::Vector3f(7.9F, 4.0F, 2.6F));
  const World world = world_of({room, vault}, {Eigen::Vector3d::Zero(), Eigen::Vector3d(9, 6, 3)});
  const GroundTruth outside(world, 0.1, {1, 1, 1}), inside(world, 0.1, {6, 2, 1});
  const Lattice lattice(0.1);
  EXPECT_FALSE(outside.contains(*lattice.key(Eigen::Vector3f(6, 2, 1))));
  EXPECT_FALSE(inside.contains(*lattice.key(Eigen::Vector3f(1, 1, 1))));
  for (const auto& [key, state] : observable_voxels(outside))
    ASSERT_FALSE(state == Truth::kFree && inside.at(key) == Truth::kFree);
  EXPECT_GT(inside.free_voxels(), 10'000U);
}

// A slanting sheet, one triangle pair thin, across a room: free space ends at its plane.
TEST(GroundTruth, ThinSlantingWallsHold) {
  Random random(2);
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero(), Eigen::Vector3d(6, 6, 3));
  for (int round = 0; round < 30; ++round) {
    const Eigen::Vector3d normal = random.point(-1, 1).normalized();
    const Eigen::Vector3d middle(random.uniform(2, 4), random.uniform(2, 4), random.uniform(1, 2));
    const Eigen::Vector3d u = normal.unitOrthogonal() * 20, v = normal.cross(u);
    World world{"sheet", {}, bounds, std::nullopt};
    test::add_quad(world.mesh, (middle - u - v).cast<float>(), (middle + u - v).cast<float>(),
                   (middle + u + v).cast<float>(), (middle - u + v).cast<float>());
    const Eigen::Vector3d start = middle - normal * 0.7;
    const GroundTruth truth(world, 0.1, start);
    std::uint64_t before_plane = 0;
    for_each_key(truth.bounds(), [&](const VoxelKey& key) {
      const double side = normal.dot(truth.lattice().exact_center(key) - middle);
      // The farthest corner is half a diagonal away: a voxel further off than that is not cut.
      if (side < -0.087) {
        ++before_plane;
        ASSERT_EQ(truth.at(key), Truth::kFree) << round;
      }
      if (side > 0.0) {
        ASSERT_NE(truth.at(key), Truth::kFree) << round;
      }
      if (side > 0.15) {
        ASSERT_EQ(truth.at(key), Truth::kHidden) << round;
      }
    });
    EXPECT_GT(before_plane, 1'000U);
  }
}

// In a soup of triangles, the segment between the centres of free neighbours meets nothing, or a wall on the
// face between them.
TEST(GroundTruth, FreeNeighboursSeeEachOther) {
  Random random(3);
  const auto point = [&](double low, double high) -> Eigen::Vector3f {
    return random.point(low, high).cast<float>();
  };
  World world{"soup", {}, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(6)}, std::nullopt};
  for (std::uint32_t i = 0; i < 400; ++i) {
    const Eigen::Vector3f middle = point(0, 6);
    for (int corner = 0; corner < 3; ++corner) world.mesh.vertices.push_back(middle + point(-1, 1));
    world.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Surface surface(world.mesh);
  std::optional<GroundTruth> truth;
  for (int x = 0; x < 30 && (!truth || truth->free_voxels() < 3'000); ++x) {
    const Eigen::Vector3d start(0.2 * x + 0.1, 3.1, 3.1);
    frontlux::test::complaint_of([&] { truth.emplace(world, 0.2, start); });
  }
  ASSERT_TRUE(truth);
  ASSERT_GT(truth->free_voxels(), 3'000U);
  std::vector<Surface::Ray> segments;
  for (const auto& [key, state] : observable_voxels(*truth)) {
    if (state != Truth::kFree) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (truth->at(*offset_key(key, axis == 0, axis == 1, axis == 2)) != Truth::kFree) continue;
      segments.push_back({truth->lattice().center(key), Eigen::Vector3f::Unit(axis), 0.2});
    }
  }
  std::vector<Surface::Hit> hits(segments.size());
  surface.cast(segments, hits);
  ASSERT_GT(hits.size(), 5'000U);
  // Both may be free and yet have a wall on the face between them, reached from two sides.
  std::size_t walls = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].triangle == Surface::kNone) continue;
    ASSERT_NEAR(hits[i].range, 0.1, 0.0011) << i;
    ++walls;
  }
  EXPECT_LT(walls, hits.size() / 50);
}

TEST(GroundTruth, SameOnAnyNumberOfThreads) {
  Random random(4);
  const World world = world_of(random_boxes(random, 40, 60),
                               {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(60 * kEdge)});
  const auto states = [&](int threads) {
    return tbb::task_arena(threads).execute([&] {
      std::vector<std::pair<VoxelKey, Truth>> found;
      for (int i = 0; i < 60 && found.empty(); ++i)
        frontlux::test::complaint_of([&] {
          found = observable_voxels({world, kEdge, Eigen::Vector3d::Constant((i + 0.5) * kEdge)});
        });
      return found;
    });
  };
  const auto one = states(1);
  EXPECT_GT(one.size(), 1'000U);
  EXPECT_EQ(one, states(2));
}

TEST(GroundTruth, RefusesWhatMakesNoSense) {
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero(), Eigen::Vector3d(9, 6, 3));
  const World world = world_of({{Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(2, 2, 2)}}, bounds);
  const auto refuses = [](const World& in, double resolution, const Eigen::Vector3d& start,
                          const std::string& part) {
    frontlux::test::expect_complaint([&] { GroundTruth(in, resolution, start); }, {part});
  };
  const Eigen::Vector3d start(0.5, 0.5, 0.5);
  EXPECT_NO_THROW(GroundTruth(world, 0.3, start));
  refuses(world, 0.3, {1.01, 1.5, 1.5}, "the start (1.01, 1.5, 1.5) m lies in a wall: triangle ");
  refuses(world, 0.3, {9.5, 1.5, 1.5}, "outside of the world's bounds");
  refuses(world, 0.3, {std::nan(""), 1.5, 1.5}, "outside");
  refuses(world, 0.001, start, "162000000000 voxels");
  refuses(world, 1e-5, start, "larger voxels");
  refuses(world, 0.0, start, "");
  World empty = world, endless = world, broken = world;
  empty.bounds.setEmpty();
  refuses(empty, 0.3, start, "no volume");
  endless.bounds.max().y() = std::numeric_limits<double>::infinity();
  refuses(endless, 0.3, start, "");
  broken.mesh.vertices[2].x() = std::nanf("");
  refuses(broken, 0.3, start, "vertex 2");
}

TEST(VoxelsWithin, FacesBelongToTheInside) {
  const Lattice lattice(0.3);
  const auto at = [](int k) { return key_at(k, k, k); };
  const Eigen::Vector3d more = Eigen::Vector3d::Constant(0.01);
  for (int low = -40; low < 40; ++low)
    for (int high = low + 1; high < low + 20; ++high) {
      const Eigen::Vector3d min = Eigen::Vector3d::Constant(0.3 * low),
                            max = Eigen::Vector3d::Constant(0.3 * high);
      const KeyBox exact = voxels_within({min, max}, lattice);
      EXPECT_EQ(exact, (KeyBox{at(low), at(high - 1)}));
      EXPECT_EQ(size_of(exact), static_cast<std::uint64_t>((high - low) * (high - low) * (high - low)));
      EXPECT_EQ(voxels_within({min - more, max + more}, lattice), (KeyBox{at(low - 1), at(high)}));
    }
}

}  // namespace
}  // namespace frontlux::sim
