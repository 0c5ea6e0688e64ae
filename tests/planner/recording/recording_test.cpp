#include "planner/recording/random_recording.hpp"
#include "recording/packed_record.hpp"
#include "recording/recording_format.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/random.hpp"

#include <frontlux/planner/recording.hpp>

#include <sys/resource.h>

#include <csignal>
#include <cstdio>

namespace frontlux::planner {
namespace {

using test::complaint_of;
using test::listed;
using test::Random;

class RecordingTest : public test::FolderTest {
 protected:
  [[nodiscard]] std::string bytes() const { return test::content_of(file_); }
  void save(const std::string& bytes) const { write("run.frontlux", bytes); }

  // What reading says when it refuses the file; empty if it does not.
  std::string complaint(const std::string& content) const {
    save(content);
    const std::string said =
        complaint_of<std::runtime_error>([&] { static_cast<void>(read_recording(file_)); });
    EXPECT_TRUE(said.empty() || said.starts_with(file_.string() + ": ")) << said;
    return said;
  }
  void expect_refused(const std::string& content, const std::string& part) const {
    test::expect_parts(complaint(content), {part});
  }

  // A run in a file; returns its size after the head and after each step.
  std::vector<std::size_t> record(int steps, int size, bool end) {
    Random random(7);
    head_ = test::random_head(random, 2);
    steps_.clear();
    RecordingWriter writer(file_, head_);
    std::vector<std::size_t> sizes = {bytes().size()};
    for (int i = 0; i < steps; ++i) {
      steps_.push_back(test::random_step(random, head_, static_cast<std::uint64_t>(i), size));
      writer.write(steps_.back());
      sizes.push_back(bytes().size());
    }
    if (end) writer.write_end("low_gain");
    return sizes;
  }

  void expect_steps(const Recording& recording, std::size_t count) const {
    EXPECT_EQ(listed(recording.head), listed(head_));
    ASSERT_EQ(recording.steps.size(), count);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(listed(recording.steps[i]), listed(steps_[i])) << i;
  }

  std::filesystem::path file_ = folder_ / "run.frontlux";
  RecordingHead head_;
  std::vector<RecordedStep> steps_;
};

TEST_F(RecordingTest, ReadsWhatWasWritten) {
  for (const int size : {0, 5, 300, 20'000}) {
    record(4, size, true);
    const Recording recording = read_recording(file_);
    expect_steps(recording, 4);
    EXPECT_EQ(recording.end, "low_gain");
    EXPECT_FALSE(recording.truncated);
  }
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

// format_3.frontlux: frontlux explore room --seed 1 --max-steps 6 --resolution 1, before there were tours.
TEST_F(RecordingTest, ReadsAndGoesOnWithTheFormatWithoutTours) {
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
TEST_F(RecordingTest, ReadsAndGoesOnWithTheFormatWithoutPlans) {
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

TEST_F(RecordingTest, EveryTruncationIsAPrefix) {
  const auto sizes = record(3, 6, true);
  const std::string whole = bytes();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    SCOPED_TRACE(length);
    const std::string part = whole.substr(0, length);
    if (length < sizes[0]) {
      EXPECT_NE(complaint(part), "");
      continue;
    }
    save(part);
    const Recording recording = read_recording(file_);
    std::size_t count = 0;
    while (count + 1 < sizes.size() && sizes[count + 1] <= length) ++count;
    expect_steps(recording, count);
    EXPECT_EQ(recording.bytes, sizes[count]);
    EXPECT_EQ(recording.truncated, length != sizes[count]);
    EXPECT_EQ(recording.end, std::nullopt);
  }
}

TEST_F(RecordingTest, EveryFlippedByteIsFound) {
  record(2, 4, true);
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const int mask : {0x01, 0x10, 0x80, 0xFF}) {
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ mask);
      const std::string said = complaint(flipped);
      ASSERT_NE(said, "") << "byte " << at << ", mask " << mask;
      const bool in_title = at < std::string("frontlux recording, format 5\n").size();
      // As format 4 the file can be begun to be read.
      const bool other_format = flipped.starts_with("frontlux recording, format 4\n");
      ASSERT_EQ(said.find("damaged at byte ") == std::string::npos, in_title && !other_format) << said;
    }
}

TEST_F(RecordingTest, FlippedBytesOfAnUnfinishedTail) {
  const auto sizes = record(3, 4, false);
  const std::string cut = bytes().substr(0, sizes[3] - 7);
  for (std::size_t at = 0; at < cut.size(); ++at) {
    std::string flipped = cut;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x21);
    const std::string said = complaint(flipped);
    if (at < sizes[2]) {
      ASSERT_NE(said, "") << at;
    } else if (said.empty()) {
      const Recording recording = read_recording(file_);
      EXPECT_TRUE(recording.truncated);
      expect_steps(recording, 2);
    }
  }
}

TEST_F(RecordingTest, ZerosAtTheEndAreAnUnfinishedStep) {
  const auto sizes = record(2, 4, false);
  save(bytes() + std::string(5000, '\0'));
  const Recording recording = read_recording(file_);
  EXPECT_TRUE(recording.truncated);
  EXPECT_EQ(recording.bytes, sizes[2]);
  expect_steps(recording, 2);
}

// Damage that the checksums do not show, as somebody hostile would make it.
TEST_F(RecordingTest, EveryChangedByteOfAStepIsHarmless) {
  const auto sizes = record(1, 6, false);
  const std::string before = bytes().substr(0, sizes[0]);
  const std::string plain = detail::step_bytes(steps_[0], head_, 0);
  int refused = 0, read = 0;
  for (std::size_t at = 0; at < plain.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      std::string changed = plain;
      changed[at] = static_cast<char>(value);
      complaint(before + detail::packed_record("step", changed)).empty() ? ++read : ++refused;
    }
    EXPECT_NE(complaint(before + detail::packed_record("step", plain.substr(0, at))), "");
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 100);
  expect_refused(before + detail::packed_record("step", plain + "x"), "1 bytes too many");
}

TEST_F(RecordingTest, AnnouncedSizesAllocateNothing) {
  record(0, 0, false);
  const std::string before = bytes();
  // A list of 2^60 robots' known voxels.
  const std::string first = std::string(6, '\0') + std::string(56, '\0');
  expect_refused(before + detail::packed_record("step", first + "\x80\x80\x80\x80\x80\x80\x80\x80\x10"),
                 "a list is longer than what is there");
  // A gigabyte of zeros would compress to a megabyte: announced in a record of a few bytes.
  std::string bomb = detail::packed_record("step", std::string(1000, '\0'));
  bomb[8] = bomb[9] = bomb[10] = '\xFF';
  expect_refused(before + bomb, "fail their checksum");
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

TEST_F(RecordingTest, FullDiskIsNamed) {
  Random random(1);
  head_ = test::random_head(random, 1);
  std::filesystem::create_symlink("/dev/full", file_);
  const std::string said = complaint_of<std::runtime_error>([&] { RecordingWriter(file_, head_); });
  EXPECT_TRUE(said.starts_with(file_.string() + ": cannot be written: disk full")) << said;
}

// Lets files grow to a size only, as a disk with so much room does.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(RecordingTest, AFailedWriteLeavesTheStepsBefore) {
  const auto sizes = record(3, 50, false);
  const std::string whole = bytes();
  save(whole.substr(0, sizes[1]));
  RecordingWriter writer(file_, read_recording(file_));
  {
    const FileSizeLimit limit(sizes[2] - 10);
    test::expect_complaint<std::runtime_error>([&] { writer.write(steps_[1]); }, {"cannot be written"});
    EXPECT_EQ(bytes(), whole.substr(0, sizes[1]));
  }
  writer.write(steps_[1]);
  writer.write(steps_[2]);
  EXPECT_EQ(bytes(), whole) << "it goes on when there is room again";
}

TEST_F(RecordingTest, ForeignFiles) {
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

#ifdef FRONTLUX_PYTHON
TEST_F(RecordingTest, PythonExampleReadsIt) {
  record(3, 30, true);
  const std::string command = std::string(FRONTLUX_PYTHON) + " " + FRONTLUX_DATA_DIR +
                              "/../docs/examples/read_recording.py " + file_.string() + " 2>&1";
  FILE* const pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string said;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) said += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0);

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
  expected << "end: low_gain\n";
  EXPECT_EQ(said, expected.str());
}
#endif

}  // namespace
}  // namespace frontlux::planner
