// Membership against the definitions, written with angles instead of slopes.

#include <frontlux/field_of_view.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace frontlux {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

FieldOfView lidar() { return {FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 6.0}; }
FieldOfView camera() { return {FieldOfView::Shape::kPyramid, 90 * kDegree, 72 * kDegree, 10.0}; }
FieldOfView sonar() { return {FieldOfView::Shape::kCone, 30 * kDegree, 0.0, 4.0}; }

TEST(FieldOfView, AgreesWithAngles) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(-8, 8), angle(-10, 10);
  std::size_t inside = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Eigen::Vector3d offset(coordinate(random), coordinate(random), coordinate(random));
    const double yaw = angle(random), range = offset.norm();
    const double elevation = std::atan2(offset.z(), std::hypot(offset.x(), offset.y()));
    const double azimuth = std::remainder(std::atan2(offset.y(), offset.x()) - yaw, 2 * std::numbers::pi);
    EXPECT_EQ(lidar().contains(offset, yaw), range <= 6 && std::fabs(elevation) <= 20 * kDegree);
    // A camera's upper and lower border are planes, not cones: further from its axis they lie lower.
    const bool in_camera = range <= 10 && std::fabs(azimuth) <= 45 * kDegree &&
                           std::fabs(std::tan(elevation)) <= std::tan(36 * kDegree) * std::cos(azimuth);
    EXPECT_EQ(camera().contains(offset, yaw), in_camera);
    inside += in_camera ? 1 : 0;
    const double from_axis = std::acos(std::cos(elevation) * std::cos(azimuth));
    EXPECT_EQ(sonar().contains(offset, yaw), range <= 4 && from_axis <= 15 * kDegree);
  }
  EXPECT_GT(inside, 5'000U);
}

TEST(FieldOfView, SomeYawIsTheUnionOfAllYaws) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> coordinate(-8, 8);
  for (const FieldOfView& view : {lidar(), camera(), sonar()}) {
    for (int i = 0; i < 2'000; ++i) {
      const Eigen::Vector3d offset(coordinate(random), coordinate(random), coordinate(random) / 2);
      // If any yaw shows a point, then the one that looks straight at it.
      const double towards = std::atan2(offset.y(), offset.x());
      EXPECT_EQ(view.contains_at_some_yaw(offset), view.contains(offset, towards));
    }
  }
}

TEST(FieldOfView, SensorItselfAndBrokenNumbersAreOutOfView) {
  EXPECT_FALSE(lidar().contains(Eigen::Vector3d::Zero(), 0));
  EXPECT_FALSE(camera().contains_at_some_yaw(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(camera().contains({std::nan(""), 0, 0}, 0));
  EXPECT_TRUE(camera().contains({10, 0, 0}, 0));
  EXPECT_FALSE(camera().contains({10.001, 0, 0}, 0));
}

TEST(FieldOfView, ChecksItsValues) {
  EXPECT_NO_THROW(lidar().check());
  EXPECT_NO_THROW(sonar().check());
  FieldOfView view = camera();
  view.horizontal = std::numbers::pi;
  EXPECT_THROW(view.check(), std::invalid_argument);
  view = camera();
  view.max_range = 0;
  EXPECT_THROW(view.check(), std::invalid_argument);
  view = lidar();
  view.vertical = std::nan("");
  EXPECT_THROW(view.check(), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux
