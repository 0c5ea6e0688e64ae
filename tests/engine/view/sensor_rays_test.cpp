// The rays of sensors: how many, in which order, and through which angles. What they fill is tested by the
// simulator's sensors.

#include "support/test.hpp"

#include <frontlux/sensor_rays.hpp>

namespace frontlux::test {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(SensorDirections, OfALidarAreBeamsByAzimuths) {
  const FieldOfView view{FieldOfView::Shape::kSpinning, 0.0, 0.6, 10.0};
  const auto directions = sensor_directions(view, 8, 3);
  ASSERT_EQ(directions.size(), 24U);
  EXPECT_LT((directions[8] - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);      // row 1, column 0
  EXPECT_LT((directions[8 + 2] - Eigen::Vector3d(0.0, 1.0, 0.0)).norm(), 1e-12);  // a quarter left
  EXPECT_NEAR(std::asin(directions[3].z()), 0.3, 1e-12);                          // the top row
  EXPECT_NEAR(std::asin(directions[16 + 3].z()), -0.3, 1e-12);
  const auto level = sensor_directions(view, 4, 1);
  ASSERT_EQ(level.size(), 4U);
  EXPECT_LT((level[0] - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((level[3] - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 1e-12);
}

TEST(PinholeDirections, GoThroughTheCentresOfPixels) {
  Eigen::Matrix3d intrinsics;
  intrinsics << 525.0, 0.0, 319.5, 0.0, 520.0, 239.5, 0.0, 0.0, 1.0;
  const auto directions = pinhole_directions(intrinsics, 640, 480);
  ASSERT_EQ(directions.size(), 640U * 480U);
  for (const std::size_t pixel : {std::size_t{0}, std::size_t{640 * 17 + 5}, directions.size() - 1}) {
    const Eigen::Vector3d projected = intrinsics * directions[pixel] / directions[pixel].z();
    EXPECT_NEAR(projected.x(), static_cast<double>(pixel % 640) + 0.5, 1e-9);
    EXPECT_NEAR(projected.y(), static_cast<double>(pixel / 640) + 0.5, 1e-9);
    EXPECT_NEAR(directions[pixel].norm(), 1.0, 1e-12);
  }
  // The same camera as a field of view, whose frame has x forward, y left and z up.
  Eigen::Matrix3d symmetric;
  symmetric << 80.0, 0.0, 80.0, 0.0, 60.0, 60.0, 0.0, 0.0, 1.0;
  const FieldOfView view{FieldOfView::Shape::kPyramid, kPi / 2, kPi / 2, 5.0};
  const auto optical = pinhole_directions(symmetric, 160, 120), ahead = sensor_directions(view, 160, 120);
  for (std::size_t i = 0; i < ahead.size(); ++i)
    ASSERT_LT((ahead[i] - Eigen::Vector3d(optical[i].z(), -optical[i].x(), -optical[i].y())).norm(), 1e-12);
}

TEST(RaysFrom, AreTurnedAndMovedByThePose) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(1.0, 2.0, 3.0)).rotate(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()));
  const std::vector<Eigen::Vector3d> directions = {{1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  const auto rays = rays_from(pose, directions, 7.0);
  ASSERT_EQ(rays.size(), 2U);
  EXPECT_EQ(rays[0].origin, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_LT((rays[0].direction - Eigen::Vector3f(0.0F, 1.0F, 0.0F)).norm(), 1e-6F);
  EXPECT_LT((rays[1].direction - Eigen::Vector3f(0.0F, 0.0F, 1.0F)).norm(), 1e-6F);
  EXPECT_EQ(rays[1].max_range, 7.0);
}

TEST(PinholeDirections, RefusesWhatIsNoCamera) {
  Eigen::Matrix3d intrinsics = Eigen::Matrix3d::Identity();
  EXPECT_THROW(static_cast<void>(pinhole_directions(intrinsics, 0, 3)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pinhole_directions(intrinsics, std::size_t{1} << 40, 1 << 20)),
               std::invalid_argument);
  intrinsics(1, 1) = 0.0;
  EXPECT_THROW(static_cast<void>(pinhole_directions(intrinsics, 3, 3)), std::invalid_argument);
  intrinsics(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(pinhole_directions(intrinsics, 3, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::test
