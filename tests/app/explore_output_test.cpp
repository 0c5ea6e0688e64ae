// What `frontlux explore` prints while it goes and in the end: on a terminal, elsewhere, and as JSON.

#include "app/explore_command.hpp"

#include <sys/ioctl.h>

#include <cerrno>
#include <pty.h>
#include <regex>
#include <unistd.h>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::expect_parts;
using test::ExploreCommand;

class ExploreOutput : public ExploreCommand {
 protected:
  static std::vector<std::string> room(const std::vector<std::string>& more) {
    return test::joined({"room", "--lockstep", "--max-steps", test::kSteps, "--report", "off"}, more);
  }

  // What the command prints on a terminal.
  [[nodiscard]] std::string on_terminal(const std::vector<std::string>& words, int expected_code) const {
    int terminal = -1;
    winsize size{.ws_row = 25, .ws_col = 70, .ws_xpixel = 0, .ws_ypixel = 0};
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0) _exit(127);
      unsetenv("NO_COLOR");
      std::vector<std::string> all = test::joined({FRONTLUX_COMMAND, "explore"}, words);
      std::vector<char*> argv;
      for (std::string& word : all) argv.push_back(word.data());
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(127);
    }
    std::string said;
    std::array<char, 4096> part;
    for (ssize_t read;
         (read = ::read(terminal, part.data(), part.size())) > 0 || (read < 0 && errno == EINTR);)
      if (read > 0) said.append(part.data(), static_cast<std::size_t>(read));
    close(terminal);
    EXPECT_EQ(test::exit_code(test::status_of(child)), expected_code) << said;
    return said;
  }
};

TEST_F(ExploreOutput, ElsewhereItIsLinesAndTheReportIsNamed) {
  const std::string said =
      expect_answer({"room", "--lockstep", "--max-steps", test::kSteps, "-o", path("run")},
                    {"exploring into " + path("run") + "; Ctrl-C ends", "step 0: mapped ", "step 4: mapped ",
                     "end          step_limit: ", "report       " + path("run/report.html") + "\n"});
  EXPECT_EQ(said.find('\r'), std::string::npos);
  EXPECT_EQ(said.find('\033'), std::string::npos);
}

TEST_F(ExploreOutput, OnATerminalTheProgressStaysInItsLine) {
  const std::string said = on_terminal(room({"-o", "run"}), 0);
  expect_parts(said,
               {"exploring into run", "\rrun: mapped ", "step 2; 0:0",
                "\rrun: the run has ended, its results are being made; 0:0", "end          step_limit: "});
  EXPECT_EQ(said.find("step 2: mapped"), std::string::npos) << "there are lines as well";
  for (std::size_t at = 0; (at = said.find("\rrun: ", at)) != std::string::npos; ++at)
    EXPECT_LT(said.find("\033[K", at) - at, 71U) << "the line is longer than the terminal's";
  EXPECT_EQ(said.find("\033[31m"), std::string::npos) << "a run that ended well is told in red";
}

TEST_F(ExploreOutput, ARunThatEndedBadlyIsRed) {
  const std::string said = on_terminal({"room", "--epsilon", "100000", "--report", "off", "-o", "run"}, 0);
  expect_parts(said, {"\033[31mend          nothing_to_do: ", "\033[31mwarning: the run has ended with "});
}

TEST_F(ExploreOutput, QuietPrintsNothing) {
  EXPECT_EQ(expect_answer(room({"--quiet", "-o", path("run")})), "");
  EXPECT_TRUE(fs::exists(path("run/run.json")));
  EXPECT_EQ(expect_answer({"-q", "--report", "off", "--resume", path("run"), "--max-steps", "5"}), "");
}

TEST_F(ExploreOutput, JsonIsTheWholeOfStandardOutput) {
  const test::Answer answer = run(room({"--json", "-o", path("run")}));
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(std::ranges::count(answer.out, '\n'), 1);
  nlohmann::json result = nlohmann::json::parse(answer.out);
  EXPECT_EQ(result.at("folder"), path("run"));
  EXPECT_TRUE(result.at("report").is_null());
  result.erase("folder");
  result.erase("report");
  EXPECT_EQ(result, json_in("run"));
  expect_parts(answer.err, {"step 4: mapped "});
  const nlohmann::json with_report = nlohmann::json::parse(
      expect_answer({"--quiet", "--json", "--resume", path("run"), "--max-steps", "5"}));
  EXPECT_EQ(with_report.at("report"), path("run/report.html"));
  EXPECT_EQ(with_report.at("steps"), 5);
}

TEST_F(ExploreOutput, TheFolderIsNamedAfterWorldAndSeed) {
  const std::string there = "cd '" + folder_.string() + "';";
  expect_answer(room({"--seed", "7"}), {"exploring into runs/room-7;"}, there);
  EXPECT_EQ(json_in("runs/room-7").at("seed"), 7);
  expect_refused(room({"--seed", "7"}), {"--output: runs/room-7 is not empty", "--resume", "--force"}, there);
  expect_answer(room({"--seed", "8"}), {"exploring into runs/room-8;"}, there);
  expect_refused(room({"--seed", "9", "-o", ""}), {"--output: '' names no folder"}, there);
  EXPECT_FALSE(fs::exists(path("runs/room-9")));
}

TEST_F(ExploreOutput, ResumingTellsWhatItRepeats) {
  expect_answer({"room", "--lockstep", "--max-steps", "2", "--report", "off", "-o", path("run")});
  expect_answer({"--report", "off", "--resume", path("run"), "--max-steps", "3"},
                {"repeated 3 recorded steps, going on in " + path("run"), "step 3: mapped "});
  const std::string shown = on_terminal({"--report", "off", "--resume", "run", "--max-steps", "4"}, 0);
  expect_parts(shown, {"\rrun: repeated 2 of 4 recorded steps"});
  EXPECT_TRUE(std::regex_search(shown, std::regex("step 4; [0-9]+:[0-5][0-9] so far"))) << shown;
}

TEST_F(ExploreOutput, SigtermIsLikeCtrlC) {
  const pid_t child = start_and_wait(
      {"storage", "--lockstep", "--max-steps", "60", "--report", "off", "-o", path("stopped")}, 1);
  ASSERT_GT(child, 0);
  kill(child, SIGTERM);
  EXPECT_EQ(test::exit_code(test::status_of(child)), 130);
  expect_parts(content_of(path("err")),
               {"stopped; the recorded steps are kept: frontlux explore --resume " + path("stopped")});
  expect_parts(content_of(path("out")), {"end          stopped: by Ctrl-C or SIGTERM"});
  EXPECT_EQ(json_in("stopped").at("end"), "stopped");
}

// Before there is a step to report on.
TEST_F(ExploreOutput, CtrlCAtTheVeryBeginningIsOneLikeAnyOther) {
  bool without_steps = false;
  for (int i = 0; i < 60 && !without_steps; ++i) {
    const std::string output = path("early" + std::to_string(i));
    const pid_t child = test::start({FRONTLUX_COMMAND, "explore", "storage", "-o", output}, folder_);
    ASSERT_GT(child, 0);
    const auto begin = std::chrono::steady_clock::now();
    while (!std::filesystem::exists(output + "/run.frontlux") &&
           std::chrono::steady_clock::now() - begin < std::chrono::minutes(1)) {
    }
    kill(child, SIGINT);
    EXPECT_EQ(test::exit_code(test::status_of(child)), 130) << content_of(path("err"));
    expect_parts(content_of(path("err")), {"stopped; "});
    without_steps = content_of(path("err")).find("no step of the run") != std::string::npos;
    if (without_steps) {
      EXPECT_EQ(content_of(path("out")).find("report.html"), std::string::npos) << content_of(path("out"));
    }
  }
  EXPECT_TRUE(without_steps);
}

// Whoever presses it again wants to wait no more.
TEST_F(ExploreOutput, TheSecondCtrlCEndsAtOnce) {
  const pid_t child = start_and_wait({"station", "--lockstep", "--report", "off", "-o", path("stopped")}, 1);
  ASSERT_GT(child, 0);
  const auto wait = [](int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  };
  kill(child, SIGINT);
  kill(child, SIGTERM);  // with the first: as `timeout` sends its own to a program and its group
  wait(50);
  kill(child, SIGSTOP);  // before it is done
  wait(600);
  kill(child, SIGINT);
  kill(child, SIGCONT);
  EXPECT_EQ(test::exit_code(test::status_of(child)), 130);
  EXPECT_EQ(
      content_of(path("err")),
      "frontlux: stopped; what was recorded is kept, other files may be missing: frontlux explore --resume " +
          path("stopped") + " continues the run\n");
  EXPECT_FALSE(fs::exists(path("stopped/run.json")));
  EXPECT_GE(read_recording(path("stopped/run.frontlux")).steps.size(), 2U);
}

}  // namespace
}  // namespace frontlux::planner
