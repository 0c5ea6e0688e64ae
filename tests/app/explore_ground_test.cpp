// `frontlux explore` with a robot that drives over slopes and steps, in a hall of two levels with a pit.

#include "app/explore_motion.hpp"

namespace frontlux::planner {
namespace {

using test::ExploreMotion;
using test::Table;

class ExploreGround : public ExploreMotion {
 protected:
  // A lower floor with a pit of 1 m, a ramp along x up to 0.6 m, and an upper floor.
  [[nodiscard]] std::string hall(double run) const {
    std::ostringstream obj;
    int vertices = 0;
    const auto box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
      add_prism(obj, vertices, low, high, high.z());
    };
    const double end = run + 4.0;
    box({-5.3, -2.3, -1.3}, {end + 0.3, 2.3, -1.0});
    box({-5.3, -2.3, 2.5}, {end + 0.3, 2.3, 2.8});
    box({-5.3, -2.3, -1.0}, {-5.0, 2.3, 2.5});
    box({end, -2.3, -1.0}, {end + 0.3, 2.3, 2.5});
    box({-5.0, -2.3, -1.0}, {end, -2.0, 2.5});
    box({-5.0, 2.0, -1.0}, {end, 2.3, 2.5});
    box({-5.0, -2.0, -1.0}, {0.0, 0.5, 0.0});
    add_prism(obj, vertices, {0.0, -2.0, -1.0}, {run, 2.0, 0.6}, 0.0);
    box({run, -2.0, -1.0}, {end, 2.0, 0.6});
    return write("hall.obj", obj.str());
  }
  [[nodiscard]] std::string robot(const std::string& motion) const {
    return write(motion + ".json", R"({"name": "ugv", "motion": ")" + motion + R"(",
      "body": {"kind": "box", "size_m": [0.6, 0.5, 0.4]}, "mount_height_m": 0.55, "margin_m": 0.05,
      "ground_m": [0.5, 0.4], "sensor": {"kind": "spinning", "vertical_deg": 60, "range_m": 5, "columns": 360,
      "rows": 48}})");
  }
  // Lowest and highest sensor, and the part of the observable space that was mapped.
  struct Outcome {
    double lowest = 1e9, highest = -1e9, mapped = 0.0;
  };
  [[nodiscard]] Outcome explore(double length, const std::string& motion) const {
    const Table motions =
        motions_without_contact({hall(length), "--start=-3,-1,0.3", "--resolution", "0.1", "--team", "",
                                 "--robot", robot(motion), "--stop-time", "60"});
    Outcome outcome;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const Eigen::Vector3d at = motions.point(i, "", "_m");
      outcome.lowest = std::min(outcome.lowest, at.z());
      outcome.highest = std::max(outcome.highest, at.z());
      EXPECT_FALSE(at.x() < -0.1 && at.y() > (motion == "ground" ? 0.3 : 0.6)) << "a wheel over the pit";
    }
    outcome.mapped = json_in("run").at("coverage_observable");
    return outcome;
  }
};

TEST_F(ExploreGround, DrivesUpARampAndNotIntoAPit) {
  const Outcome plane = explore(2.4, "plane"), ground = explore(2.4, "ground");
  EXPECT_LT(plane.highest - plane.lowest, 0.05);
  EXPECT_NEAR(ground.highest - ground.lowest, 0.6, 0.11);
  EXPECT_GT(ground.mapped, plane.mapped + 0.05);
  EXPECT_GT(ground.mapped, 0.95);
}

TEST_F(ExploreGround, LeavesSteepRampsAlone) {
  const Outcome steep = explore(0.6, "ground");
  EXPECT_LT(steep.highest - steep.lowest, 0.31);
}

TEST_F(ExploreGround, NeedsVoxelsThatTellStepsFromFloor) {
  expect_refused({"room", "--team", "", "--robot", robot("ground"), "-o", path("run")}, "step is 0.15");
  EXPECT_FALSE(std::filesystem::exists(path("run")));
}

// Voxels of any size: its sensor is seldom in the middle of one.
TEST_F(ExploreGround, StaysOnItsPlaneAtTheHeightOfItsSensor) {
  for (const char* resolution : {"0.27", "0.4"}) {
    SCOPED_TRACE(resolution);
    expect_answer({"room", "--team", "ugv", "--resolution", resolution, "--bumper", "off", "--stop-time",
                   "25", "--report", "off", "--force", "-o", path("run")},
                  {"contacts     0"});
    const Table motions(path("run/motion.csv"));
    for (std::size_t i = 0; i < motions.size(); ++i) ASSERT_NEAR(motions.number(i, "z_m"), 0.75, 1e-3) << i;
    EXPECT_GT(json_in("run").at("coverage_observable"), 0.8);
  }
}

}  // namespace
}  // namespace frontlux::planner
