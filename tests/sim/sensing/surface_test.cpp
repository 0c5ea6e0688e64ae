// Hits against planes of boxes in closed form, against triangles one by one in another formula, and rays
// aimed at the edges and corners that a closed surface must not let through.

#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"
#include "support/floating_point_control.hpp"
#include "support/random.hpp"

#include <frontlux/sim/surface.hpp>

namespace frontlux::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Surface::Hit> cast(const Surface& surface, const std::vector<Surface::Ray>& rays) {
  std::vector<Surface::Hit> hits(rays.size());
  surface.cast(rays, hits);
  return hits;
}

Eigen::Vector3f random_point(frontlux::test::Random& random, double low, double high) {
  return random.point(low, high).cast<float>();
}

// Where the line through `ray` leaves a box that it starts in: the nearest of the planes ahead.
double exit_range(const Eigen::AlignedBox3f& box, const Surface::Ray& ray) {
  double nearest = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis], plane = d > 0 ? box.max()[axis] : box.min()[axis];
    if (d != 0) nearest = std::min(nearest, (plane - ray.origin[axis]) / d);
  }
  return nearest * ray.direction.cast<double>().norm();
}

// The hit by solving origin + t d = a + u (b - a) + v (c - a), which is not how the surface does it.
std::optional<double> solved(const TriangleMesh& mesh, std::size_t triangle, const Surface::Ray& ray) {
  const auto corner = [&](int i) {
    return mesh.vertices[mesh.triangles[triangle][static_cast<std::size_t>(i)]].cast<double>();
  };
  const Eigen::Vector3d a = corner(0), d = ray.direction.cast<double>().normalized();
  Eigen::Matrix3d matrix;
  matrix << -d, corner(1) - a, corner(2) - a;
  const Eigen::Vector3d tuv = matrix.fullPivLu().solve(ray.origin.cast<double>() - a);
  if (tuv[0] < 0 || tuv[1] < 0 || tuv[2] < 0 || tuv[1] + tuv[2] > 1) return std::nullopt;
  return tuv[0];
}

TEST(Surface, RangesInABoxAreTheSlabFormula) {
  const Eigen::AlignedBox3f box(Eigen::Vector3f(-3.1F, -4.7F, -0.05F), Eigen::Vector3f(5.3F, 2.9F, 2.6F));
  frontlux::test::Random random(1);
  for (const int pieces : {1, 7}) {
    const Surface surface(test::box_mesh(box, pieces));
    std::vector<Surface::Ray> rays;
    for (int i = 0; i < 50'000; ++i) {
      Eigen::Vector3f direction = random_point(random, -1, 1);
      if (random.one_in(4)) direction[random.below(3)] *= 1e-4F;  // almost along a wall
      if (random.one_in(4)) direction[random.below(3)] = 0.0F;
      if (direction.isZero()) direction = Eigen::Vector3f::UnitZ();
      const Eigen::Vector3f fraction = random_point(random, 0.001, 0.999);
      rays.push_back({box.min() + fraction.cwiseProduct(box.sizes()), direction});
    }
    const auto hits = cast(surface, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_NEAR(hits[i].range, exit_range(box, rays[i]), 1e-9) << i << " of " << pieces;
  }
}

TEST(Surface, NearestTriangleOfASoup) {
  frontlux::test::Random random(2);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Eigen::Vector3f middle = random_point(random, -5, 5);
    for (int corner = 0; corner < 3; ++corner)
      mesh.vertices.push_back(middle + random_point(random, -1.5, 1.5));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Surface surface(mesh);
  std::vector<Surface::Ray> rays;
  for (int i = 0; i < 2'000; ++i)
    rays.push_back({random_point(random, -6, 6), random_point(random, -1, 1), random.uniform(0.5, 12)});
  const auto hits = cast(surface, rays);
  std::size_t hit_count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Surface::Hit expected;
    for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const auto range = solved(mesh, triangle, rays[i]);
      if (range && *range <= rays[i].max_range && *range < expected.range)
        expected = {*range, static_cast<std::uint32_t>(triangle)};
    }
    ASSERT_EQ(hits[i].triangle, expected.triangle) << i;
    if (expected.triangle != Surface::kNone) {
      ASSERT_NEAR(hits[i].range, expected.range, 1e-9) << i;
      ++hit_count;
    } else {
      ASSERT_EQ(hits[i].range, kInfinity) << i;
    }
  }
  EXPECT_GT(hit_count, 500U);
  EXPECT_LT(hit_count, 1'900U);
}

// A closed room of 3,072 triangles: whatever is aimed at an edge or a corner must hit.
TEST(Surface, NothingSlipsThroughEdgesAndCorners) {
  const Eigen::AlignedBox3f box(Eigen::Vector3f(-2.9F, -3.3F, -0.05F), Eigen::Vector3f(6.1F, 4.7F, 2.95F));
  const TriangleMesh mesh = test::box_mesh(box, 16);
  const Surface surface(mesh);
  frontlux::test::Random random(3);
  std::vector<Surface::Ray> rays;
  std::vector<double> aimed;
  constexpr int kRays = 1'000'000;
  for (int i = 0; i < kRays; ++i) {
    const auto& triangle = random.pick(mesh.triangles);
    const int corner = random.below(3);
    const Eigen::Vector3f a = mesh.vertices[triangle[static_cast<std::size_t>(corner)]];
    const Eigen::Vector3f b = mesh.vertices[triangle[static_cast<std::size_t>((corner + 1) % 3)]];
    const float along = random.one_in(3)   ? 0.0F
                        : random.one_in(3) ? 0.5F
                                           : static_cast<float>(random.uniform(0, 1));
    // Some origins on round numbers and on the lattice's own lines, where products come out as exact zeros.
    Eigen::Vector3f fraction = random_point(random, 0.01, 0.99);
    if (random.one_in(3)) fraction = (fraction * 16).array().round().max(1).min(15).matrix() / 16;
    const Eigen::Vector3f origin = box.min() + fraction.cwiseProduct(box.sizes());
    const Eigen::Vector3f target = a + along * (b - a);
    rays.push_back({origin, target - origin});
    aimed.push_back((target - origin).cast<double>().norm());
  }
  const auto hits = cast(surface, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_NE(hits[i].triangle, Surface::kNone)
        << "origin " << rays[i].origin.transpose() << ", direction " << rays[i].direction.transpose();
    ASSERT_NEAR(hits[i].range, aimed[i], 1e-4) << i;
  }
}

// The same for a surface without a flat side: a sphere, seen from within, whose every edge is a bend.
TEST(Surface, NothingSlipsOutOfASphere) {
  constexpr std::uint32_t kRings = 24, kSectors = 48;
  TriangleMesh mesh;
  const auto at = [](std::uint32_t ring, std::uint32_t sector) {
    return ring * kSectors + sector % kSectors;
  };
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    for (std::uint32_t sector = 0; sector < kSectors; ++sector) {
      const double polar = M_PI * ring / kRings, azimuth = 2 * M_PI * sector / kSectors;
      const double off_axis = ring == 0 || ring == kRings ? 0.0 : std::sin(polar);  // one point at each pole
      const Eigen::Vector3d on_unit_sphere(off_axis * std::cos(azimuth), off_axis * std::sin(azimuth),
                                           std::cos(polar));
      mesh.vertices.push_back(on_unit_sphere.cast<float>() * 7.3F);
      if (ring == kRings) continue;
      mesh.triangles.push_back({at(ring, sector), at(ring + 1, sector), at(ring, sector + 1)});
      mesh.triangles.push_back({at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)});
    }
  }
  const Surface surface(mesh);
  frontlux::test::Random random(4);
  std::vector<Surface::Ray> rays;
  for (int i = 0; i < 200'000; ++i) {
    const Eigen::Vector3f origin = random_point(random, -4, 4);
    rays.push_back({origin, random.pick(mesh.vertices) - origin});
  }
  const auto hits = cast(surface, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_NE(hits[i].triangle, Surface::kNone) << i;
    ASSERT_NEAR(hits[i].range, rays[i].direction.cast<double>().norm(), 1e-4) << i;
  }
}

TEST(Surface, BothSidesOfASheetStopRays) {
  TriangleMesh mesh;
  test::add_quad(mesh, {2, -1, -1}, {2, 1, -1}, {2, 1, 1}, {2, -1, 1});
  const Surface surface(mesh);
  const auto hits = cast(surface, {{{0, 0.1F, 0.2F}, {1, 0, 0}},
                                   {{5, 0.1F, 0.2F}, {-1, 0, 0}},
                                   {{0, 0.1F, 0.2F}, {-1, 0, 0}},
                                   {{0, 1.1F, 0.2F}, {1, 0, 0}}});
  EXPECT_EQ(hits[0].range, 2.0);
  EXPECT_EQ(hits[1].range, 3.0);
  EXPECT_EQ(hits[2].range, kInfinity);
  EXPECT_EQ(hits[3].range, kInfinity);
}

TEST(Surface, RaysFromFarAwayAndMeshesFarAway) {
  for (const float offset : {0.0F, 4096.0F, -1e6F}) {
    const Eigen::Vector3f corner(offset, -offset, offset);
    const Surface surface(test::box_mesh({corner, corner + Eigen::Vector3f(2, 4, 8)}, 2));
    for (const float away : {3.0F, 1024.0F, 1e6F, 1e9F}) {
      const float x = corner.x() - away;
      const auto hits = cast(surface, {{{x, corner.y() + 1, corner.z() + 1}, {1, 0, 0}},
                                       {{x, corner.y() + 5, corner.z() + 1}, {1, 0, 0}},
                                       {{x, corner.y() + 1, corner.z() + 1}, {-1, 0, 0}}});
      EXPECT_EQ(hits[0].range, static_cast<double>(corner.x()) - static_cast<double>(x));
      EXPECT_EQ(hits[1].range, kInfinity);
      EXPECT_EQ(hits[2].range, kInfinity);
    }
  }
}

TEST(Surface, RangeLimitIsInclusiveAndLengthOfTheDirectionDoesNotMatter) {
  TriangleMesh mesh;
  test::add_quad(mesh, {2, -1, -1}, {2, 1, -1}, {2, 1, 1}, {2, -1, 1});
  const Surface surface(mesh);
  for (const float length : {1.0F, 1e-30F, 3e-39F, 7.0F, 1e30F}) {
    const auto hits = cast(surface, {{{0, 0, 0}, {length, 0, 0}, 2.0},
                                     {{0, 0, 0}, {length, 0, 0}, 2.0 - 1e-12},
                                     {{2, 0, 0}, {length, 0, 0}, 0.0}});
    EXPECT_EQ(hits[0].range, 2.0) << length;
    EXPECT_EQ(hits[1].triangle, Surface::kNone) << length;
    EXPECT_EQ(hits[2].range, 0.0) << length;
  }
}

// Rays are cast in packets: whatever is beside it, a ray has the same answer.
TEST(Surface, RaysDoNotDependOnTheirNeighbours) {
  frontlux::test::Random random(8);
  TriangleMesh mesh = test::box_mesh({Eigen::Vector3f(-3, -3, 0), Eigen::Vector3f(3, 3, 3)}, 3);
  const std::size_t walls = mesh.triangles.size();
  mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + 9);  // twice
  for (std::uint32_t i = 0; i < 40; ++i) {
    const Eigen::Vector3f middle = random_point(random, -2, 2);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 3; ++corner)
      mesh.vertices.push_back(middle + random_point(random, -0.5, 0.5));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const Surface surface(mesh);
  std::vector<Surface::Ray> rays;
  for (int i = 0; i < 3'000; ++i) {
    Surface::Ray ray{random_point(random, -4, 4), random_point(random, -1, 1), random.uniform(0.0, 9.0)};
    for (float& component : ray.direction) {
      if (random.one_in(5)) component = random.one_in(2) ? 0.0F : -0.0F;
      if (random.one_in(12)) component *= 1e-18F;
    }
    if (random.one_in(6)) ray.origin *= 1e3F;  // beside the mesh, so that it misses all of it
    if (random.one_in(20)) ray.direction *= 1e-30F;
    if (ray.direction.isZero(0.0F)) ray.direction = Eigen::Vector3f::UnitY();
    if (random.one_in(8)) ray = {{3, ray.origin.y(), 1}, ray.direction, 0.0};  // on a wall
    rays.push_back(ray);
  }
  std::vector<Surface::Hit> alone;
  for (const Surface::Ray& ray : rays) alone.push_back(cast(surface, {ray})[0]);
  EXPECT_GT(std::ranges::count(alone, 0.0, &Surface::Hit::range), 100);
  EXPECT_GT(std::ranges::count(alone, Surface::kNone, &Surface::Hit::triangle), 300);
  EXPECT_GT(std::ranges::count_if(alone, [&](const Surface::Hit& hit) { return hit.triangle < walls; }), 300);
  std::vector<std::size_t> order(rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t batch = 1; batch <= 17; ++batch) {
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    for (std::size_t first = 0; first < order.size(); first += batch) {
      const std::size_t count = std::min(batch, order.size() - first);
      std::vector<Surface::Ray> some;
      for (std::size_t i = 0; i < count; ++i) some.push_back(rays[order[first + i]]);
      const auto hits = cast(surface, some);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(hits[i].triangle, alone[order[first + i]].triangle) << order[first + i];
        ASSERT_EQ(std::bit_cast<std::uint64_t>(hits[i].range),
                  std::bit_cast<std::uint64_t>(alone[order[first + i]].range));
      }
    }
  }
}

TEST(Surface, LeavesTheFloatingPointModeAlone) {
  const Surface surface(test::box_mesh({Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones()}));
  std::fesetround(FE_TOWARDZERO);
  const std::uint64_t unusual = frontlux::test::floating_point_control();
  const auto hits = cast(surface, {{{0.5F, 0.5F, 0.5F}, {1, 0, 0}}});
  const std::uint64_t after = frontlux::test::floating_point_control();
  std::fesetround(FE_TONEAREST);
  EXPECT_NE(frontlux::test::floating_point_control(), unusual);
  EXPECT_EQ(after, unusual);
  EXPECT_EQ(hits[0].range, 0.5);
}

TEST(Surface, AMeshOfNothingIsNeverHit) {
  const Surface surface{TriangleMesh{}};
  EXPECT_EQ(cast(surface, {{{0, 0, 0}, {1, 0, 0}}})[0].triangle, Surface::kNone);
}

TEST(Surface, RefusesBrokenInput) {
  TriangleMesh mesh = test::box_mesh({Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones()});
  const Surface surface(mesh);
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  for (const Surface::Ray& bad : {Surface::Ray{{nan, 0, 0}, {1, 0, 0}},
                                  {{0, 0, 0}, {1, infinity, 0}},
                                  {{0, 0, 0}, {0, 0, 0}},
                                  {{0, 0, 0}, {1, 0, 0}, -1.0}})
    EXPECT_REFUSED(cast(surface, {bad}));
  std::vector<Surface::Hit> hits(2);
  EXPECT_REFUSED(surface.cast(std::vector<Surface::Ray>(3), hits));
  for (const float bad : {nan, infinity, 1e10F}) {
    TriangleMesh broken = mesh;
    broken.vertices[5].y() = bad;
    EXPECT_THROW(Surface{broken}, std::invalid_argument) << bad;
  }
  mesh.triangles[3][1] = static_cast<std::uint32_t>(mesh.vertices.size());
  EXPECT_REFUSED(Surface{mesh});
}

}  // namespace
}  // namespace frontlux::sim
