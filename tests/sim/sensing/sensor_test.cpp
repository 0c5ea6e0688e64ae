// Scans of a box in closed form; errors by their statistics; the same bytes from the same arguments.

#include "sim/mesh/box_mesh.hpp"

#include <frontlux/sim/sensor.hpp>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

namespace frontlux::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const Eigen::AlignedBox3f kRoom(Eigen::Vector3f(-3.1F, -4.7F, -0.05F), Eigen::Vector3f(5.3F, 2.9F, 2.6F));

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

std::vector<planner::Pose> poses() {
  return {{{0.3, -0.2, 0.75}, 0.0},
          {{0.3, -0.2, 1.35}, 1.0},
          {{-2.6, 2.4, 0.4}, -0.7},
          {{4.9, -4.3, 2.2}, 2.5},
          {{1.05, 0.45, 1.2}, std::numbers::pi / 2},
          {{-1.0, -1.0, 1.0}, 17.3}};
}

// Compares, where the range in closed form is `expected(i)`; at max_range itself either answer is right.
template <class Expected>
void expect_ranges(const planner::Scan& scan, std::size_t count, const Expected& expected) {
  ASSERT_EQ(scan.ranges.size(), count);
  EXPECT_NO_THROW(check(scan));
  std::size_t near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double range = expected(i);
    if (range < scan.max_range - 1e-4) {
      ASSERT_NEAR(static_cast<double>(scan.ranges[i]), range, 1e-4) << i;
      ++near;
    } else if (range > scan.max_range + 1e-4) {
      ASSERT_EQ(scan.ranges[i], std::numeric_limits<float>::infinity()) << i;
    }
  }
  EXPECT_GT(near, count / 4);
}

TEST(Sensor, LidarInABoxRoom) {
  const Surface surface(test::box_mesh(kRoom, 5));
  for (const auto& pose : poses()) {
    expect_ranges(sense(surface, lidar(), pose, 1), 23'040, [&](std::size_t i) {
      const double elevation = (20.0 - 40.0 * static_cast<double>(i / 720) / 31.0) * kDegree;
      return expected_range(pose, 0.5 * static_cast<double>(i % 720) * kDegree, elevation);
    });
  }
}

TEST(Sensor, CameraInABoxRoom) {
  const Surface surface(test::box_mesh(kRoom, 5));
  for (const auto& pose : poses()) {
    expect_ranges(sense(surface, depth_camera(), pose, 1), 19'200, [&](std::size_t i) {
      // Pixel centres on an image plane at 80 pixels from the eye, which makes 160 columns 90 degrees wide; a
      // row is as high as 36 degrees upwards and 60 rows say.
      const double left = 79.5 - static_cast<double>(i % 160);
      const double up = (59.5 - static_cast<double>(i / 160)) * 80.0 * std::tan(36 * kDegree) / 60.0;
      return expected_range(pose, std::atan2(left, 80.0), std::atan2(up, std::hypot(left, 80.0)));
    });
  }
}

TEST(Sensor, ConeInABoxRoom) {
  const Surface surface(test::box_mesh(kRoom, 5));
  const Sensor sonar = cone(30 * kDegree, 7.0, 501);
  for (const auto& pose : poses()) {
    expect_ranges(sense(surface, sonar, pose, 1), 501, [&](std::size_t i) {
      const Eigen::Vector3d d = sonar.directions()[i];
      return expected_range(pose, std::atan2(d.y(), d.x()), std::asin(d.z()));
    });
  }
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
  const Surface surface(test::box_mesh(kRoom));
  const planner::Pose pose{{0.3, -0.2, 1.2}, 0.4};
  constexpr double kSigma = 0.03;
  const auto exact = sense(surface, depth_camera(), pose, 7);
  double sum = 0, squares = 0, count = 0, products = 0, previous = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto noisy = sense(surface, depth_camera({kSigma, 0.0}), pose, seed);
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
  const Surface surface(test::box_mesh(kRoom));
  const planner::Pose pose{{0.3, -0.2, 1.2}, 0.4};
  const auto exact = sense(surface, lidar(), pose, 7);
  const auto noisy = sense(surface, lidar({0.1, 0.0}), pose, 8);
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

TEST(Sensor, NoisyRangesStayWithinZeroAndMaxRange) {
  const Surface surface(test::box_mesh(kRoom));
  const auto scan = sense(surface, lidar({50.0, 0.0}), {{0.3, -0.2, 1.2}, 0.4}, 3);
  const auto exact = sense(surface, lidar(), {{0.3, -0.2, 1.2}, 0.4}, 3);
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
  const Surface surface(test::box_mesh(kRoom));
  const planner::Pose pose{{0.3, -0.2, 1.2}, 0.4};
  const auto exact = sense(surface, lidar(), pose, 1);
  for (const double dropout : {0.01, 0.3, 0.95}) {
    const auto scan = sense(surface, lidar({0.0, dropout}), pose, 1);
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
  for (const float range : sense(surface, lidar({0.0, 1.0}), pose, 1).ranges) ASSERT_TRUE(std::isnan(range));
}

bool same_bytes(const planner::Scan& a, const planner::Scan& b) {
  return a.origin == b.origin && a.directions == b.directions && a.ranges.size() == b.ranges.size() &&
         std::memcmp(a.ranges.data(), b.ranges.data(), a.ranges.size() * sizeof(float)) == 0;
}

TEST(Sensor, SameSeedSameBytesOnAnyNumberOfThreads) {
  const Surface surface(test::box_mesh(kRoom, 9));
  const Sensor sensor = depth_camera({0.02, 0.1});
  const planner::Pose pose{{0.3, -0.2, 1.2}, 0.4};
  const auto scan_on = [&](int threads, std::uint64_t seed) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return sense(surface, sensor, pose, seed); });
  };
  const auto one = scan_on(1, 42);
  EXPECT_TRUE(same_bytes(one, scan_on(2, 42)));
  EXPECT_TRUE(same_bytes(one, scan_on(1, 42)));
  EXPECT_FALSE(same_bytes(one, scan_on(1, 43)));
}

TEST(Sensor, RefusesWhatMakesNoSense) {
  const FieldOfView view{FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 6.0};
  EXPECT_NO_THROW(Sensor(view, 1, 1));
  EXPECT_THROW(Sensor(view, 0, 1), std::invalid_argument);
  EXPECT_THROW(Sensor(view, 1, 0), std::invalid_argument);
  EXPECT_THROW(Sensor(view, std::size_t{1} << 40, std::size_t{1} << 40), std::invalid_argument);
  EXPECT_THROW(Sensor(view, 1, 1, {-0.1, 0.0}), std::invalid_argument);
  EXPECT_THROW(Sensor(view, 1, 1, {std::nan(""), 0.0}), std::invalid_argument);
  EXPECT_THROW(Sensor(view, 1, 1, {0.0, 1.1}), std::invalid_argument);
  EXPECT_THROW(cone(4.0, 1.0, 10), std::invalid_argument);
  const Surface surface(test::box_mesh(kRoom));
  EXPECT_THROW(sense(surface, lidar(), {{std::nan(""), 0, 0}, 0}, 0), std::invalid_argument);
  EXPECT_THROW(sense(surface, lidar(), {{1e300, 0, 0}, 0}, 0), std::invalid_argument);
  EXPECT_THROW(sense(surface, lidar(), {{0, 0, 0}, std::numeric_limits<double>::infinity()}, 0),
               std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::sim
