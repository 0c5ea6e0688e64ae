#include "planner/recording/random_recording.hpp"
#include "support/input_test.hpp"

#include <frontlux/io/robot_file.hpp>

namespace frontlux::io {
namespace {

using planner::RobotDescription;
using planner::TravelOptions;

class RobotFile : public test::InputTest {
 protected:
  RobotFile() : InputTest([](const auto& file) { static_cast<void>(read_robot(file)); }) {}

  [[nodiscard]] RobotDescription read(const std::string& text) const {
    return read_robot(save("r.json", text));
  }
};

void expect_equal(const RobotDescription& a, const RobotDescription& b) {
  EXPECT_EQ(test::listed(a), test::listed(b));
}

const std::filesystem::path kRobots = std::filesystem::path(FRONTLUX_DATA_DIR) / "robots";

TEST_F(RobotFile, ThoseThatShipAreTheBuiltInOnesInMotionToTheLastBit) {
  for (auto [file, robot] :
       {std::pair("ugv.json", planner::ugv_description()), {"uav.json", planner::uav_description()}}) {
    robot.robot = planner::in_motion(robot.robot, 0.3);
    expect_equal(read_robot(kRobots / file), robot);
  }
  EXPECT_EQ(planner::ugv_description().columns * planner::ugv_description().rows, 32U * 720U);
  EXPECT_EQ(planner::uav_description().columns, 160U);
}

TEST_F(RobotFile, ReadsAConeAndWhatIsLeftOut) {
  const RobotDescription sonar = read_robot(kRobots / "sonar.json");
  EXPECT_EQ(sonar.robot.view.shape, FieldOfView::Shape::kCone);
  EXPECT_DOUBLE_EQ(sonar.robot.view.horizontal, std::numbers::pi / 6);
  EXPECT_EQ(sonar.robot.travel.sensor_height, 0.5);
  sonar.robot.check();
  const RobotDescription nodes = read(
      R"({"name":"n","motion":"space","box_m":[0.5,0.6,0.7],"node_edge_m":1.2,
          "sensor":{"kind":"spinning","vertical_deg":30,"range_m":4.5,"columns":8,"rows":2}})");
  EXPECT_EQ(nodes.robot.travel.extents, Eigen::Vector3d(0.5, 0.6, 0.7));
  EXPECT_EQ(nodes.robot.travel.node_edge, 1.2);
  EXPECT_EQ(nodes.robot.travel.min_height, 0.35);
  EXPECT_EQ(nodes.robot.view.horizontal, 0.0);
}

TEST_F(RobotFile, ReadsLimitsMarginAndRate) {
  const RobotDescription plain = read_robot(kRobots / "sonar.json"),
                         camera = read_robot(kRobots / "uav.json");
  EXPECT_EQ(plain.robot.limits, planner::MotionLimits());
  EXPECT_EQ(plain.robot.travel.margin, 0.0);
  EXPECT_EQ(plain.rate, 10.0);
  EXPECT_EQ(camera.rate, 15.0);
  EXPECT_EQ(camera.robot.limits, planner::uav().limits);
  const RobotDescription all = read(
      R"({"name":"n","motion":"plane","box_m":[0.5,0.6,0.7],"mount_height_m":0.4,"margin_m":0.2,
          "limits":{"speed_m_s":3,"acceleration_m_s2":4,"yaw_rate_deg_s":180,"per_axis":true},
          "sensor":{"kind":"spinning","vertical_deg":30,"range_m":4.5,"columns":8,"rows":2,"rate_hz":2.5}})");
  EXPECT_EQ(all.robot.travel.margin, 0.2);
  EXPECT_EQ(all.robot.limits, (planner::MotionLimits{3.0, 4.0, std::numbers::pi, true}));
  EXPECT_EQ(all.rate, 2.5);
}

TEST_F(RobotFile, ReadsRobotsOnTheGround) {
  const std::string
      start = R"({"name": "n", "motion": "ground", "box_m": [0.7, 0.5, 0.4], "mount_height_m": 0.5, )",
      end = R"("sensor": {"kind": "spinning", "vertical_deg": 30, "range_m": 4, "columns": 8, "rows": 2}})";
  const planner::TravelOptions usual = read(start + end).robot.travel,
                               given =
                                   read(start + R"("step_m": 0.25, "slope_deg": 45, )" + end).robot.travel;
  EXPECT_EQ(usual.motion, planner::Motion::kGround);
  EXPECT_EQ(usual.step, 0.15);
  EXPECT_DOUBLE_EQ(usual.slope, std::numbers::pi / 9);
  EXPECT_EQ(given.step, 0.25);
  EXPECT_DOUBLE_EQ(given.slope, std::numbers::pi / 4);
}

TEST_F(RobotFile, SaysWhatIsWrongAndWhatToDo) {
  const std::string good =
      R"({"name": "r", "motion": "plane", "box_m": [1, 1, 0.7], "mount_height_m": 0.75, "sensor": )"
      R"({"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72, "range_m": 10, "columns": 16, "rows": 12}})";
  EXPECT_EQ(complaint("r.json", good), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    return test::replaced(good, from, to);
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with(R"("name": "r", )", ""), "name is missing; give 1 to 40 letters"},
      {with(R"("r")", R"("../r")"), "name is '../r'; give 1 to 40 letters"},
      {with(R"("r")", R"("")"), "name is ''; give"},
      {with(R"("r")", "7"), "name is 7; give"},
      {with(R"("plane")", R"("hover")"), R"(motion is 'hover'; give "plane", "ground" or "space")"},
      {with(R"("plane")", R"("space")"),
       R"(mount_height_m is for a robot with the motion "plane" or "ground"; leave it out)"},
      {with("0.75", "0.75, \"step_m\": 0.1"),
       R"(step_m is for a robot with the motion "ground"; leave it out)"},
      {with(R"("plane")", R"("ground", "require_ground": true)"),
       R"(require_ground is for a robot with the motion "plane"; leave it out)"},
      {with(R"("plane")", R"("ground", "slope_deg": 95)"),
       "slope_deg is 95; give a number from 0 to 80 degrees"},
      {with(R"("plane")", R"("ground", "step_m": -0.1)"), "step_m is -0.1; give a number from 0.001 to 10 m"},
      {with("0.75", "0.75, \"min_height_m\": 1"), "min_height_m is for a robot with the motion \"space\""},
      {with("0.75", "0.75, \"require_ground\": 1"), "require_ground is 1; give true or false"},
      {with("0.75", "-1"), "mount_height_m is -1; give a number from 0 to 100 m"},
      {with(R"("mount_height_m": 0.75, )", ""), "mount_height_m is missing; give a number from 0 to 100 m"},
      {with("[1, 1, 0.7]", "[1, 1]"), "box_m is an array of 2; give three numbers"},
      {with("[1, 1, 0.7]", "1"), "box_m is 1; give three numbers"},
      {with("[1, 1, 0.7]", "[1, \"1\", 0.7]"), "box_m[1] is '1'; give a number from 0.01 to 100 m"},
      {with("[1, 1, 0.7]", "[1, 1, 0]"), "box_m[2] is 0; give a number from 0.01"},
      {with("[1, 1, 0.7]", "[1, [1], 0.7]"), "box_m[1] is an array"},
      {with("[1, 1, 0.7]", "[1, [[1]], 0.7]"), "'box_m' is nested too deeply"},
      {with("[1, 1, 0.7]", R"([1, 1, 0.7], "body": {"kind": "sphere", "diameter_m": 1})"),
       "box_m is given beside body; leave it out"},
      {with("\"range_m\": 10", "\"range_m\": 1e300"),
       "sensor.range_m is 1e+300; give a number from 0.01 to 1000 m"},
      {with("\"range_m\": 10", "\"range_m\": 1e999"), "a number is too large, in or after 'range_m'"},
      {with("\"range_m\": 10", "\"range_m\": NaN"), "line 1, column 162: this is not JSON (after 'range_m')"},
      {with("\"range_m\": 10", "\"range_m\": null"), "sensor.range_m is null; give"},
      {with("90", "180"), "sensor.horizontal_deg is 180; give a number from 0.1 to 179 degrees"},
      {with("72", "\"72\""), "sensor.vertical_deg is '72'; give"},
      {with("\"camera\"", "\"lidar\""), "sensor.kind is 'lidar'; give \"spinning\", \"camera\" or \"cone\""},
      {with("\"camera\"", "\"cone\""), "sensor.vertical_deg is not for a cone"},
      {with("\"camera\"", "\"spinning\""), "sensor.horizontal_deg is not for a spinning sensor"},
      {with("\"columns\": 16", "\"columns\": 0"), "sensor.columns is 0; give a whole number from 1"},
      {with("\"columns\": 16", "\"columns\": -5"), "sensor.columns is -5; give"},
      {with("\"columns\": 16", "\"columns\": 16.5"), "sensor.columns is 16.5; give a whole number"},
      {with("\"columns\": 16", "\"columns\": 5000000"),
       "sensor.columns is 5000000; give a whole number from 1 to 4194304"},
      {with("\"columns\": 16, \"rows\": 12", "\"columns\": 8000, \"rows\": 4000"),
       "sensor.columns and rows are 8000 and 4000: a scan would take about 4 GB of memory; give at most "
       "4194304 "
       "rays in all"},
      {with("\"columns\": 16, \"rows\": 12", "\"columns\": 2048, \"rows\": 2048, \"rate_hz\": 100"),
       "sensor.columns and rows are 2048 and 2048: with a rate_hz of 100 they are 419430400 rays a second; "
       "give at most 67108864"},
      {with("\"columns\"", "\"colums\""),
       "sensor.columns is missing, unless 'colums' is meant to be it; give a whole number"},
      {with("0.75", "0.75, \"margin_m\": -1"), "margin_m is -1; give a number from 0 to 100 m"},
      {with("0.75", "0.75, \"limits\": 3"), "limits is 3; give an object"},
      {with("0.75", "0.75, \"limits\": {\"speed_m_s\": 0}"),
       "limits.speed_m_s is 0; give a number from 0.001"},
      {with("\"rows\": 12", "\"rows\": 12, \"rate_hz\": \"5\""), "sensor.rate_hz is '5'; give a number"},
      {with("\"rows\": 12", "\"rows\": 12, \"fps\": 3"),
       "the member 'sensor.fps' is not known; known here: kind,"},
      {with("\"name\": \"r\"", "\"name\": \"r\", \"mass\": 3"),
       "the member 'mass' is not known; known here: name,"},
      {with("\"name\": \"r\"", "\"name\": \"r\", \"name\": \"s\""),
       "the member 'name' is there twice; keep one"},
      {with("\"rows\": 12", "\"rows\": 12, \"rows\": 12"), "the member 'rows' is there twice; keep one"},
      {with("\"kind\"", "\"kind\": \"cone\", \"x\": {\"y\": {}}, \"z\""), "'y' is nested too deeply"},
      {good.substr(0, 60), "this is not JSON (after "},
      {"", "is empty"},
      {"\n\n  {\"name\" 3}", "line 3, column 11: this is not JSON"},
      {good + "x", "this is not JSON"},
      {"[]", "holds an array of 0 and no object; describe a robot"},
      {"3", "holds 3 and no object"},
      {std::string(200'000, '['), "is nested too deeply"},
      {std::string("{\"a\xff\": 1}"), "this is not JSON"},
      {good + std::string(1 << 20, ' '), "too many for a robot; give a description of at most 1048576 bytes"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string what = complaint("r.json", text);
    test::expect_parts(what, {expected});
    for (const char c : what) EXPECT_TRUE(c >= ' ' && c <= '~') << what;
  }
  EXPECT_THROW(static_cast<void>(read_robot(folder_ / "none.json")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(read_robot(std::filesystem::temp_directory_path())), std::runtime_error);
}

TEST_F(RobotFile, SurvivesEveryTruncationAndFlippedByte) {
  const std::string text = test::content_of(kRobots / "uav.json");
  ASSERT_GT(text.size(), 100U);
  for (std::size_t i = 0; i + 2 < text.size(); ++i)
    EXPECT_NE(complaint("r.json", text.substr(0, i)), "") << i;
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const int bit : {0, 3, 7}) {
      std::string damaged = text;
      damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ (1U << bit));
      test::complaint_of<std::runtime_error>([&] { read(damaged).robot.check(); });
    }
}

}  // namespace
}  // namespace frontlux::io
