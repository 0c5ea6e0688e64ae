// Scans of a box in closed form; errors by their statistics; the same bytes from the same arguments.

#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"

#include <frontlux/sim/sensor.hpp>

#include <tbb/task_arena.h>

namespace frontlux::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const Eigen::AlignedBox3f kRoom(Eigen::Vector3f(-3.1F, -4.7F, -0.05F), Eigen::Vector3f(5.3F, 2.9F, 2.6F));

const planner::Pose kPose{{0.3, -0.2, 1.2}, 0.4};

Surface room(int pieces = 1) { return Surface(test::box_mesh(kRoom, pieces)); }
Sensor lidar(RangeErrors errors = {}) { return sensor_of(planner::ugv_description(), errors); }
Sensor depth_camera(RangeErrors errors = {}) { return sensor_of(planner::uav_description(), errors); }
Sensor cone(double opening, double max_range, std::size_t rays) {
  return {{FieldOfView::Shape::kCone, opening, 0.0, max_range}, rays, 1};
}

// Range from a pose inside kRoom along a direction given by angles in the sensor's frame, from scratch.
double expected_range(const planner::Pose& pose, double azimuth, double elevation) {
  const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth + pose.yaw),
                                  std::cos(elevation) * std::sin(azimuth + pose.yaw), std::sin(elevation));
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = kRoom.min()[axis], high = kRoom.max()[axis];
    const double plane = direction[axis] > 0 ? high : low;
    if (std::fabs(direction[axis]) > 1e-12)
      nearest = std::min(nearest, (plane - pose.position[axis]) / direction[axis]);
  }
  return nearest;
}

// From several poses in the room, of rays whose azimuth and elevation in the sensor's frame `angles(i)`
// tells; at max_range itself either answer is right.
template <class Angles>
void expect_ranges(const Sensor& sensor, std::size_t count, const Angles& angles) {
  const Surface surface = room(5);
  for (const planner::Pose& pose : {planner::Pose{{0.3, -0.2, 0.75}, 0.0},
                                    {{0.3, -0.2, 1.35}, 1.0},
                                    {{-2.6, 2.4, 0.4}, -0.7},
                                    {{4.9, -4.3, 2.2}, 2.5},
                                    {{1.05, 0.45, 1.2}, std::numbers::pi / 2},
                                    {{-1.0, -1.0, 1.0}, 17.3}}) {
    const planner::Scan scan = sense(surface, sensor, pose, 1);
    ASSERT_EQ(scan.ranges.size(), count);
    EXPECT_NO_THROW(check(scan));
    std::size_t near = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [azimuth, elevation] = angles(i);
      const double range = expected_range(pose, azimuth, elevation);
      if (range < scan.max_range - 1e-4) {
        ASSERT_NEAR(static_cast<double>(scan.ranges[i]), range, 1e-4) << i;
        ++near;
      } else if (range > scan.max_range + 1e-4) {
        ASSERT_EQ(scan.ranges[i], std::numeric_limits<float>::infinity()) << i;
      }
    }
    EXPECT_GT(near, count / 4);
  }
}

TEST(Sensor, LidarInABoxRoom) {
  expect_ranges(lidar(), 23'040, [](std::size_t i) {
    const double elevation = (20.0 - 40.0 * static_cast<double>(i / 720) / 31.0) * kDegree;
    return std::pair(0.5 * static_cast<double>(i % 720) * kDegree, elevation);
  });
}

TEST(Sensor, CameraInABoxRoom) {
  expect_ranges(depth_camera(), 19'200, [](std::size_t i) {
    // Pixel centres on an image plane at 80 pixels from the eye, which makes 160 columns 90 degrees wide; a
    // row is as high as 36 degrees upwards and 60 rows say.
    const double left = 79.5 - static_cast<double>(i % 160);
    const double up = (59.5 - static_cast<double>(i / 160)) * 80.0 * std::tan(36 * kDegree) / 60.0;
    return std::pair(std::atan2(left, 80.0), std::atan2(up, std::hypot(left, 80.0)));
  });
}

TEST(Sensor, ConeInABoxRoom) {
  const Sensor sonar = cone(30 * kDegree, 7.0, 501);
  expect_ranges(sonar, 501, [&](std::size_t i) {
    const Eigen::Vector3d d = sonar.directions()[i];
    return std::pair(std::atan2(d.y(), d.x()), std::asin(d.z()));
  });
}

TEST(Sensor, RaysFillTheFieldOfViewAndStayInIt) {
  for (const Sensor& sensor : {lidar(), depth_camera(), cone(50 * kDegree, 4.0, 1000)}) {
    FieldOfView view = sensor.field_of_view();
    view.vertical += 1e-9;  // the lidar's extremes lie on the border
    for (const Eigen::Vector3d& direction : sensor.directions()) {
      ASSERT_NEAR(direction.norm(), 1.0, 1e-12);
      ASSERT_TRUE(view.contains(direction * 0.9 * view.max_range, 0.0)) << direction.transpose();
    }
  }
  double highest = -1, lowest = 1;
  const Sensor spinning = lidar();
  for (const Eigen::Vector3d& direction : spinning.directions()) {
    highest = std::max(highest, direction.z());
    lowest = std::min(lowest, direction.z());
  }
  EXPECT_NEAR(highest, std::sin(20 * kDegree), 1e-12);
  EXPECT_NEAR(lowest, -std::sin(20 * kDegree), 1e-12);
}

// The fraction of a cone's rays within any smaller cone or any wedge is that of its solid angle.
TEST(Sensor, ConeRaysAreSpreadEvenly) {
  constexpr std::size_t kRays = 10'000;
  const Sensor sonar = cone(60 * kDegree, 4.0, kRays);
  for (const double part : {5.0, 10.0, 20.0, 28.0}) {
    const auto inside = std::ranges::count_if(
        sonar.directions(), [&](const auto& d) { return d.x() >= std::cos(part * kDegree); });
    const double fraction = (1 - std::cos(part * kDegree)) / (1 - std::cos(30 * kDegree));
    EXPECT_NEAR(static_cast<double>(inside) / kRays, fraction, 2.0 / kRays) << part;
  }
  std::vector<int> wedges(12);
  for (const auto& d : sonar.directions()) {
    const double turn = std::atan2(d.z(), d.y()) / (2 * std::numbers::pi) + 0.5;
    ++wedges[std::min<std::size_t>(11, static_cast<std::size_t>(turn * 12))];
  }
  for (const int count : wedges) EXPECT_NEAR(count, kRays / 12.0, 15.0);
}

TEST(Sensor, NoiseHasTheAskedMeanAndDeviation) {
  const Surface surface = room();
  constexpr double kSigma = 0.03;
  const auto exact = sense(surface, depth_camera(), kPose, 7);
  double sum = 0, squares = 0, count = 0, products = 0, previous = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto noisy = sense(surface, depth_camera({kSigma, 0.0}), kPose, seed);
    EXPECT_NO_THROW(check(noisy));
    for (std::size_t i = 0; i < exact.ranges.size(); ++i) {
      ASSERT_LT(exact.ranges[i], 9.5F);  // so that nothing is clamped
      const double error = static_cast<double>(noisy.ranges[i]) - static_cast<double>(exact.ranges[i]);
      sum += error;
      squares += error * error;
      products += error * previous;
      previous = error;
      ++count;
    }
  }
  const double variance = squares / count - sum / count * sum / count;
  EXPECT_NEAR(sum / count, 0.0, 5 * kSigma / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(variance), kSigma, 5 * kSigma / std::sqrt(2 * count));
  EXPECT_NEAR(products / count / variance, 0.0, 5 / std::sqrt(count));  // neighbours are independent
}

TEST(Sensor, NoiseIsNormal) {
  const Surface surface = room();
  const auto exact = sense(surface, lidar(), kPose, 7), noisy = sense(surface, lidar({0.1, 0.0}), kPose, 8);
  for (const double z : {-2.0, -1.0, 0.0, 0.5, 1.5}) {
    double below = 0, count = 0;
    for (std::size_t i = 0; i < exact.ranges.size(); ++i) {
      if (!(exact.ranges[i] < 5.0F && exact.ranges[i] > 1.0F)) continue;
      ++count;
      if (static_cast<double>(noisy.ranges[i]) - static_cast<double>(exact.ranges[i]) < 0.1 * z) ++below;
    }
    ASSERT_GT(count, 5'000);
    const double fraction = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_NEAR(below / count, fraction, 5 * std::sqrt(fraction * (1 - fraction) / count)) << z;
  }
}

// The same numbers are drawn, for a deviation that is another one at each range.
TEST(Sensor, NoiseGrowsWithTheSquareOfTheRange) {
  const Surface surface = room();
  constexpr double kSigma = 0.01, kGrowth = 0.002;
  const auto exact = sense(surface, lidar(), kPose, 7), unit = sense(surface, lidar({kSigma}), kPose, 8),
             noisy = sense(surface, lidar({.sigma = kSigma, .growth = kGrowth}), kPose, 8),
             grown = sense(surface, lidar({.growth = kGrowth}), kPose, 8);
  double nearest = 6.0, farthest = 0.0;
  for (std::size_t i = 0; i < exact.ranges.size(); ++i) {
    const auto range = static_cast<double>(exact.ranges[i]);
    if (!(range < 5.0)) continue;
    nearest = std::min(nearest, range);
    farthest = std::max(farthest, range);
    const double drawn = (static_cast<double>(unit.ranges[i]) - range) / kSigma;  // to 1e-4
    const double grows = kGrowth * range * range;
    ASSERT_NEAR(static_cast<double>(noisy.ranges[i]), range + (kSigma + grows) * drawn, 1e-5);
    ASSERT_NEAR(static_cast<double>(grown.ranges[i]), range + grows * drawn, 1e-5);
  }
  EXPECT_GT(farthest, 1.5 * nearest);
  for (const double growth : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_REFUSED(lidar({.growth = growth}));
}

TEST(Sensor, NoisyRangesStayWithinZeroAndMaxRange) {
  const Surface surface = room();
  const auto scan = sense(surface, lidar({50.0, 0.0}), kPose, 3), exact = sense(surface, lidar(), kPose, 3);
  std::size_t zeros = 0, limits = 0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    ASSERT_EQ(std::isinf(scan.ranges[i]), std::isinf(exact.ranges[i]))
        << "noise neither makes nor loses a hit";
    if (std::isinf(scan.ranges[i])) continue;
    ASSERT_TRUE(scan.ranges[i] >= 0.0F && scan.ranges[i] <= 6.0F);
    zeros += scan.ranges[i] == 0.0F ? 1 : 0;
    limits += scan.ranges[i] == 6.0F ? 1 : 0;
  }
  EXPECT_GT(zeros, 3'000U);
  EXPECT_GT(limits, 3'000U);
}

TEST(Sensor, DropoutsAreAsFrequentAsAsked) {
  const Surface surface = room();
  const auto exact = sense(surface, lidar(), kPose, 1);
  for (const double dropout : {0.01, 0.3, 0.95}) {
    const auto scan = sense(surface, lidar({0.0, dropout}), kPose, 1);
    double dropped = 0;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (std::isnan(scan.ranges[i]))
        ++dropped;
      else
        ASSERT_EQ(scan.ranges[i], exact.ranges[i]);
    }
    const auto count = static_cast<double>(scan.ranges.size());
    EXPECT_NEAR(dropped / count, dropout, 5 * std::sqrt(dropout * (1 - dropout) / count));
  }
  for (const float range : sense(surface, lidar({0.0, 1.0}), kPose, 1).ranges) ASSERT_TRUE(std::isnan(range));
}

// As many as asked, spread evenly from the sensor to the surface; the others are as without.
TEST(Sensor, StrayReturnsLieBeforeTheSurface) {
  const Surface surface = room();
  const auto exact = sense(surface, lidar(), kPose, 1);
  for (const double stray : {0.01, 0.3}) {
    const auto scan = sense(surface, lidar({.stray = stray}), kPose, 1);
    double strays = 0, halves = 0;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (scan.ranges[i] == exact.ranges[i]) continue;
      ASSERT_GT(scan.ranges[i], 0.0F);
      ASSERT_LT(scan.ranges[i], std::min(exact.ranges[i], static_cast<float>(scan.max_range)));
      ++strays;
      if (scan.ranges[i] < 0.5F * std::min(exact.ranges[i], static_cast<float>(scan.max_range))) ++halves;
    }
    const auto count = static_cast<double>(scan.ranges.size());
    EXPECT_NEAR(strays / count, stray, 5 * std::sqrt(stray * (1 - stray) / count));
    EXPECT_NEAR(halves / strays, 0.5, 2.5 / std::sqrt(strays));
  }
}

bool same_bytes(const planner::Scan& a, const planner::Scan& b) {
  return a.origin == b.origin && a.directions == b.directions && a.ranges.size() == b.ranges.size() &&
         std::memcmp(a.ranges.data(), b.ranges.data(), a.ranges.size() * sizeof(float)) == 0;
}

TEST(Sensor, SameSeedSameBytesOnAnyNumberOfThreads) {
  const Surface surface = room(9);
  const auto scan_on = [&](int threads, std::uint64_t seed) {
    return tbb::task_arena(threads).execute([&] {
      return sense(surface, depth_camera({0.02, 0.1}), kPose, seed);
    });
  };
  const auto one = scan_on(1, 42);
  EXPECT_TRUE(same_bytes(one, scan_on(2, 42)));
  EXPECT_TRUE(same_bytes(one, scan_on(1, 42)));
  EXPECT_FALSE(same_bytes(one, scan_on(1, 43)));
}

TEST(Sensor, RefusesWhatMakesNoSense) {
  const FieldOfView view{FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 6.0};
  EXPECT_NO_THROW(Sensor(view, 1, 1));
  EXPECT_REFUSED(Sensor(view, 0, 1));
  EXPECT_REFUSED(Sensor(view, 1, 0));
  EXPECT_REFUSED(Sensor(view, std::size_t{1} << 40, std::size_t{1} << 40));
  for (const RangeErrors& bad : {RangeErrors{-0.1, 0.0}, {std::nan(""), 0.0}, {0.0, 1.1}, {.stray = -0.1}})
    EXPECT_REFUSED(Sensor(view, 1, 1, bad));
  EXPECT_REFUSED(cone(4.0, 1.0, 10));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const planner::Pose& bad :
       {planner::Pose{{std::nan(""), 0, 0}, 0}, {{1e300, 0, 0}, 0}, {{0, 0, 0}, kInfinity}})
    EXPECT_REFUSED(sense(room(), lidar(), bad, 0));
}

}  // namespace
}  // namespace frontlux::sim
