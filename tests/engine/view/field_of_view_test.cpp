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
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  struct Member {
    double FieldOfView::*value;
    std::string name;
    std::vector<double> bad;
    std::set<FieldOfView::Shape> unused;
  };
  using Shape = FieldOfView::Shape;
  const std::vector<double> no_angle = {nan, -infinity, -0.1, 0.0, std::numbers::pi, 4.0, infinity};
  const Member members[] = {{&FieldOfView::horizontal, "horizontal", no_angle, {Shape::kSpinning}},
                            {&FieldOfView::vertical, "vertical", no_angle, {Shape::kCone}},
                            {&FieldOfView::max_range, "max_range", {nan, -1.0, 0.0, infinity}, {}}};
  for (const FieldOfView& view : {lidar(), camera(), sonar()}) {
    EXPECT_NO_THROW(view.check());
    for (const Member& member : members)
      for (const double bad : member.bad) {
        SCOPED_TRACE(testing::Message() << member.name << ' ' << bad);
        FieldOfView wrong = view;
        wrong.*member.value = bad;
        if (member.unused.contains(view.shape)) {
          EXPECT_NO_THROW(wrong.check());
        } else {
          expect_complaint([&] { wrong.check(); }, {member.name + ' ', "is " + std::to_string(bad)});
        }
      }
  }
  FieldOfView wrong = lidar();
  wrong.shape = static_cast<Shape>(9);
  expect_complaint([&] { wrong.check(); }, {"shape", "9"});
}

}  // namespace
}  // namespace frontlux::test
