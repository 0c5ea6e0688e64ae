// The table of a field of view against the field of view itself, offset by offset.

#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/views.hpp"

#include <frontlux/view_region.hpp>

#include <limits>

namespace frontlux::test {
namespace {

constexpr int kMiddle = 32768;

struct Case {
  FieldOfView view;
  double resolution;
};

// Ranges and slopes that put voxel centres exactly on the border, as far as rounding lets them, and some
// random ones.
std::vector<Case> cases() {
  using enum FieldOfView::Shape;
  std::vector<Case> cases;
  const auto add = [&](double resolution, double cells, double slope) {
    const double angle = 2 * std::atan(slope);
    cases.push_back({{kSpinning, 0.0, angle, cells * resolution}, resolution});
    cases.push_back({{kPyramid, 1.0, angle, cells * resolution}, resolution});
    cases.push_back({{kCone, angle, 0.0, cells * resolution}, resolution});
  };
  for (const double resolution : {0.3, 0.1, 0.25, 0.37})
    for (const double cells : {1.0, 5.0, 13.0, 20.0, 24.99})
      for (const double slope : {0.75, 1.0, std::tan(20 * kDegree), std::tan(36 * kDegree)})
        add(resolution, cells, slope);
  Random random(7);
  for (int i = 0; i < 20; ++i)
    add(random.uniform(0.01, 3.0), random.uniform(0.1, 20.0), random.uniform(0.01, 9.0));
  return cases;
}

TEST(ViewRegion, IsTheFieldOfViewToTheLastBorder) {
  for (const auto& [view, resolution] : cases()) {
    const ViewRegion region(view, resolution);
    const int far = static_cast<int>(view.max_range / resolution) + 3;
    int reach = 0, greatest = 0, squared_range = 0;
    double slope = 0.0;
    for (int dx = -far; dx <= far; ++dx)
      for (int dy = -far; dy <= far; ++dy) {
        int height = -1;
        for (int dz = -far; dz <= far; ++dz) {
          const bool in_view = view.contains_at_some_yaw({dx * resolution, dy * resolution, dz * resolution});
          ASSERT_EQ(region.contains(dx, dy, dz), in_view) << dx << ' ' << dy << ' ' << dz;
          if (!in_view) continue;
          height = std::max(height, dz);
          reach = std::max({reach, std::abs(dx), std::abs(dy), dz});
          squared_range = std::max(squared_range, dx * dx + dy * dy + dz * dz);
          slope = std::max(slope, dz / std::hypot(dx, dy));
        }
        greatest = std::max(greatest, height);
        ASSERT_EQ(region.height(dx, dy), height);
        ASSERT_EQ(region.heights()[region.entry(dx, dy)], height);  // in the margin, too
      }
    EXPECT_LE(reach, region.reach());
    EXPECT_GE(reach + 1, region.reach());
    EXPECT_EQ(region.greatest_height(), greatest);
    EXPECT_EQ(region.squared_range(), squared_range);
    EXPECT_EQ(region.slope(), slope);
    EXPECT_FALSE(region.contains({0, 0, 0}, {65535, 65535, 65535}));
    EXPECT_FALSE(region.contains({0, 9, 9}, {65535, 9, 9}));
    EXPECT_EQ(region.contains({9, 9, 9}, {9, 10, 9}), region.contains(0, 1, 0));
  }
}

TEST(ViewRegion, RejectsBoxesOnlyIfNothingInThemIsInView) {
  Random random(1);
  std::size_t rejected = 0, accepted = 0, points = 0;
  for (const auto& [view, resolution] : cases()) {
    const ViewRegion region(view, resolution);
    for (int i = 0; i < 300; ++i) {
      const auto box = [&](int spread) {
        const auto low = [&] { return kMiddle + random.below(2 * spread + 1) - spread; };
        const VoxelKey min = make_key(low(), low(), low());
        return KeyBox{min,
                      make_key(min.x + random.below(5), min.y + random.below(5), min.z + random.below(5))};
      };
      const KeyBox a = box(0), b = box(30);
      const bool may = region.may_contain_voxel(a, b), may_point = region.may_contain_point(a, b);
      for (int pair = 0; pair < 20; ++pair) {
        const auto pick = [&](const KeyBox& c) -> Eigen::Vector3d {
          return {random.uniform(c.min.x, c.max.x), random.uniform(c.min.y, c.max.y),
                  random.uniform(c.min.z, c.max.z)};
        };
        const Eigen::Vector3d from = pick(a), to = pick(b), whole = to.array().round() - from.array().round();
        ASSERT_TRUE(may || !view.contains_at_some_yaw(whole * resolution));
        const bool in_view = view.contains_at_some_yaw((to - from) * resolution);
        ASSERT_TRUE(may_point || !in_view);
        points += in_view ? 1 : 0;
      }
      (may ? accepted : rejected) += 1;
    }
  }
  EXPECT_GT(rejected, 1000U);
  EXPECT_GT(accepted, 1000U);
  EXPECT_GT(points, 1000U);
}

TEST(ViewRegion, RefusesVoxelsWithoutASize) {
  for (const double resolution : {-0.1, -1e-12, 0.0, std::numeric_limits<double>::quiet_NaN()})
    expect_complaint([&] { const ViewRegion region(lidar(), resolution); }, {"resolution", "positive"});
}

}  // namespace
}  // namespace frontlux::test
