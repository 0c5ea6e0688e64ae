// `frontlux explore` with robots that come later than the others, or again.

#include "app/explore_motion.hpp"

#include <map>

namespace frontlux::test {
namespace {

TEST_F(ExploreMotion, RobotsComeLaterAndAgainAsAsked) {
  const auto words = [&](const std::string& output) {
    return joined(quick(output, "6"), {"--fail", "one=1", "--join", "one=3,two=2.5"});
  };
  const Answer answer = run(words("run"));
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("joined after 2.5 s"), std::string::npos) << answer.out;
  EXPECT_NE(answer.err.find("'one' failed after 1"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find(", and joined the others again, as --join says"), std::string::npos)
      << answer.err;
  const nlohmann::json robots = json_in("run").at("by_robot");
  EXPECT_EQ(robots.at("one").at("failed_s"), 1.0);
  EXPECT_EQ(robots.at("one").at("joined_s"), 3.0);
  EXPECT_FALSE(robots.at("two").contains("failed_s"));
  EXPECT_EQ(robots.at("two").at("joined_s"), 2.5);
  const Table events(path("run/events.csv"));
  std::map<std::string, std::vector<double>> starts;  // plannings, by robot
  for (std::size_t i = 0; i < events.size(); ++i) {
    const double time = events.number(i, "time_s");
    if (events.text(i, "reason") == "start") starts[events.text(i, "robot")].push_back(time);
    if (events.text(i, "robot") == "one") {
      EXPECT_TRUE(time <= 1.0 || time >= 3.0) << time;
    } else {
      EXPECT_GE(time, 2.5);
    }
  }
  ASSERT_EQ(starts["one"].size(), 2U);
  EXPECT_NEAR(starts["one"][1], 3.0, 0.3);
  ASSERT_EQ(starts["two"].size(), 1U);
  EXPECT_NEAR(starts["two"][0], 2.5, 0.3);
  // In two parts it is the same.
  ASSERT_EQ(run(joined(words("parts"), {"--max-steps", "4"})).code, 0);
  ASSERT_EQ(run({"--resume", path("parts"), "--max-steps", "1000000", "--report", "off"}).code, 0);
  expect_same_motions("run", "parts");
}

// Robots that have nothing to do plan once a second.
TEST_F(ExploreMotion, EndsAtItsLimitsWhileARobotIsToCome) {
  write("near.json",
        R"({"name": "near", "motion": "space", "box_m": [0.5, 0.5, 0.3], "sensor": {"kind": "camera",
      "horizontal_deg": 90, "vertical_deg": 70, "range_m": 0.05, "columns": 16, "rows": 12}})");
  const std::vector<std::string> words = {
      "room",   "--team",   "",         "--robot", path("near.json"), "--robot", path("near.json"),
      "--join", "near2=60", "--report", "off"};
  ASSERT_EQ(run(joined(words, {"--max-steps", "4", "-o", path("few")})).code, 0);
  EXPECT_EQ(json_in("few").at("end"), "step_limit");
  EXPECT_EQ(json_in("few").at("steps"), 4);
  const Answer answer = run(joined(words, {"--stop-time", "8", "-o", path("short")}));
  EXPECT_EQ(json_in("short").at("end"), "time_limit");
  EXPECT_NE(
      answer.err.find("warning: the robot 'near2' had not joined the others by the end, as --join says"),
      std::string::npos)
      << answer.err;
}

TEST_F(ExploreMotion, GoesOnWhileARobotIsToCome) {
  ASSERT_EQ(run(joined(quick("run", "40"), {"--fail", "one=0.5", "--join", "two=20"})).code, 0);
  const nlohmann::json json = json_in("run");
  EXPECT_GT(json.at("time_s").at("end").get<double>(), 21.0);
  EXPECT_GT(json.at("by_robot").at("two").at("length_m").get<double>(), 1.0);
  EXPECT_GT(json.at("coverage_observable").get<double>(), 0.5);
}

}  // namespace
}  // namespace frontlux::test
