#include "support/complaint.hpp"
#include "support/plain_gain.hpp"
#include "support/random.hpp"

#include <frontlux/planner/information_gain.hpp>

namespace frontlux::planner {
namespace {

using test::Random;
using test::Scene;

constexpr double kPi = std::numbers::pi;

FieldOfView random_view(Random& random) {
  constexpr std::array kShapes = {FieldOfView::Shape::kPyramid, FieldOfView::Shape::kPyramid,
                                  FieldOfView::Shape::kSpinning, FieldOfView::Shape::kCone};
  return {kShapes[static_cast<std::size_t>(random.below(4))], random.uniform(0.3, 2.6),
          random.uniform(0.3, 2.6), random.uniform(3.0, 12.0)};
}

// Fourth order: what is left is far below 1e-6 of the slope.
double central_difference(const std::function<double(double)>& f, double h) {
  return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h);
}

TEST(InformationGain, ThreeGradientsAgree) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    Scene scene =
        test::random_scene(random, 1 + random.below(5), 1 + random.below(20), 0.7, random_view(random));
    for (Pose& pose : scene.path) {
      // Any yaw, several turns away, and right at the jump of the angle.
      const int kind = random.below(3);
      if (kind == 0) pose.yaw = random.uniform(-20.0, 20.0);
      if (kind == 1) pose.yaw = std::copysign(kPi, random.uniform(-1, 1)) + random.uniform(-1e-9, 1e-9);
    }
    const GainOptions options{random.one_in(2) ? GainMode::kOr : GainMode::kSum, random.uniform(0.5, 0.999),
                              random.uniform(1.0, 8.0)};
    const double k = random.uniform(1.0, 40.0);
    const InformationGain gain = scene.gain(options);
    const std::size_t n = scene.path.size();
    std::vector<double> yaw_gradient(n);
    std::vector<PoseGradient> closed(n);
    const double value = gain.value(scene.yaws(), k, yaw_gradient);
    // Each 1 - product rounds to 1e-16 however small the gain.
    const double rounding = 1e-11 * value + 1e-14;
    EXPECT_NEAR(value, test::plain_gain(scene, scene.path, options, k), rounding);
    EXPECT_NEAR(gain.value(scene.yaws(), k), value, rounding);
    EXPECT_NEAR(gain.value_at(scene.path, k, closed), value, rounding);
    const auto automatic = test::automatic_gradient(scene, options, k);

    double largest =
        std::max(1e-9, 1e-4 * value);  // below that a derivative is lost in the rounding of differences
    for (const Eigen::Vector4d& g : automatic) largest = std::max(largest, g.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < n; ++i) {
      const auto moved = [&](int axis) {
        return [&, axis](double by) {
          auto poses = scene.path;
          (axis == 3 ? poses[i].yaw : poses[i].position[axis]) += by;
          return test::plain_gain(scene, poses, options, k);
        };
      };
      EXPECT_NEAR(yaw_gradient[i], automatic[i][3], 1e-9 * largest) << trial;
      EXPECT_NEAR(closed[i].yaw, automatic[i][3], 1e-9 * largest) << trial;
      EXPECT_NEAR(closed[i].yaw, central_difference(moved(3), 5e-3 / k), 1e-6 * largest) << trial;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(closed[i].position[axis], automatic[i][axis], 1e-9 * largest) << trial;
        double nearest = 1.0;
        for (const Eigen::Vector3d& f : scene.frontiers)
          nearest = std::min(nearest, (f - scene.path[i].position).norm());
        const double difference = central_difference(moved(axis), 2e-3 * nearest / std::max(k, 8.0));
        EXPECT_NEAR(closed[i].position[axis], difference, 1e-6 * largest) << trial << " axis " << axis;
      }
    }
  }
}

TEST(InformationGain, AWholeTurnChangesNothing) {
  Random random(2);
  const Scene scene = test::random_scene(random, 6, 200);
  const InformationGain gain = scene.gain();
  auto yaws = scene.yaws();
  std::vector<double> before(yaws.size()), after(yaws.size());
  const double value = gain.value(yaws, 20.0, before);
  for (std::size_t i = 0; i < yaws.size(); ++i) yaws[i] += 2.0 * kPi * (i % 2 == 0 ? 1.0 : -3.0);
  EXPECT_NEAR(gain.value(yaws, 20.0, after), value, 1e-11 * value);
  for (std::size_t i = 0; i < yaws.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-9 * value);
}

TEST(InformationGain, DistinctIsFieldOfViewTimesVisibility) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    Scene scene = test::random_scene(random, 1 + random.below(6), 60, 0.5, random_view(random));
    if (trial % 3 == 0) {  // on a lattice, many frontiers lie exactly on the edge of the view
      scene.view.horizontal = kPi / 2;
      for (Pose& pose : scene.path) {
        pose.position = pose.position.array().round();
        pose.yaw = kPi / 2 * random.below(8);
      }
      for (Eigen::Vector3d& f : scene.frontiers) f = f.array().round();
    }
    EXPECT_EQ(scene.gain().distinct(scene.yaws()), test::distinct_by_hand(scene, scene.yaws())) << trial;
  }
}

TEST(InformationGain, SharpMembershipsTendToTheHardCount) {
  Random random(4);
  Scene scene = test::random_scene(random, 8, 400, 1.0);
  // Keep pairs that are clearly in or clearly out.
  std::vector<VisiblePair> clear;
  for (const VisiblePair& pair : scene.list) {
    const auto& pose = scene.path[pair.viewpoint];
    const auto& at = pose.position;
    const auto m = static_cast<double>(test::membership<long double>(
        {at.x(), at.y(), at.z(), pose.yaw}, scene.frontiers[pair.frontier], scene.view, 300.0, 300.0));
    if (m < 1e-15 || m > 1.0 - 1e-15) clear.push_back(pair);
  }
  scene.list = clear;
  const InformationGain gain = scene.gain({GainMode::kOr, 1.0 - 1e-9, 1000.0});
  const auto hard = static_cast<double>(gain.distinct(scene.yaws()));
  ASSERT_GT(hard, 50.0);
  EXPECT_NEAR(gain.value(scene.yaws(), InformationGain::kMaxSharpness), hard, 1e-3 * hard);
}

TEST(InformationGain, HundredsOfViewpointsOfOneFrontierDoNotUnderflow) {
  Scene scene{{}, {Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(-3, 0.1, 0)}, {}, test::camera()};
  for (std::uint32_t i = 0; i < 500; ++i) {
    scene.path.push_back({Eigen::Vector3d::Zero(), 0.0});
    scene.list.push_back({i, 0});
    scene.list.push_back({i, 1});
  }
  for (const double k : {1e-3, 8.0, 40.0, 100.0}) {
    const InformationGain gain = scene.gain();
    std::vector<double> gradient(500);
    EXPECT_NEAR(gain.value(scene.yaws(), k, gradient), test::plain_gain(scene, scene.path, {}, k), 1e-10);
    for (const double slope : gradient) EXPECT_TRUE(std::isfinite(slope));
  }
}

TEST(InformationGain, YawDoesNothingForASpinningSensor) {
  Random random(5);
  const Scene scene = test::random_scene(random, 5, 100, 0.7, {FieldOfView::Shape::kSpinning, 0.0, 0.7, 6.0});
  const InformationGain gain = scene.gain();
  std::vector<double> gradient(5, 1.0), turned = scene.yaws();
  const double value = gain.value(scene.yaws(), 20.0, gradient);
  for (const double slope : gradient) EXPECT_EQ(slope, 0.0);
  for (double& yaw : turned) yaw += 1.0;
  EXPECT_EQ(gain.value(turned, 20.0), value);
  EXPECT_GT(gain.distinct(turned), 0U);
  EXPECT_EQ(gain.distinct(turned), gain.distinct(scene.yaws()));
}

TEST(InformationGain, AFrontierAtTheSensorIsNotSeen) {
  const Scene scene{{{Eigen::Vector3d(1, 2, 3), 0.5}}, {Eigen::Vector3d(1, 2, 3)}, {{0, 0}}, test::camera()};
  std::vector<PoseGradient> gradient(1);
  EXPECT_EQ(scene.gain().value(scene.yaws(), 20.0), 0.0);
  EXPECT_EQ(scene.gain().value_at(scene.path, 20.0, gradient), 0.0);
  EXPECT_EQ(scene.gain().distinct(scene.yaws()), 0U);
}

TEST(InformationGain, RefusesWhatIsNoNumber) {
  Random random(6);
  const Scene scene = test::random_scene(random, 3, 10);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    Scene broken = scene;
    broken.path[1].position.y() = bad;
    EXPECT_REFUSED(broken.gain());
    broken = scene;
    broken.frontiers[2].z() = bad;
    EXPECT_REFUSED(broken.gain());
    auto yaws = scene.yaws();
    yaws[2] = bad;
    EXPECT_REFUSED(scene.gain().value(yaws, 8.0));
    EXPECT_REFUSED(scene.gain().distinct(yaws));
    EXPECT_REFUSED(scene.gain({GainMode::kOr, bad, 4.0}));
    EXPECT_REFUSED(scene.gain({GainMode::kOr, 0.9, bad}));
    EXPECT_REFUSED(scene.gain().value(scene.yaws(), bad));
  }
  for (const double sharpness : {0.0, 101.0}) EXPECT_REFUSED(scene.gain().value(scene.yaws(), sharpness));
  EXPECT_REFUSED(scene.gain({GainMode::kOr, 1.0, 4.0}));
  const std::vector<double> two(2, 0.0);
  EXPECT_REFUSED(scene.gain().value(two, 8.0));
  EXPECT_REFUSED(scene.gain().distinct(two));
  std::vector<double> short_gradient(2);
  EXPECT_REFUSED(scene.gain().value(scene.yaws(), 8.0, short_gradient));
  EXPECT_REFUSED(InformationGain(scene.path, scene.frontiers, {4, 10, {}}, scene.view));
}

}  // namespace
}  // namespace frontlux::planner
