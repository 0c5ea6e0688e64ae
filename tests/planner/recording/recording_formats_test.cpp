#include "planner/recording/recorded_run.hpp"

namespace frontlux::planner {
namespace {

using test::listed;
using RecordingFormatsTest = test::RecordedRun;

// format_3.frontlux: frontlux explore room --seed 1 --max-steps 6 --resolution 1, before there were tours.
TEST_F(RecordingFormatsTest, ReadsAndGoesOnWithTheFormatWithoutTours) {
  save(test::content_of(FRONTLUX_DATA_DIR "/../tests/planner/recording/format_3.frontlux"));
  const Recording old = read_recording(file_);
  EXPECT_EQ(old.format, 3);
  EXPECT_EQ(old.head.world, "room");
  EXPECT_EQ(old.end, "step_limit");
  ASSERT_EQ(old.steps.size(), 7U);
  EXPECT_EQ(old.steps.back().step.time, 2.0);
  EXPECT_EQ(old.steps.back().step.robots[1].goal.reason, "stop 1 of 2, 10 frontiers in view");
  for (const RecordedStep& step : old.steps)
    for (const RobotStep& robot : step.step.robots) EXPECT_TRUE(robot.tour.empty());

  RecordedStep next = old.steps.back();
  next.step.number = 7;
  next.step.robots[1].tour.push_back({{{1.0, 2.0, 3.0}, 0.5}, 1, 10});
  RecordingWriter(file_, old).write(next);
  const Recording longer = read_recording(file_);
  EXPECT_EQ(longer.format, 3);
  EXPECT_EQ(longer.end, std::nullopt);
  next.step.robots[1].tour.clear();
  ASSERT_EQ(longer.steps.size(), 8U);
  EXPECT_EQ(listed(longer.steps.back()), listed(next)) << "the format has no place for tours";
}

// format_4.frontlux: the same, before trajectories and assigned frontiers were recorded.
TEST_F(RecordingFormatsTest, ReadsAndGoesOnWithTheFormatWithoutPlans) {
  save(test::content_of(FRONTLUX_DATA_DIR "/../tests/planner/recording/format_4.frontlux"));
  const Recording old = read_recording(file_);
  EXPECT_EQ(old.format, 4);
  ASSERT_EQ(old.steps.size(), 7U);
  std::size_t stops = 0;
  for (const RecordedStep& step : old.steps)
    for (const RobotStep& robot : step.step.robots) {
      stops += robot.tour.size();
      EXPECT_TRUE(robot.trajectory.empty() && robot.reassigned.empty());
    }
  EXPECT_GT(stops, 0U);

  RecordedStep next = old.steps.back();
  next.step.number = 7;
  next.step.robots[1].trajectory.push_back({{1.0, 2.0, 3.0}, 0.5});
  next.step.robots[1].reassigned.push_back({1, 2, 3});
  RecordingWriter(file_, old).write(next);
  const Recording longer = read_recording(file_);
  EXPECT_EQ(longer.format, 4);
  next.step.robots[1].trajectory.clear();
  next.step.robots[1].reassigned.clear();
  ASSERT_EQ(longer.steps.size(), 8U);
  EXPECT_EQ(listed(longer.steps.back()), listed(next)) << "the format has no place for plans";
}

TEST_F(RecordingFormatsTest, ForeignFiles) {
  expect_refused("", "ends in its first line");
  expect_refused("frontl", "ends in its first line");
  expect_refused("frontlux recording, format 5", "ends in its first line");
  expect_refused("frontlux recording, format 5\n", "ends before the run began");
  expect_refused("frontlux recording, format 1\nanything",
                 "is a recording of format 1, and this program reads formats 3 to 5");
  expect_refused("frontlux recording, format 12\n",
                 "reads formats 3 to 5; read it with the frontlux that wrote it");
  expect_refused("frontlux recording, format x\n", "is not a recording");
  expect_refused("frontlux recording, format 99999999999999999999\n", "is not a recording");
  expect_refused("# Octomap OcTree file\nid OcTree\n", "is not a recording");
  record(2, 4, true);
  const std::string whole = bytes();
  expect_refused(whole + "x", "goes on after its end");
  expect_refused(whole.substr(0, 29) + whole.substr(29) + whole.substr(29), "goes on after its end");
  const auto sizes = record(2, 4, false);
  const std::string running = bytes();
  expect_refused(running + running.substr(29), "second head");
  expect_refused(running.substr(0, 29) + running.substr(sizes[0]), "has no head");
  expect_refused(running.substr(0, sizes[0]) + running.substr(sizes[1]), "has another number");
  expect_refused(running + "nonsense", "damaged at byte " + std::to_string(running.size()));
  const auto refuses = [](const auto& call, const std::string& part) {
    test::expect_complaint<std::runtime_error>(call, {part});
  };
  refuses([&] { static_cast<void>(read_recording(folder_)); }, "is a directory");
  refuses([&] { static_cast<void>(read_recording(folder_ / "no")); }, "no such file");
  refuses([&] { RecordingWriter(folder_ / "no" / "x", head_); }, "No such file");
}

}  // namespace
}  // namespace frontlux::planner
