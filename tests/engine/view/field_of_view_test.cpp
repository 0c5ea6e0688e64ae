// Membership against the definitions, written with angles instead of slopes.

#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/views.hpp"

#include <frontlux/field_of_view.hpp>

namespace frontlux::test {
namespace {

FieldOfView sonar() { return cone(30 * kDegree, 4.0); }

TEST(FieldOfView, AgreesWithAngles) {
  Random random(1);
  std::size_t inside = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Eigen::Vector3d offset = random.point(-8, 8);
    const double yaw = random.uniform(-10, 10), range = offset.norm();
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
  Random random(2);
  for (const FieldOfView& view : {lidar(), camera(), sonar()})
    for (int i = 0; i < 2'000; ++i) {
      const Eigen::Vector3d offset = random.point(-8, 8).cwiseProduct(Eigen::Vector3d(1, 1, 0.5));
      // If any yaw shows a point, then the one that looks straight at it.
      const double towards = std::atan2(offset.y(), offset.x());
      EXPECT_EQ(view.contains_at_some_yaw(offset), view.contains(offset, towards));
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
  FieldOfView flat = camera(), blind = camera(), broken = lidar();
  flat.horizontal = std::numbers::pi;
  blind.max_range = 0;
  broken.vertical = std::nan("");
  for (const FieldOfView& view : {flat, blind, broken}) EXPECT_REFUSED(view.check());
}

}  // namespace
}  // namespace frontlux::test
