// Commands that are killed at any moment, or whose disk is full, leave what was there as it was.

#include "app/explore_motion.hpp"
#include "support/random.hpp"

#include <frontlux/planner/recording.hpp>

#include <sys/inotify.h>

#include <array>
#include <csignal>
#include <poll.h>
#include <sched.h>
#include <string_view>
#include <unistd.h>

namespace frontlux::test {
namespace {

constexpr std::string_view kPart = ".part-frontlux-";  // in the names of unfinished files

struct Moment {
  int kills = 0;  // that happened, and not after the command's end
  Random random{22};
};

class KilledCommand : public ExploreMotion {
 protected:
  // The unfinished files in the folder.
  [[nodiscard]] std::vector<fs::path> parts() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().string().find(kPart) != std::string::npos) all.push_back(entry.path());
    return all;
  }

  // Starts a command and sends it a signal as soon as it has written a part of a file in the folder, or when
  // it is done. On one core, so that it does not go on before the signal is sent: it writes for less than a
  // millisecond. @return its status
  int signal_while_it_writes(const std::vector<std::string>& words, int signal) const {
    cpu_set_t all, one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    EXPECT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    EXPECT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    const int news = inotify_init1(IN_CLOEXEC);
    EXPECT_GE(inotify_add_watch(news, folder_.c_str(), IN_MODIFY), 0);
    const pid_t child = start(joined({FRONTLUX_COMMAND}, words), folder_);
    siginfo_t ended{};
    pollfd wait{news, POLLIN, 0};
    while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0) {
      std::array<char, 4096> names{};
      if (poll(&wait, 1, 10) > 0 && read(news, names.data(), names.size()) > 0 &&
          std::string_view(names.data(), names.size()).find(kPart) != std::string_view::npos)
        break;
    }
    kill(child, signal);
    close(news);
    EXPECT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
    return status_of(child);
  }

  // @return whether it was stopped
  bool stop_while_it_writes(const std::vector<std::string>& words, int signal) const {
    const int code = exit_code(signal_while_it_writes(words, signal));
    EXPECT_TRUE(code == 0 || code == 130) << code;
    if (code == 130) {
      EXPECT_EQ(content_of(path("err")), "frontlux: stopped\n");
    }
    EXPECT_TRUE(parts().empty()) << "a part is left";
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
                                   moving = joined({"explore"}, quick("6"));
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

  // A run whose disk is full, and full again when it goes on, comes to the same end once there is room.
  // @param explore  the words, without the folder
  // @param files    of the run: the disk has room for two thirds of each
  void expect_survives_full_disks(const std::vector<std::string>& explore,
                                  const std::vector<std::string>& files) const {
    const auto begin = [&](const char* folder) {
      return joined(explore, {"--report", "off", "-o", path(folder)});
    };
    const std::vector<std::string> go_on = {"explore", "--report", "off", "--resume", path("run")};
    const std::string recording = path("run/run.frontlux");
    expect_done(begin("whole"));
    for (const std::string& file : files) {
      SCOPED_TRACE(file);
      constexpr std::uintmax_t kBlock = 512;  // [bytes]
      const std::string limit =
          "ulimit -f " + std::to_string(fs::file_size(path("whole/" + file)) * 2 / 3 / kBlock) + ";";
      const auto expect_full = [&](const std::vector<std::string>& words) {
        const Answer full = frontlux(words, limit);
        EXPECT_EQ(full.code, 2) << full.err;
        expect_parts(full.err,
                     {": cannot be written: ", "frontlux explore --resume " + path("run") + " continues"});
      };
      fs::remove_all(path("run"));
      expect_full(begin("run"));
      const std::string kept = content_of(recording);
      EXPECT_GE(planner::read_recording(recording).steps.size(), 1U);
      expect_full(go_on);
      EXPECT_TRUE(content_of(recording).starts_with(kept));
      expect_done(go_on);
      expect_same_runs("whole", "run");
    }
  }

  // The commands that write one file, where there is an earlier one.
  // @param kills  of each command at random moments, beside those while it writes
  void expect_files_survive(int kills) const {
    constexpr int kTries = 30;
    const std::string earlier = "an earlier file";
    expect_done({"explore", "room", "--lockstep", "--max-steps", "1", "--report", "off", "-o", path("run")});
    const planner::Recording run = planner::read_recording(path("run/run.frontlux"));
    const auto word = [](const Eigen::Vector3d& at) {
      std::ostringstream text;
      text << at.x() << ',' << at.y() << ',' << at.z();
      return text.str();
    };
    const std::string map = path("run/map.bt"), from = word(run.head.starts.at(1).pose.position),
                      to = word(run.steps.back().step.robots.at(1).planned.back().position);
    const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
        {"scan.bt", {"scan", "room", "--robot", "uav", "-o"}},
        {"view.png", {"render", map, "--robot", "uav", "--at", from, "-o"}},
        {"path.csv", {"plan", map, "--robot", "uav", "--from", from + ",0", "--to", to, "-o"}},
        {"page.html", {"report", path("run"), "-o"}}};
    for (const auto& [name, words] : commands) {
      SCOPED_TRACE(name);
      Moment moment;
      const std::string file = path(name);
      const std::vector<std::string> command = joined(words, {file});
      const std::chrono::duration<double> time = expect_done(command);
      const std::string whole = content_of(file);
      ASSERT_GT(whole.size(), earlier.size());
      const auto begin_anew = [&] {
        write(name, earlier);
        for (const fs::path& part : parts()) fs::remove(part);
      };
      for (int i = 0; i < kills; ++i) {
        begin_anew();
        kill_once(command, time, moment);
        const std::string now = content_of(file);
        ASSERT_TRUE(now == earlier || now == whole) << now.size();
      }
      if (kills >= 10) {  // of two both may come late
        EXPECT_GE(moment.kills, kills / 2) << "the others came after its end";
      }
      // The kill comes too late where the file has got its name already.
      bool is_left = false;
      for (int i = 0; i < kTries && !is_left; ++i) {
        begin_anew();
        signal_while_it_writes(command, SIGKILL);
        is_left = !parts().empty();
        const std::string now = content_of(file);
        ASSERT_TRUE(now == earlier || (!is_left && now == whole)) << now.size();
      }
      EXPECT_TRUE(is_left) << "never killed while it wrote";
      const Answer full = frontlux(command, "ulimit -f 0;");
      EXPECT_EQ(full.code, 2);
      EXPECT_EQ(content_of(file), earlier) << "a full disk";
      EXPECT_TRUE(parts().empty()) << "what the killed one left goes with the next one";
    }
  }
};

TEST_F(KilledCommand, LeavesARunThatGoesOn) { expect_runs_survive(5); }
TEST_F(KilledCommand, LeavesARunInMotionThatGoesOn) {
  expect_motions_survive(joined({"explore"}, quick("4")), 3);
}
TEST_F(KilledCommand, GoesOnAfterAFullDisk) {
  expect_survives_full_disks({"explore", "room", "--lockstep", "--max-steps", kSteps}, {"run.frontlux"});
}
TEST_F(KilledCommand, GoesOnInMotionAfterAFullDisk) {
  expect_survives_full_disks(joined({"explore"}, quick("4")), {"run.frontlux", "motion.csv"});
  expect_same_motions("whole", "run");
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
