#include "support/command_test.hpp"

namespace frontlux::app {
namespace {

class HelpCommand : public test::CommandTest {
 protected:
  HelpCommand() : CommandTest("") {}
};

TEST_F(HelpCommand, HelpTeaches) {
  expect_answer({"--help"}, {"info", "cast", "Examples:", "Exit codes"});
  expect_answer({"info", "--help"}, {"Example", "frontlux info building.bt"});
  expect_answer({"cast", "--help"}, {"Example", "frontlux cast building.bt --from", "--unknown block|pass",
                                     "[block]", "(required)"});
  expect_answer({"explore", "--help"}, {"Stopping:", "Random seed (built-in layout, draws, noise) [1]"});
  EXPECT_EQ(expect_answer({"-V"}), expect_answer({"--version"}, {"frontlux "}));
}

TEST_F(HelpCommand, ShowsHowOftenAnArgumentStands) {
  expect_answer({"help", "report"}, {"Usage: frontlux report [OPTIONS] RUN...\n"});
  expect_answer({"help", "explore"}, {"Usage: frontlux explore [OPTIONS] [WORLD]\n"});
  expect_answer({"help", "info"}, {"Usage: frontlux info [OPTIONS] MAP\n"});
  expect_answer({"--manual", path("manual")});
  test::expect_parts(test::content_of(path("manual/man1/frontlux-report.1")), {"\\fIRUN...\\fR"});
}

// Forgotten or empty names, as scripts give them.
TEST_F(HelpCommand, SaysWhatToNameInTheirPlace) {
  const std::string folder = folder_.string();
  for (const std::vector<std::string>& words :
       {std::vector{std::string("world"), folder}, {"explore", folder}, {"scan", folder, "-o", path("x.bt")}})
    expect_refused(words, {"is a directory; name a built-in world"});
  expect_refused({"report", ""}, {"'': there is no such folder or recording; check the path"});
  expect_refused({"explore", ""}, {"WORLD: give the world to explore"});
  const std::string map = (std::filesystem::path(FRONTLUX_DATA_DIR) / "maps/room_0.1m.bt").string();
  const std::vector<std::pair<std::string, std::vector<std::string>>> empty = {
      {"--resume: '' names no folder", {"explore", "--resume", ""}},
      {"--output: '' names no folder", {"explore", "room", "-o", ""}},
      {"--task: '' names no file", {"explore", "--task", "", "-o", path("run")}},
      {"--robot: '' names no file", {"explore", "room", "--robot", "", "-o", path("run")}},
      {"--poses: '' names no file", {"scan", "room", "--poses", "", "-o", path("x.bt")}},
      {"--output: '' names no file", {"world", "room", "-o", ""}},
      {"--output: '' names no file",
       {"plan", map, "--robot", "uav", "--from", "0,0,1.5,0", "--to", "1,0,1.5", "-o", ""}},
      {"--output: '' names no file", {"report", folder, "-o", ""}},
      {"--manual: '' names no folder", {"--manual", ""}}};
  for (const auto& [part, words] : empty) expect_refused(words, {part});
  // The word behind is no value.
  expect_refused({"explore", "room", "--goal=", "--quiet"}, {"--goal: ''"});
}

// A result that nobody gets is none.
TEST_F(HelpCommand, FailsWhenStandardOutputIsClosed) {
  const std::string map = test::quoted(
                        (std::filesystem::path(FRONTLUX_DATA_DIR) / "maps/room_0.1m.bt").string()),
                    run = test::quoted(path("run"));
  for (const std::string& words :
       {"info " + map, "info --json " + map, std::string("world"), std::string("--help"),
        std::string("--version"), "explore room --lockstep --max-steps 1 --report off --json -o " + run}) {
    const std::string command =
        test::quoted(FRONTLUX_COMMAND) + " " + words + " >&- 2>" + test::quoted(path("err"));
    EXPECT_EQ(test::exit_code(std::system(command.c_str())), 1) << words;
    const std::string said = test::content_of(path("err"));
    EXPECT_TRUE(said.ends_with("frontlux: standard output is closed\n")) << said;
  }
}

// As in `frontlux ... | true`. The result of an exploration is in its folder.
TEST_F(HelpCommand, OutputThatNobodyReadsStopsNoExploration) {
  const std::string run = path("run"), command = test::quoted(FRONTLUX_COMMAND);
  const auto code_of = [&](const std::string& words) {
    const std::string piped = "{ sleep 0.2; " + command + " " + words + " 2>/dev/null; echo $? > " +
                              test::quoted(path("code")) + "; } | true";
    EXPECT_EQ(std::system(piped.c_str()), 0);
    return test::content_of(path("code"));
  };
  EXPECT_EQ(code_of("world maze"), "1\n");
  EXPECT_EQ(code_of("explore room --lockstep --max-steps 1 --report off -o " + test::quoted(run)), "0\n");
  EXPECT_TRUE(std::filesystem::exists(run + "/run.json"));
}

TEST_F(HelpCommand, HelpIsACommandToo) {
  EXPECT_EQ(expect_answer({"help"}), expect_answer({"--help"}, {"help COMMAND"}));
  EXPECT_EQ(expect_answer({"help", "cast"}), expect_answer({"cast", "--help"}));
  expect_refused({"help", "cats"}, {"unknown command 'cats' (did you mean cast?); see frontlux --help"});
}

TEST_F(HelpCommand, RareOptionsAreInHelpAll) {
  const std::string help = expect_answer({"explore", "--help"}, {"--help-all", "--team"});
  const std::string all =
      expect_answer({"explore", "--help-all"}, {"--team", "--epsilon", "--lambda", "--up"});
  for (const char* rare : {"--epsilon", "--lambda", "--up"})
    EXPECT_EQ(help.find(rare), std::string::npos) << rare;
  EXPECT_LT(std::ranges::count(help, '\n'), 60);
  expect_answer({"--help-all"}, {"--lambda", "--direction"});
}

// What --help-all lists is in the man page and is completed.
TEST_F(HelpCommand, TheManualIsThatOfTheOptions) {
  ASSERT_EQ(expect_answer({"--manual", path("manual")}), "");
  const std::string completion = test::content_of(path("manual/completions/frontlux"));
  const std::string overview = test::content_of(path("manual/man1/frontlux.1"));
  int options = 0;
  for (const std::string command :
       {"info", "cast", "world", "scan", "map", "plan", "render", "explore", "report"}) {
    SCOPED_TRACE(command);
    EXPECT_NE(overview.find("frontlux\\-" + command + " (1)"), std::string::npos);
    const std::string page = test::content_of(path("manual/man1/frontlux-" + command + ".1"));
    EXPECT_TRUE(page.starts_with(".TH frontlux\\-" + command + " 1 "));
    const std::size_t choices = completion.find("    " + command + ":-*) ");
    ASSERT_NE(choices, std::string::npos);
    const std::string completed = completion.substr(choices, completion.find('\n', choices) - choices);
    std::istringstream lines(expect_answer({command, "--help-all"}));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find("--");
      if (!line.starts_with("  -") || at == std::string::npos) continue;
      const std::string name = line.substr(at, line.find(' ', at) - at);
      std::string escaped;
      for (const char c : name) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
      EXPECT_NE(page.find("\\fB" + escaped + "\\fR"), std::string::npos) << name;
      EXPECT_NE(completed.find(name), std::string::npos) << name;
      ++options;
    }
  }
  EXPECT_GT(options, 100);
  const auto commands = std::distance(std::filesystem::directory_iterator(path("manual/man1")), {});
  EXPECT_EQ(commands, 10) << "a command is not in this test";
  expect_refused({"--manual", write("file", "")}, {"--manual: "});
}

TEST_F(HelpCommand, BashCompletesCommandsOptionsAndValues) {
  expect_answer({"--manual", path("manual")});
  const auto completed = [&](const std::string& words) {
    const std::string script = "source '" + path("manual/completions/frontlux") + "'; COMP_WORDS=(" + words +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _frontlux; echo ${COMPREPLY[@]}";
    EXPECT_EQ(
        std::system(("cd '" + folder_.string() + "' && bash -c " + test::quoted(script) + " >said").c_str()),
        0);
    const std::string said = test::content_of(path("said"));
    return said.substr(0, said.find('\n'));
  };
  EXPECT_EQ(completed("frontlux ex"), "explore");
  EXPECT_EQ(completed("frontlux help re"), "render report");
  EXPECT_EQ(completed("frontlux --ver"), "--version");
  EXPECT_EQ(completed("frontlux explore --stop-"), "--stop-coverage --stop-time");
  EXPECT_EQ(completed("frontlux explore room --goal n"), "nearest");
  EXPECT_EQ(completed("frontlux explore --seed ''"), "");
  EXPECT_EQ(completed("frontlux explore --ground ''"), "auto off");
  EXPECT_EQ(completed("frontlux explore st"), "station storage");
  EXPECT_EQ(completed("frontlux explore --resume man"), "manual");
  write("mine.bt", "");
  EXPECT_EQ(completed("frontlux info mi"), "mine.bt");
}

}  // namespace
}  // namespace frontlux::app
