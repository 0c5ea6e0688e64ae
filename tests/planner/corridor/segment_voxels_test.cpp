#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/segment_voxels.hpp>

namespace frontlux::planner {
namespace {

using Keys = std::set<VoxelKey>;

Keys entered(const Lattice& lattice, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
             const Eigen::Vector3d& reach = Eigen::Vector3d::Zero()) {
  Keys keys;
  EXPECT_TRUE(SegmentVoxels(lattice, from, to, reach).all_of([&](const VoxelKey& key) {
    EXPECT_TRUE(keys.insert(key).second) << "a voxel twice";
    return true;
  }));
  return keys;
}

constexpr std::int64_t kUnit = 8;  // parts of a voxel in which the exact oracle counts

// Exact: the closed voxels that the closed segment touches, among those between its ends. Fractions with a
// common denominator are compared as integers.
Keys touched(const std::array<std::int64_t, 3>& from, const std::array<std::int64_t, 3>& to) {
  const auto cell = [](std::int64_t at) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(at) / static_cast<double>(kUnit)));
  };
  std::array<std::int64_t, 3> low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(cell(from[a]), cell(to[a]));
    high[a] = std::max(cell(from[a]), cell(to[a]));
  }
  Keys keys;
  for (std::int64_t x = low[0]; x <= high[0]; ++x)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        const std::array<std::int64_t, 3> k = {x, y, z};
        std::pair<std::int64_t, std::int64_t> begin{0, 1}, end{1, 1};  // numerator, positive denominator
        bool meets = true;
        for (std::size_t a = 0; a < 3 && meets; ++a) {
          const std::int64_t length = to[a] - from[a];
          std::int64_t first = k[a] * kUnit - from[a], last = (k[a] + 1) * kUnit - from[a];
          if (length == 0) continue;  // the range is one voxel
          if (length < 0) {
            first = -first;
            last = -last;
            std::swap(first, last);
          }
          const std::int64_t size = std::abs(length);
          if (first * begin.second > begin.first * size) begin = {first, size};
          if (last * end.second < end.first * size) end = {last, size};
        }
        meets = begin.first * end.second <= end.first * begin.second;
        if (meets) keys.insert(test::key_at(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)));
      }
  return keys;
}

TEST(SegmentVoxels, EntersTheVoxelsThatExactFractionsTell) {
  test::Random random(11);
  const Lattice lattice(1.0);
  std::size_t through_edges = 0;
  for (int i = 0; i < 20'000; ++i) {
    const int reach = random.one_in(2) ? 24 : 90;
    // Whole voxels every other time: such segments run through edges and corners.
    const std::int64_t step = random.one_in(2) ? kUnit : 1;
    std::array<std::int64_t, 3> from{}, to{};
    Eigen::Vector3d a, b;
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = (random.below(2 * reach) - reach) / step * step;
      to[k] = random.one_in(5) ? from[k] : (random.below(2 * reach) - reach) / step * step;
      a[static_cast<Eigen::Index>(k)] = static_cast<double>(from[k]) / static_cast<double>(kUnit);
      b[static_cast<Eigen::Index>(k)] = static_cast<double>(to[k]) / static_cast<double>(kUnit);
    }
    const Keys expected = touched(from, to);
    ASSERT_EQ(entered(lattice, a, b), expected)
        << "from " << a.transpose() << " to " << b.transpose() << ", seed 11, case " << i;
    const Keys back = entered(lattice, b, a);
    ASSERT_EQ(back, expected);
    std::size_t by_faces = 1;  // voxels, if it went through one face after the other
    for (int k = 0; k < 3; ++k)
      by_faces += static_cast<std::size_t>(std::abs(std::floor(b[k]) - std::floor(a[k])));
    through_edges += static_cast<std::size_t>(expected.size() > by_faces);
  }
  EXPECT_GT(through_edges, 500U);  // else the sample would not test what it is made for
}

TEST(SegmentVoxels, MissesNoVoxelOfAnyPointOnIt) {
  test::Random random(12);
  for (const double resolution : {0.05, 0.1, 0.3, 1.7}) {
    const Lattice lattice(resolution);
    for (int i = 0; i < 1'000; ++i) {
      const double far = random.one_in(4) ? 30'000.0 * resolution : 10.0 * resolution;
      Eigen::Vector3d from, way;
      for (int a = 0; a < 3; ++a) {
        from[a] = random.uniform(-far, far);
        if (random.one_in(4)) from[a] = std::round(from[a] / resolution) * resolution;
        way[a] = random.one_in(6) ? 0.0 : random.uniform(-1.0, 1.0) * random.uniform(0.0, 20.0) * resolution;
        if (random.one_in(20)) way[a] = 1e-13;
      }
      const Eigen::Vector3d to = from + way;
      const Keys keys = entered(lattice, from, to);
      for (int k = 0; k <= 400; ++k) {
        const Eigen::Vector3d at =
            (from + (to - from) * (k / 400.0)).cwiseMax(from.cwiseMin(to)).cwiseMin(from.cwiseMax(to));
        ASSERT_TRUE(keys.contains(lattice.key(at).value()))
            << "resolution " << resolution << ", from " << from.transpose() << " to " << to.transpose()
            << " at " << at.transpose();
      }
    }
  }
}

TEST(SegmentVoxels, OfABoxAreExactlyThoseOfItsCorners) {
  test::Random random(6);
  const Lattice lattice(1.0);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d from, to, reach;
    for (int a = 0; a < 3; ++a) {
      from[a] = random.uniform(-5.0, 5.0);
      to[a] = random.one_in(4) ? from[a] : random.uniform(-5.0, 5.0);
      reach[a] = random.one_in(4) ? 0.0 : random.uniform(0.0, 0.49);
    }
    Keys sampled;
    const Keys entered_by_box = entered(lattice, from, to, reach);
    for (int k = 0; k <= 20'000; ++k)
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d side((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                   (corner & 4) != 0 ? 1 : -1);
        const Eigen::Vector3d at = from + (to - from) * (k / 20'000.0) + side.cwiseProduct(reach);
        sampled.insert(lattice.key(at).value());
      }
    for (const VoxelKey& one : sampled) ASSERT_TRUE(entered_by_box.contains(one)) << "case " << i;
    // Samples may skip a voxel whose corner is cut by less than their distance; few are.
    ASSERT_LE(entered_by_box.size(), sampled.size() + 1) << "case " << i;
  }
}

TEST(SegmentVoxels, StaysOnOneSideOfAFaceInWhichItLies) {
  const Lattice lattice(0.25);
  using test::key_at;
  EXPECT_EQ(entered(lattice, {0.1, 0.1, 1.0}, {0.6, 0.1, 1.0}),
            (Keys{key_at(0, 0, 4), key_at(1, 0, 4), key_at(2, 0, 4)}));
  // Upwards from a face nothing below it is asked for, downwards both sides are.
  EXPECT_EQ(entered(lattice, {0.1, 0.1, 1.0}, {0.1, 0.1, 1.3}), (Keys{key_at(0, 0, 4), key_at(0, 0, 5)}));
  EXPECT_EQ(entered(lattice, {0.1, 0.1, 1.0}, {0.1, 0.1, 0.9}), (Keys{key_at(0, 0, 3), key_at(0, 0, 4)}));
  // Through an edge: all four around it.
  EXPECT_EQ(entered(lattice, {0.2, 0.2, 0.1}, {0.3, 0.3, 0.1}).size(), 4U);
  EXPECT_EQ(entered(lattice, {0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}).size(), 8U);
}

TEST(SegmentVoxels, HoldsNowhereOutsideTheKeyRange) {
  const Lattice lattice(0.1);
  const auto any = [](const VoxelKey&) { return true; };
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 3276.8, -3276.9, 1e300}) {
    EXPECT_FALSE(SegmentVoxels(lattice, {bad, 0, 0}, {0, 0, 0}).all_of(any)) << bad;
    EXPECT_FALSE(SegmentVoxels(lattice, {0, 0, 0}, {0, 0, bad}).all_of(any)) << bad;
  }
  EXPECT_TRUE(SegmentVoxels(lattice, {-3276.8, 0, 0}, {3276.75, 0, 0}).all_of(any));
}

}  // namespace
}  // namespace frontlux::planner
