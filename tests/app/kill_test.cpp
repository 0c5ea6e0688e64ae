// Commands that are killed at any moment, or whose disk is full, leave what was there as it was.

#include "app/explore_motion.hpp"
#include "support/random.hpp"

#include <frontlux/planner/recording.hpp>

#include <csignal>

namespace frontlux::test {
namespace {

struct Moment {
  int kills = 0;  // that happened, and not after the command's end
  Random random{22};
};

class KilledCommand : public ExploreMotion {
 protected:
  // Starts a command and stops it as soon as it writes a file, wherever in the folder, or when it is done.
  // @return whether it was stopped
  bool stop_while_it_writes(const std::vector<std::string>& words, int signal) const {
    const pid_t child = start(joined({FRONTLUX_COMMAND}, words), folder_);
    const auto writes = [&] {
      for (const auto& entry : fs::directory_iterator(folder_))
        if (entry.path().string().find(".part") != std::string::npos) return true;
      return false;
    };
    siginfo_t ended{};
    while (!writes() && waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0)
      ;
    kill(child, signal);
    const int code = exit_code(status_of(child));
    EXPECT_TRUE(code == 0 || code == 130) << code;
    if (code == 130) {
      EXPECT_EQ(content_of(path("err")), "frontlux: stopped\n");
    }
    EXPECT_FALSE(writes()) << "a part is left";
    return code == 130;
  }

  // Starts a command and kills it at a random moment of the time that it takes.
  void kill_once(const std::vector<std::string>& words, std::chrono::duration<double> whole,
                 Moment& moment) const {
    const pid_t child = start(joined({FRONTLUX_COMMAND}, words), folder_);
    std::this_thread::sleep_for(whole * (moment.random.below(1000) / 1000.0));
    kill(child, SIGKILL);
    moment.kills += WIFSIGNALED(status_of(child)) ? 1 : 0;
  }

  [[nodiscard]] Answer frontlux(const std::vector<std::string>& words, const std::string& before = "") const {
    return run_frontlux(words, folder_, before);
  }
  std::chrono::duration<double> expect_done(const std::vector<std::string>& words) const {
    const auto begin = std::chrono::steady_clock::now();
    const Answer answer = frontlux(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return std::chrono::steady_clock::now() - begin;
  }

  // A run that is killed again and again comes to the same end.
  void expect_runs_survive(int runs) const {
    const std::vector<std::string> lockstep = {"explore", "room", "--lockstep", "--max-steps", kSteps},
                                   moving = {"explore", "room", "--stop-time", "6"};
    const auto to = [&](const std::vector<std::string>& words, const char* folder) {
      return joined(words, {"--report", "off", "-o", path(folder)});
    };
    expect_done(to(lockstep, "lockstep"));
    expect_done(to(moving, "moving"));
    Moment moment;
    for (int i = 0; i < runs; ++i) {
      SCOPED_TRACE(i);
      const std::string whole = i % 2 == 0 ? "lockstep" : "moving";
      const std::vector<std::string> begin = to(whole == "lockstep" ? lockstep : moving, "run"),
                                     go_on = {"explore", "--resume", path("run"), "--report", "off"};
      fs::remove_all(path("run"));
      const auto part = [&] { return moment.random.uniform(-0.2, 1.0); };  // below 0: as soon as it starts
      kill_at(begin, whole, part(), moment);
      // The second time it is a resumed run that is killed, unless there is nothing to resume.
      for (const bool last : {false, true}) {
        const bool begun = content_of(path("run/run.frontlux")).size() > 200;
        if (!last)
          kill_at(begun ? go_on : begin, whole, part(), moment);
        else if (const Answer resumed = frontlux(go_on); resumed.code != 0) {
          expect_parts(resumed.err, {"begin"});
          expect_done(begin);
        }
      }
      expect_same_runs(whole, "run");
      for (const auto& entry : fs::directory_iterator(path("run")))
        EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
      if (HasFailure()) return;
    }
    EXPECT_GT(moment.kills, runs / 2);
  }

  // Kills a run when this part of its recording is written, or soon after.
  // @param whole  folder of the same run, not killed
  void kill_at(const std::vector<std::string>& words, const std::string& whole, double part,
               Moment& moment) const {
    const auto enough = part * static_cast<double>(fs::file_size(path(whole + "/run.frontlux")));
    const pid_t child = start(joined({FRONTLUX_COMMAND}, words), folder_);
    siginfo_t ended{};
    std::error_code error;
    const auto written = [&] {
      const auto size = fs::file_size(path("run/run.frontlux"), error);
      return error ? 0.0 : static_cast<double>(size);
    };
    while (written() < enough &&
           waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, SIGKILL);
    moment.kills += WIFSIGNALED(status_of(child)) ? 1 : 0;
  }

  // A run in motion, on one thread and on two, that is killed at so many moments from its begin to its end.
  // @param explore  the words, without threads and folder
  void expect_motions_survive(const std::vector<std::string>& explore, int kills) const {
    const auto begin = [&](const char* folder, const char* threads) {
      return joined(explore, {"--report", "off", "--threads", threads, "-o", path(folder)});
    };
    const auto go_on = [&](const char* threads) {
      return std::vector<std::string>{"explore", "--report", "off",      "--threads",
                                      threads,   "--resume", path("run")};
    };
    const auto part = [&](int i) { return static_cast<double>(i + 1) / kills; };
    expect_done(begin("whole", "2"));
    Moment moment;
    // Again and again the same run, by other threads than before.
    for (int i = 0; i < kills; ++i)
      kill_at(i == 0 ? begin("run", "1") : go_on(i % 2 == 0 ? "1" : "2"), "whole", part(i), moment);
    expect_done(go_on("1"));
    expect_same_motions("whole", "run");
    EXPECT_GE(moment.kills, kills / 2) << "the others came after its end";
    if (kills < 10) return;
    // Each time a new run.
    moment.kills = 0;
    const std::array<std::pair<const char*, const char*>, 4> threads = {
        {{"1", "1"}, {"2", "2"}, {"1", "2"}, {"2", "1"}}};
    for (const auto& [first, second] : threads)
      for (int i = 0; i < kills && !HasFailure(); ++i) {
        SCOPED_TRACE(std::string(first) + " and " + second + " threads, killed at " +
                     std::to_string(part(i)));
        fs::remove_all(path("run"));
        kill_at(begin("run", first), "whole", part(i), moment);
        expect_done(go_on(second));
        expect_same_motions("whole", "run");
      }
    EXPECT_GE(moment.kills, std::ssize(threads) * kills / 2);
  }

  // The commands that write one file, and two versions of each.
  void expect_files_survive(int kills) const {
    expect_done({"explore", "room", "--lockstep", "--max-steps", "1", "--report", "off", "-o", path("run")});
    const planner::Recording run = planner::read_recording(path("run/run.frontlux"));
    const auto word = [&](std::size_t robot, bool at_end) {
      const Eigen::Vector3d& at = at_end ? run.steps.back().step.robots.at(robot).planned.back().position
                                         : run.head.starts.at(robot).pose.position;
      std::ostringstream text;
      text << at.x() << ',' << at.y() << ',' << at.z();
      return text.str();
    };
    const std::string map = path("run/map.bt");
    const std::vector<std::pair<std::string, std::array<std::vector<std::string>, 2>>> commands = {
        {"scan.bt", {{{"scan", "room", "-o"}, {"scan", "room", "--robot", "uav", "-o"}}}},
        {"view.png",
         {{{"render", map, "--robot", "ugv", "--at", word(0, false), "-o"},
           {"render", map, "--robot", "uav", "--at", word(1, false), "-o"}}}},
        {"path.csv",
         {{{"plan", map, "--robot", "ugv", "--from", word(0, false) + ",0", "--to", word(0, true), "-o"},
           {"plan", map, "--robot", "uav", "--from", word(1, false) + ",0", "--to", word(1, true), "-o"}}}},
        {"page.html", {{{"report", path("run"), "-o"}, {"report", path("run"), path("run"), "-o"}}}}};
    Moment moment;
    for (const auto& [name, words] : commands) {
      SCOPED_TRACE(name);
      const std::string file = path(name);
      std::array<std::string, 2> versions;
      std::chrono::duration<double> time{};
      for (const std::size_t v : {1U, 0U}) {
        time = expect_done(joined(words[v], {file}));
        versions[v] = content_of(file);
      }
      ASSERT_NE(versions[0], versions[1]);
      for (int i = 0; i < kills; ++i) {
        kill_once(joined(words[1], {file}), time, moment);
        const std::string now = content_of(file);
        ASSERT_TRUE(now == versions[0] || now == versions[1]) << now.size();
      }
      expect_done(joined(words[0], {file}));
      const Answer full = frontlux(joined(words[1], {file}), "ulimit -f 0;");
      EXPECT_NE(full.code, 0);
      EXPECT_EQ(content_of(file), versions[0]) << "a full disk";
    }
    for (const auto& entry : fs::directory_iterator(folder_))
      EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  }
};

TEST_F(KilledCommand, LeavesARunThatGoesOn) { expect_runs_survive(5); }
TEST_F(KilledCommand, LeavesARunInMotionThatGoesOn) {
  expect_motions_survive(joined({"explore"}, quick("4")), 3);
}
TEST_F(KilledCommand, LeavesEarlierFilesIntact) { expect_files_survive(2); }
TEST_F(KilledCommand, LeavesNoPartOfAFileWhenItIsStopped) {
  expect_explored("run");
  int stopped = 0;
  for (int i = 0; i < 5; ++i)
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"world", "factory", "-o", path("factory.ply")},
          {"report", path("run"), "-o", path("page.html")}})
      stopped += stop_while_it_writes(words, i % 2 == 0 ? SIGTERM : SIGINT) ? 1 : 0;
  EXPECT_GT(stopped, 0);
}
TEST_F(KilledCommand, LongLeavesARunThatGoesOn) { expect_runs_survive(50); }
TEST_F(KilledCommand, LongLeavesARunInMotionThatGoesOn) { expect_motions_survive({"explore", "room"}, 10); }
TEST_F(KilledCommand, LongLeavesEarlierFilesIntact) { expect_files_survive(50); }

}  // namespace
}  // namespace frontlux::test
