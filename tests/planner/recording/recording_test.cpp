#include "planner/recording/recorded_run.hpp"

#include <cstdio>

namespace frontlux::planner {
namespace {

using test::listed;
using test::Random;
using RecordingTest = test::RecordedRun;

TEST_F(RecordingTest, ReadsWhatWasWritten) {
  for (const int size : {0, 5, 300, 20'000}) {
    record(4, size, true);
    const Recording recording = read_recording(file_);
    expect_steps(recording, 4);
    EXPECT_EQ(recording.end, "low_gain");
    EXPECT_FALSE(recording.truncated);
  }
}

// Readers take the options for a JSON object, also of who has none.
TEST_F(RecordingTest, OptionsAreAnObject) {
  RecordingWriter(file_, RecordingHead{});
  EXPECT_EQ(read_recording(file_).head.options, "{}");
}

TEST_F(RecordingTest, AnyNumberOfRobots) {
  for (const int robots : {0, 1, 5}) {
    Random random(3);
    const RecordingHead head = test::random_head(random, robots);
    const RecordedStep step = test::random_step(random, head, 0, 20);
    RecordingWriter(file_, head).write(step);
    const Recording recording = read_recording(file_);
    EXPECT_EQ(listed(recording.head), listed(head));
    ASSERT_EQ(recording.steps.size(), 1U);
    EXPECT_EQ(listed(recording.steps[0]), listed(step));
    EXPECT_EQ(recording.end, std::nullopt);
  }
}

TEST_F(RecordingTest, FirstLineSaysWhatItIs) {
  record(0, 0, false);
  EXPECT_TRUE(bytes().starts_with("frontlux recording, format 5\n"));
}

TEST_F(RecordingTest, ImpossibleValuesAreNeitherWrittenNorRead) {
  record(0, 0, false);
  Random random(11);
  const RecordedStep good = test::random_step(random, head_, 0, 30);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [&](const std::string& part, const auto& change) {
    RecordedStep bad = good;
    change(bad);
    const std::string kept = bytes();
    test::expect_complaint([&] { RecordingWriter(file_, read_recording(file_)).write(bad); }, {part});
    EXPECT_EQ(bytes(), kept);
  };
  refuses("has another number", [](RecordedStep& s) { s.step.number = 1; });
  refuses("as many robots", [](RecordedStep& s) { s.step.robots.pop_back(); });
  refuses("one number for each robot", [](RecordedStep& s) { s.known.pop_back(); });
  refuses("more voxels than can be known",
          [&](RecordedStep& s) { s.known[1].observable = head_.observable; });
  refuses("robot 1: it reached more viewpoints",
          [](RecordedStep& s) { s.step.robots[1].travelled = s.step.robots[1].planned.size() + 1; });
  refuses("a pose is not finite", [&](RecordedStep& s) {
    s.step.robots[0].planned.resize(s.step.robots[0].planned.size() + 1);
    s.step.robots[0].planned.back().yaw = nan;
  });
  refuses("no length", [&](RecordedStep& s) { s.step.robots[0].length = -1; });
  refuses("no finite time", [&](RecordedStep& s) { s.step.seconds[2] = nan; });
  for (const double time : {nan, -1.0})
    refuses("a step ends at no finite time", [&](RecordedStep& s) { s.step.time = time; });
  refuses("outcome of the path search is 7",
          [](RecordedStep& s) { s.step.robots[0].path = static_cast<PathOutcome>(7); });
  refuses("there is a goal, but", [](RecordedStep& s) {
    s.step.robots[0].goal.state = GoalState::kAssigned;
    s.step.robots[0].goal.pose.reset();
  });
  refuses("unassigned", [](RecordedStep& s) { s.step.unassigned = s.step.frontiers + 1; });
  refuses("changes to what it is", [&](RecordedStep& s) {
    s.step.robots[0].changed = {{head_.bounds.min, {}, {}}};
  });
  refuses("outside the bounds", [](RecordedStep& s) {
    s.step.robots[0].changed = {{{0, 0, 0}, Occupancy::kUnknown, Occupancy::kFree}};
  });
  refuses("not sorted by key", [&](RecordedStep& s) {
    s.step.robots[0].changed = {{head_.bounds.max, Occupancy::kUnknown, Occupancy::kFree},
                                {head_.bounds.min, Occupancy::kUnknown, Occupancy::kFree}};
  });
  refuses("each voxel once", [&](RecordedStep& s) {
    s.step.robots[0].changed = {{head_.bounds.max, Occupancy::kUnknown, Occupancy::kFree},
                                {head_.bounds.max, Occupancy::kFree, Occupancy::kOccupied}};
  });
  refuses("voxels still unknown are not sorted", [](RecordedStep& s) {
    s.step.robots[0].still_unknown = {{1, 0, 0}, {0, 9, 9}};
  });
  refuses("rendered cell is not finite", [&](RecordedStep& s) {
    s.step.robots[0].image = {{{}, 0, 0, 0, std::numeric_limits<double>::infinity(), 0, 0}};
  });
  const auto refuses_head = [&](const std::string& part, const auto& change) {
    RecordingHead bad = head_;
    change(bad);
    test::expect_complaint([&] { RecordingWriter(folder_ / "other", bad); }, {part});
  };
  refuses_head("the resolution", [&](RecordingHead& head) { head.resolution = nan; });
  refuses_head("robot 1: the margin",
               [&](RecordingHead& head) { head.robots[1].robot.travel.margin = -0.1; });
  for (const double limit : {nan, 0.0, -1.0}) {
    refuses_head("robot 0: a limit of the motion",
                 [&](RecordingHead& head) { head.robots[0].robot.limits.speed = limit; });
    refuses_head("robot 0: a limit of the motion",
                 [&](RecordingHead& head) { head.robots[0].robot.limits.yaw_rate = limit; });
    refuses_head("robot 1: scans have no", [&](RecordingHead& head) { head.robots[1].rate = limit; });
  }
  refuses_head("more than 16 MiB", [&](RecordingHead& head) { head.options.assign((1U << 24U) + 1, ' '); });
  refuses_head("more than 1,000 robots", [&](RecordingHead& head) {
    head.robots.resize(1001, head.robots[0]);
    head.starts.resize(1001);
  });
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other")) << "nothing is created for a wrong head";
}

TEST_F(RecordingTest, GoesOnAfterTheLastFinishedStep) {
  const auto sizes = record(5, 40, true);
  const std::string whole = bytes();
  for (const std::size_t length : {sizes[0], sizes[2], sizes[2] + 9, sizes[5] - 1, whole.size()}) {
    save(whole.substr(0, length));
    const Recording recording = read_recording(file_);
    {
      RecordingWriter writer(file_, recording);
      EXPECT_EQ(bytes().size(), recording.bytes);
      EXPECT_EQ(read_recording(file_).end, std::nullopt);
      for (std::size_t i = recording.steps.size(); i < steps_.size(); ++i) writer.write(steps_[i]);
      writer.write_end("low_gain");
    }
    EXPECT_EQ(bytes(), whole) << "the same as that of an unbroken run";
  }
}

TEST_F(RecordingTest, OneWriterAtATime) {
  record(1, 4, false);
  const Recording recording = read_recording(file_);
  const std::string before = bytes();
  RecordingWriter writer(file_, recording);
  EXPECT_THROW(RecordingWriter(file_, recording), std::runtime_error);
  EXPECT_THROW(RecordingWriter(file_, head_), std::runtime_error);
  EXPECT_EQ(bytes(), before);
}

TEST_F(RecordingTest, WrongOrderOfCalls) {
  record(1, 4, false);
  RecordingWriter writer(file_, read_recording(file_));
  EXPECT_REFUSED(writer.write_end("No Reason!"));
  writer.write_end("stopped");
  EXPECT_REFUSED(writer.write_end("stopped"));
  EXPECT_REFUSED(writer.write(steps_[0]));
  RecordingWriter other = std::move(writer);
  EXPECT_EQ(read_recording(file_).end, "stopped");
}

#ifdef FRONTLUX_PYTHON
TEST_F(RecordingTest, PythonExampleReadsIt) {
  const auto sizes = record(3, 30, true);
  const auto read = [&](int expected_code) {
    const std::string command = std::string(FRONTLUX_PYTHON) + " " + FRONTLUX_DATA_DIR +
                                "/../docs/examples/read_recording.py " + file_.string() + " 2>&1";
    FILE* const pipe = popen(command.c_str(), "r");
    std::string said;
    for (int c = 0; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) said += static_cast<char>(c);
    EXPECT_EQ(WEXITSTATUS(pclose(pipe)), expected_code) << said;
    return said;
  };
  const std::string said = read(0);
  std::ostringstream expected;
  for (const RecordedStep& recorded : steps_) {
    const auto& step = recorded.step;
    char time[64];
    std::snprintf(time, sizeof time, "%.1f", step.time);
    expected << "step " << step.number << " until " << time << " s: " << step.frontiers << " frontiers";
    for (std::size_t i = 0; i < step.robots.size(); ++i) {
      std::array<std::size_t, 3> after{};
      for (const VoxelChange& change : step.robots[i].changed)
        ++after[static_cast<std::size_t>(change.after)];
      char length[64];
      std::snprintf(length, sizeof length, "%.2f", step.robots[i].length);
      expected << "; robot " << i << ": " << length << " m, " << step.robots[i].planned.size()
               << " viewpoints, " << after[1] << " voxels free, " << after[2] << " occupied, knows "
               << recorded.known[i].observable << ", tour of " << step.robots[i].tour.size()
               << " stops, trajectory of " << step.robots[i].trajectory.size() << " poses";
    }
    expected << "\n";
  }
  const std::string steps = expected.str();
  EXPECT_EQ(said, steps + "end: low_gain\n");

  // Cut off, and filled with zeros: at the begin of the end's record, in its header and in its bytes.
  const std::string whole = bytes();
  for (const std::size_t cut : {sizes[3], sizes[3] + 3, sizes[3] + 18})
    for (const std::size_t zeros : {0, 1, 5000}) {
      save(whole.substr(0, cut) + std::string(zeros, '\0'));
      EXPECT_EQ(read(0), steps) << cut << " and " << zeros;
    }
  std::string damaged = whole;
  damaged.replace(sizes[1] + 20, 4, 4, '\0');
  save(damaged);
  EXPECT_TRUE(read(1).ends_with(": damaged before byte " + std::to_string(sizes[2]) + "\n"));
}
#endif

}  // namespace
}  // namespace frontlux::planner
