// `frontlux explore` in a house of two storeys, which a hatch joins: a small UAV maps both, from either.

#include "app/explore_motion.hpp"

namespace frontlux::planner {
namespace {

using test::ExploreMotion;
using test::Table;

class ExploreStoreys : public ExploreMotion {
 protected:
  static constexpr double kStorey = 2.7;  // [m] from floor to floor, 0.3 m of them ceiling
  static constexpr double kWall = 1.2;    // [m] x of a wall across each storey, with a low opening

  // Each storey is 6 x 3.6 x 2.4 m. The hatch is at low x; beyond the wall, at high x, lies a part of each
  // storey into which an opening of 0.9 m along y and z leads, from the floor up.
  [[nodiscard]] std::string house() const {
    std::ostringstream obj;
    int vertices = 0;
    const auto box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
      add_prism(obj, vertices, low, high, high.z());
    };
    constexpr double kTop = 2 * kStorey - 0.3;
    box({-3.3, -2.1, -0.3}, {3.3, 2.1, 0.0});
    box({-3.3, -2.1, kTop}, {3.3, 2.1, kTop + 0.3});
    box({-3.3, -2.1, 0.0}, {-3.0, 2.1, kTop});
    box({3.0, -2.1, 0.0}, {3.3, 2.1, kTop});
    box({-3.0, -2.1, 0.0}, {3.0, -1.8, kTop});
    box({-3.0, 1.8, 0.0}, {3.0, 2.1, kTop});
    box({-1.5, -1.8, kStorey - 0.3}, {3.0, 1.8, kStorey});  // the hatch is beside it and before the next one
    box({-3.0, -0.3, kStorey - 0.3}, {-1.5, 1.8, kStorey});
    for (const double floor : {0.0, kStorey}) {
      box({kWall, -1.8, floor}, {kWall + 0.3, -0.6, floor + 2.4});
      box({kWall, 0.3, floor}, {kWall + 0.3, 1.8, floor + 2.4});
      box({kWall, -0.6, floor + 0.9}, {kWall + 0.3, 0.3, floor + 2.4});
    }
    return write("house.obj", obj.str());
  }
  // What each storey's path was: how low over its floor, and how far along x.
  struct Storey {
    double lowest = 1e9, farthest = -1e9;
  };
  struct Outcome {
    double mapped = 0.0;
    std::array<Storey, 2> storeys;
  };
  [[nodiscard]] Outcome explore(double height, const std::string& more = "") const {
    const std::string robot = write("uav.json", R"({"name": "uav", "motion": "space",
      "body": {"kind": "cylinder", "diameter_m": 0.24, "height_m": 0.2}, "margin_m": 0.03, )" +
                                                    more + R"("limits": {"speed_m_s": 1.5},
      "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72, "range_m": 6, "columns": 48,
      "rows": 36, "rate_hz": 5}})");
    const Table motions =
        motions_without_contact({house(), "--start=-2.25,0.75," + std::to_string(height), "--resolution",
                                 "0.3", "--team", "", "--robot", robot, "--stop-time", "200"});
    Outcome outcome;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const Eigen::Vector3d at = motions.point(i, "", "_m");
      const bool upper = at.z() > kStorey;
      Storey& storey = outcome.storeys.at(upper ? 1 : 0);
      const bool over_hatch = upper && at.x() < -1.5 + 0.2 && at.y() < -0.3 + 0.2;
      if (!over_hatch) storey.lowest = std::min(storey.lowest, at.z() - (upper ? kStorey : 0.0));
      storey.farthest = std::max(storey.farthest, at.x());
    }
    outcome.mapped = json_in("run").at("coverage_observable");
    return outcome;
  }
};

// Through openings 0.9 m high it comes nearer to either floor than 1.2 m over where it starts, and no nearer
// than half of its height and its margin.
TEST_F(ExploreStoreys, MapsBothFromEither) {
  for (const double height : {1.0, kStorey + 1.0}) {
    SCOPED_TRACE(height);
    const Outcome outcome = explore(height);
    EXPECT_GT(outcome.mapped, 0.995);
    for (const Storey& storey : outcome.storeys) {
      EXPECT_GT(storey.farthest, kWall + 0.3) << "it has been beyond the wall";
      EXPECT_LT(storey.lowest, 0.9);
      EXPECT_GE(storey.lowest, 0.1 + 0.03 - 1e-3);
    }
  }
}

// Of a robot that is to keep a height over the world's lowest floor, as its file says.
TEST_F(ExploreStoreys, KeepsAnAbsoluteHeightOnlyIfTold) {
  const Outcome outcome = explore(1.5, R"("min_height_m": 1.2, )");
  EXPECT_LT(outcome.mapped, 0.98);
  EXPECT_GE(outcome.storeys[0].lowest, 1.2 - 1e-3);
  EXPECT_LT(outcome.storeys[1].lowest, 0.9);
}

}  // namespace
}  // namespace frontlux::planner
