// Options of runs in motion do what their help says.

#include "app/explore_motion.hpp"

#include <frontlux/planner/recording.hpp>

#include <map>

namespace frontlux::planner {
namespace {

using test::content_of;
using test::ExploreMotion;
using test::joined;
using test::Table;

TEST_F(ExploreMotion, ScansArriveAfterTheirDelay) {
  expect_answer(joined(quick("run", "2"), {"--scan-delay", "1"}));
  const Recording recording = read_recording(path("run/run.frontlux"));
  std::size_t early = 0, late = 0;  // steps
  for (const RecordedStep& step : recording.steps) {
    if (step.step.number == 0) continue;
    std::size_t changed = 0;
    for (const RobotStep& robot : step.step.robots) changed += robot.changed.size();
    if (step.step.time < 1.0) {
      ++early;
      EXPECT_EQ(changed, 0U) << step.step.time << " s";
    } else {
      late += changed > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(early, 0U);
  EXPECT_GT(late, 0U);
}

// Each of them makes another run of the same one, and no two the same.
TEST_F(ExploreMotion, ItsOptionsHaveAnEffect) {
  const std::vector<std::vector<std::string>> of_tours = {
      {"--noise", "0.05"},   {"--noise-growth", "0.01"},   {"--dropout", "0.3"},
      {"--stray", "0.002"},  {"--drift", "0.05"},          {"--tracking-error", "0.1"},
      {"--optimize", "off"}, {"--tours-without", "tours"}, {"--world-seed", "2"}};
  const std::vector<std::vector<std::string>> of_goals = {{"--lambda", "1"},
                                                          {"--advance", "20"},
                                                          {"--min-distance", "2"},
                                                          {"--assign", "off"},
                                                          {"--samples", "2"}};
  for (const auto& [search, changes] : {std::pair("tour", of_tours), {"render", of_goals}}) {
    std::map<std::string, std::string> options;  // by what has been mapped and gone with them
    // The distance of the nearest goal.
    const auto explore = [&, goal = search](const std::vector<std::string>& words) {
      expect_answer(joined(quick("run", "2.5"), joined({"--goal", goal, "--force"}, words)));
      std::string option = goal;
      for (const std::string& word : words) option += " " + word;
      const std::string run = content_of(path("run/map.ot")) + content_of(path("run/motion.csv"));
      const auto [same, is_new] = options.emplace(run, option);
      EXPECT_TRUE(is_new) << option << " is the same run as " << same->second;
      double nearest = std::numeric_limits<double>::infinity();
      for (const RecordedStep& step : read_recording(path("run/run.frontlux")).steps)
        for (const RobotStep& robot : step.step.robots)
          if (robot.goal.pose && !robot.image.empty()) nearest = std::min(nearest, robot.goal.distance);
      return nearest;
    };
    const double without = explore({});
    for (const auto& words : changes) {
      const double nearest = explore(words);
      if (words.front() != "--min-distance") continue;
      EXPECT_LT(without, 2.0);
      EXPECT_GE(nearest, 2.0 - 1e-6);
    }
  }
}

// By rays to drawn frontiers gains are estimates.
TEST_F(ExploreMotion, ExactRenderingCountsFrontiers) {
  const auto uncertain = [&](const std::string& renderer) {
    expect_answer(joined(quick("run", "0.5"), {"--goal", "render", "--renderer", renderer, "--force"}));
    std::size_t cells = 0, estimated = 0;
    for (const RecordedStep& step : read_recording(path("run/run.frontlux")).steps)
      for (const RobotStep& robot : step.step.robots)
        for (const RenderedCell& cell : robot.image) {
          ++cells;
          estimated += cell.standard_error > 0.0 ? 1 : 0;
        }
    EXPECT_GT(cells, 10U) << renderer;
    return estimated;
  };
  EXPECT_EQ(uncertain("exact"), 0U);
  EXPECT_GT(uncertain("rays"), 10U);
}

TEST_F(ExploreMotion, WaitsForNoScanToPlanToFailAndToEnd) {
  const std::string slow = write("slow.json", R"({"name": "slow", "motion": "space", "body":
    {"kind": "box", "size_m": [0.4, 0.4, 0.3]}, "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72,
    "range_m": 5, "columns": 48, "rows": 36, "rate_hz": 0.1}})");
  ASSERT_EQ(run({"room", "--team", "", "--robot", slow, "--robot", slow, "--stop-time", "12.5", "--fail",
                 "slow2=7.25", "--report", "off", "-o", path("run")})
                .code,
            0);
  EXPECT_EQ(json_in("run").at("time_s").at("end"), 12.5);
  EXPECT_EQ(json_in("run").at("by_robot").at("slow2").at("failed_s"), 7.25);
  const Table events(path("run/events.csv"));
  std::vector<double> times;
  for (std::size_t i = 0; i < events.size(); ++i)
    if (events.text(i, "robot") == "slow1") times.push_back(events.number(i, "time_s"));
  ASSERT_GT(times.size(), 9U);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LE(times[i] - times[i - 1], 1.25 + 1e-9);
}

TEST_F(ExploreMotion, KeepsHeightsAboveTheLowestFloor) {
  const std::string high =
      write("high.json", R"({"name": "high", "motion": "space", "min_height_m": 1.2, "body":
    {"kind": "box", "size_m": [0.4, 0.4, 0.3]}, "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72,
    "range_m": 5, "columns": 48, "rows": 36, "rate_hz": 4}})");
  expect_answer(
      {"room", "--team", "", "--robot", high, "--stop-time", "20", "--report", "off", "-o", path("run")});
  const Table motion(path("run/motion.csv"));
  double lowest = 9.0;
  for (std::size_t i = 0; i < motion.size(); ++i) lowest = std::min(lowest, motion.number(i, "z_m"));
  EXPECT_GE(lowest, 1.2 - 1e-6) << "the floor of the room is at 0";
  expect_refused({"room", "--team", "", "--robot", high, "--pose", "high=8.45,8.35,0.75,0", "-o", path("no")},
                 {"--pose: 'high=8.45,8.35,0.75,0' is 0.75 m above the floor at z = 0.00 m", "keeps 1.20 m"});
}

}  // namespace
}  // namespace frontlux::planner
