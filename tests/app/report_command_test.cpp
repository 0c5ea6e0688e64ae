#include "report/explored_run.hpp"
#include "support/command_test.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

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
  [[nodiscard]] Answer run(const std::vector<std::string>& words) const {
    return CommandTest::run(words, in_folder_);
  }
  void expect_refused(const std::vector<std::string>& words, const std::string& part) const {
    CommandTest::expect_refused(words, std::vector<std::string>{part}, in_folder_);
  }

  std::string in_folder_ = "cd " + test::quoted(folder_.string()) + " &&";
};

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8U | static_cast<unsigned char>(bytes.at(at + i));
  return number;
}

TEST_F(ReportCommandTest, WritesBesideTheRecording) {
  const Answer answer = run({"one"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.out, "one/report.html\n");
  const std::string page = content_of(folder_ / "one" / "report.html");
  EXPECT_NE(page.find("<title>one - frontlux</title>"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "one" / "coverage.png"));
}

TEST_F(ReportCommandTest, PutsSeveralRunsInOneReport) {
  const Answer answer = run({"one", "two/run.frontlux", "-o", "both.html"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(content_of(folder_ / "both.html").find("<title>one, two - frontlux</title>"), std::string::npos);
  expect_refused({"one", "two"}, "--output");
}

TEST_F(ReportCommandTest, MakesStills) {
  const Answer answer = run({"one", "--png"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  for (const char* name : {"final_map.png", "coverage.png"}) {
    const std::string picture = content_of(folder_ / "one" / name);
    ASSERT_GT(picture.size(), 1000U) << name;
    EXPECT_EQ(picture.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_GE(big_endian(picture, 16), 700U) << "wide";
    EXPECT_GE(big_endian(picture, 20), 400U) << "high";
  }
  EXPECT_NE(answer.out.find("final_map.png"), std::string::npos);
}

TEST_F(ReportCommandTest, RefusesWhatIsNoRun) {
  std::filesystem::create_directories(folder_ / "empty");
  std::ofstream(folder_ / "foreign.frontlux") << "something else entirely";
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
  const Answer answer = run({"one"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.err.find("the last step is not complete"), std::string::npos) << answer.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "one" / "report.html"));
  std::filesystem::resize_file(file, 20);
  expect_refused({"one"}, "run.frontlux");
}

TEST_F(ReportCommandTest, RefusesADamagedRecording) {
  const auto file = folder_ / "two" / "run.frontlux";
  std::string bytes = content_of(file);
  bytes[bytes.size() / 3] = static_cast<char>(bytes[bytes.size() / 3] ^ 0x10);
  std::ofstream(file, std::ios::binary) << bytes;
  expect_refused({"two"}, "run.frontlux");
}

}  // namespace
}  // namespace frontlux::report
