#include "report/explored_run.hpp"
#include "support/command_test.hpp"
#include "support/input_test.hpp"

#include <frontlux/planner/recording.hpp>

namespace frontlux::report {
namespace {

using test::Answer;
using test::content_of;

class ReportCommandTest : public test::CommandTest {
 protected:
  ReportCommandTest() : CommandTest("report") {
    for (const char* run : {"one", "two"}) {
      std::filesystem::create_directories(path(run));
      static const planner::Recording recording = test::explored_run("room", 4);
      planner::RecordingWriter writer(folder_ / run / "run.frontlux", recording.head);
      for (const auto& step : recording.steps) writer.write(step);
      writer.write_end("stopped");
    }
  }

  // In the folder, so that its files can be named as they are.
  std::string expect_answer(const std::vector<std::string>& words,
                            const std::vector<std::string>& parts = {}) const {
    return CommandTest::expect_answer(words, parts, in_folder_);
  }
  void expect_refused(const std::vector<std::string>& words, const std::string& part) const {
    CommandTest::expect_refused(words, std::vector<std::string>{part}, in_folder_);
  }

  // What comes before a command that finds this script as ffmpeg.
  std::string ffmpeg_that(const std::string& script) {
    std::filesystem::create_directories(path("bin"));
    write("bin/ffmpeg", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path("bin/ffmpeg"), std::filesystem::perms::owner_all);
    return in_folder_ + " PATH=" + test::quoted(path("bin")) + ":$PATH";
  }

  std::string in_folder_ = "cd " + test::quoted(folder_.string()) + " &&";
};

TEST_F(ReportCommandTest, WritesBesideTheRecording) {
  EXPECT_EQ(expect_answer({"one"}), "one/report.html\n");
  test::expect_parts(content_of(path("one/report.html")), {"<title>one - frontlux</title>"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "one" / "coverage.png"));
}

TEST_F(ReportCommandTest, PutsSeveralRunsInOneReport) {
  expect_answer({"one", "two/run.frontlux", "-o", "both.html"});
  test::expect_parts(content_of(path("both.html")), {"<title>one, two - frontlux</title>"});
  expect_refused({"one", "two"}, "--output");
}

TEST_F(ReportCommandTest, MakesStills) {
  expect_answer({"one", "--png"}, {"final_map.png"});
  for (const char* name : {"final_map.png", "coverage.png"}) {
    SCOPED_TRACE(name);
    test::expect_png(content_of(folder_ / "one" / name), 700, 400);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "one" / "coverage.svg"));
}

TEST_F(ReportCommandTest, MakesTheSameStillsInAllFormatsEachTime) {
  const std::vector<std::string> names = {"final_map.png", "final_map.svg", "final_map.pdf",
                                          "coverage.png",  "coverage.svg",  "coverage.pdf"};
  std::vector<std::string> first;
  expect_answer({"one", "--png", "--svg", "--pdf"}, names);
  for (const auto& name : names) first.push_back(content_of(folder_ / "one" / name));
  for (std::size_t i = 0; i < names.size(); ++i) {
    SCOPED_TRACE(names[i]);
    if (names[i].ends_with(".svg")) test::expect_parts(first[i], {"<svg xmlns=", "</svg>"});
    if (names[i].ends_with(".pdf")) {
      test::expect_parts(first[i], {"%PDF-1.", "DejaVuSans", "%%EOF"});
      EXPECT_EQ(first[i].find("/CreationDate (20000101"), first[i].rfind("/CreationDate"));
    }
  }
  expect_answer({"one", "--png", "--svg", "--pdf"});
  for (std::size_t i = 0; i < names.size(); ++i)
    EXPECT_TRUE(content_of(folder_ / "one" / names[i]) == first[i]) << names[i];
}

// A stand-in for ffmpeg is first on the path: one that does nothing, or one that makes a file of its last
// word.
TEST_F(ReportCommandTest, MakesAFilmWhereThereIsFfmpegAndElseItsFrames) {
  const std::string none = ffmpeg_that("exit 127");
  CommandTest::expect_answer({"one", "--video"}, {"one/video/\n"}, none);
  std::string first;
  for (const char* name : {"frame_0001.png", "frame_0090.png", "frame_0180.png", "frame_0210.png"}) {
    const std::string frame = content_of(folder_ / "one" / "video" / name);
    test::expect_png(frame, 700, 400);
    EXPECT_NE(frame, first) << name;
    if (first.empty()) first = frame;
  }
  EXPECT_EQ(content_of(path("one/video/frame_0180.png")), content_of(path("one/video/frame_0210.png")));
  EXPECT_FALSE(std::filesystem::exists(path("one/video/frame_0211.png")));
  CommandTest::expect_refused({"one", "--gif"}, {"--gif: needs ffmpeg"}, none);

  // All frames of a run that has no more than a start are one.
  planner::Recording recording = planner::read_recording(folder_ / "one" / "run.frontlux");
  planner::RecordingWriter(folder_ / "one" / "run.frontlux", recording.head).write(recording.steps[0]);
  const std::string there = ffmpeg_that("for last; do :; done; [ \"$last\" = - ] || echo \"$@\" > \"$last\"");
  write("one/video/mine", "a user's");
  write("one/video/frame_0001.png", "a user's, too");
  CommandTest::expect_answer({"one", "--video", "--gif"}, {"one/video.mp4\n", "one/video.gif\n"}, there);
  test::expect_parts(content_of(path("one/video.mp4")), {"libx264"});
  test::expect_parts(content_of(path("one/video.gif")), {"palettegen"});
  EXPECT_EQ(content_of(path("one/video/frame_0001.png")), "a user's, too");
  EXPECT_EQ(content_of(path("one/video/mine")), "a user's");
}

// In motion a planning more changes nothing, and a second more does; in lock-step it is the other way round.
TEST_F(ReportCommandTest, DrawsCoverageOverSecondsInMotionAndOverStepsInLockstep) {
  const planner::Recording recording = planner::read_recording(folder_ / "one" / "run.frontlux");
  const auto drawn = [&](bool lockstep, int twice, double seconds) {
    planner::RecordingHead head = recording.head;
    head.options = lockstep ? R"({"lockstep": true})" : R"({"lockstep": false})";
    planner::RecordingWriter writer(folder_ / "one" / "run.frontlux", head);
    std::uint64_t number = 0;
    for (const auto& step : recording.steps)
      for (int i = step.step.number == 2 ? -twice : 0; i <= 0; ++i) {
        planner::RecordedStep written = step;
        written.step.number = number++;
        written.step.time = step.step.time * seconds;
        writer.write(written);
      }
    expect_answer({"one", "--png"});
    return content_of(folder_ / "one" / "coverage.png");
  };
  const std::string motion = drawn(false, 0, 1.0), steps = drawn(true, 0, 1.0);
  EXPECT_TRUE(motion != steps);
  EXPECT_TRUE(drawn(false, 1, 1.0) == motion);
  EXPECT_TRUE(drawn(false, 0, 3.0) != motion);
  EXPECT_TRUE(drawn(true, 1, 1.0) != steps);
  EXPECT_TRUE(drawn(true, 0, 3.0) == steps);
  // Without a clock, or with an endless one.
  EXPECT_TRUE(drawn(false, 0, 0.0) == steps);
  test::expect_png(drawn(false, 0, 1e290), 700, 400);
  test::expect_png(content_of(folder_ / "one" / "final_map.png"), 700, 400);
}

TEST_F(ReportCommandTest, RefusesWhatIsNoRun) {
  std::filesystem::create_directories(folder_ / "empty");
  write("foreign.frontlux", "something else entirely");
  expect_refused({"nowhere"}, "nowhere");
  expect_refused({"empty"}, "run.frontlux");
  expect_refused({"foreign.frontlux"}, "foreign.frontlux");
  expect_refused({"one", "-o", "report.pdf"}, "does not end in .html");
  expect_refused({"one", "-o", "nowhere/report.html"}, "nowhere");
  expect_refused({}, "RUN");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "one" / "report.html"));
}

TEST_F(ReportCommandTest, ShowsWhatIsLeftOfATruncatedRecording) {
  const auto file = folder_ / "one" / "run.frontlux";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) * 3 / 4);
  const Answer answer = CommandTest::run({"one"}, in_folder_);
  EXPECT_EQ(answer.code, 0) << answer.err;
  test::expect_parts(answer.err, {"the last step is not complete"});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "one" / "report.html"));
  std::filesystem::resize_file(file, 20);
  expect_refused({"one"}, "run.frontlux");
}

// All of them, before the recording is read; here it is damaged.
TEST_F(ReportCommandTest, RefusesOutputsBeforeItReadsTheRecording) {
  write("one/run.frontlux", "damaged");
  for (const auto& [blocked, option] : std::vector<std::pair<std::string, std::string>>{
           {"final_map.png", "--png"}, {"coverage.svg", "--svg"}, {"video.mp4", "--video"}}) {
    std::filesystem::create_directories(path("one/" + blocked + "/mine"));
    expect_refused({"one", option}, option + ": one/" + blocked + " is a folder");
  }
  write("one/video", "a user's");
  std::filesystem::remove_all(path("one/video.mp4"));
  CommandTest::expect_refused({"one", "--video"},
                              {"--video: one/video/frame_0001.png cannot be written: there is no folder"},
                              ffmpeg_that("exit 127"));
  std::filesystem::create_directories(path("one/report.html"));
  expect_refused({"one"}, "--output: one/report.html is a folder");
  std::filesystem::copy_file(path("two/run.frontlux"), path("run.html"));
  expect_refused({"run.html", "-o", "run.html"}, "is what is read");
}

TEST_F(ReportCommandTest, SaysWhatIsWrongWithRunJson) {
  const std::string good = R"({"world": "room", "robots": ["ugv", "uav"], "end": "stopped", "steps": 3, )"
                           R"("by_robot": {"ugv": {"idle_s": 1.5}, "uav": {}}, "clearance_min_m": 0.25})";
  const auto warning = [&](const std::string& json) {
    write("one/run.json", json);
    const Answer answer = CommandTest::run({"one"}, in_folder_);
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.out, "one/report.html\n");
    return answer.err;
  };
  EXPECT_EQ(warning(good), "");
  for (const auto& [from, to, what] : std::vector<std::array<std::string, 3>>{
           {good, "", ""},
           {good, "{\"end\": ", "is damaged: it holds no JSON object"},
           {"0.25", "\"0.25\"", "is damaged: a clearance"},
           {"1.5", "[]", "is damaged: a clearance"},
           {"\"stopped\"", "\"step_limit\"", "does not fit the recording: end is not \"stopped\""},
           {"\"steps\": 3", "\"steps\": 4", "does not fit the recording: steps is not 3"},
           {"\"room\"", "\"maze\"", "does not fit the recording: world is not \"room\""},
           {"0.25", "0.25, \"coverage_observable\": 0.5",
            "does not fit the recording: coverage_observable is not"},
           {"\"uav\"]", "\"car\"]", "does not fit the recording: robots is not"}}) {
    const std::string said = warning(test::replaced(good, from, to));
    if (what.empty())
      EXPECT_EQ(said, "");
    else
      test::expect_parts(said, {"frontlux: warning: one/run.json " + what, "leaves out"});
  }
  std::filesystem::remove(path("one/run.json"));
  std::filesystem::create_directory(path("one/run.json"));
  test::expect_parts(CommandTest::run({"one"}, in_folder_).err, {"warning: one/run.json: is a directory"});
}

TEST_F(ReportCommandTest, RefusesPicturesOfTwoRunsInOneFolder) {
  std::filesystem::copy_file(path("two/run.frontlux"), path("one/two.frontlux"));
  for (const char* picture : {"--png", "--svg", "--pdf", "--video"})
    expect_refused({"one/run.frontlux", "one/two.frontlux", "-o", "all.html", picture}, "are in one folder");
  expect_answer({"one/run.frontlux", "one/two.frontlux", "-o", "all.html"});
}

TEST_F(ReportCommandTest, SendsNoCommandsToTheTerminal) {
  const std::string name = "\x1B[31m\x07";
  std::filesystem::copy_file(path("one/run.frontlux"), path(name + ".frontlux"));
  std::filesystem::resize_file(path(name + ".frontlux"), 20);
  const std::string said = CommandTest::run({name + ".frontlux"}, in_folder_).err;
  EXPECT_NE(said.find("?[31m?"), std::string::npos) << said;
  EXPECT_EQ(said.find('\x07'), std::string::npos);
}

TEST_F(ReportCommandTest, LeavesNoFramesWhenStopped) {
  const pid_t child = test::start({FRONTLUX_COMMAND, "report", path("one"), "--video"}, folder_);
  ASSERT_GT(child, 0);
  const auto frames = [&] {  // in a folder that they are kept in, or not
    for (const auto& entry : std::filesystem::directory_iterator(path("one")))
      if (entry.path().filename().string().starts_with("video")) return entry.path();
    return std::filesystem::path();
  };
  for (int i = 0; i < 6000 && !std::filesystem::exists(frames() / "frame_0002.png"); ++i) usleep(5000);
  kill(child, SIGINT);
  EXPECT_EQ(test::exit_code(test::status_of(child)), 130);
  test::expect_parts(content_of(path("err")), {"stopped; no film was written"});
  EXPECT_EQ(frames(), std::filesystem::path());
  EXPECT_TRUE(std::filesystem::exists(path("one/report.html")));
}

TEST_F(ReportCommandTest, RefusesADamagedRecording) {
  const auto file = folder_ / "two" / "run.frontlux";
  std::string bytes = content_of(file);
  bytes[bytes.size() / 3] = static_cast<char>(bytes[bytes.size() / 3] ^ 0x10);
  write("two/run.frontlux", bytes);
  expect_refused({"two"}, "run.frontlux");
}

}  // namespace
}  // namespace frontlux::report
