// The folder of a run: nothing but the run gets into it, and what is said of it is true.

#include "app/explore_command.hpp"

#include <frontlux/planner/recording.hpp>

#include <sys/file.h>
#include <sys/stat.h>

#include <csignal>
#include <fcntl.h>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::content_of;
using test::expect_parts;
using test::kSteps;

class RunFolder : public test::ExploreCommand {
 protected:
  // A run that goes on for a while.
  [[nodiscard]] std::vector<std::string> long_run(const std::string& output) const {
    return {"storage", "--lockstep", "--max-steps", "6", "--report", "off", "-o", path(output)};
  }
  // Waits for one that was started, which says so.
  std::string complaint_of(pid_t child) const {
    EXPECT_EQ(test::exit_code(test::status_of(child)), 2);
    return content_of(path("err"));
  }
};

TEST_F(RunFolder, HoldsNothingThatWasMeantForAClosedStream) {
  expect_explored("open");
  for (const char* closed : {"exec 0<&-;", "exec 1>&-;", "exec 2>&-;", "exec 0<&- 1>&- 2>&-;"}) {
    SCOPED_TRACE(closed);
    fs::remove_all(path("closed"));
    const std::string command = std::string("exec >/dev/null 2>&1;") + closed + " exec " +
                                test::quoted(FRONTLUX_COMMAND) + " explore room --lockstep --max-steps " +
                                kSteps + " --report off -o " + test::quoted(path("closed"));
    EXPECT_EQ(test::exit_code(std::system(command.c_str())), 0);
    expect_same_runs("open", "closed");
  }
}

TEST_F(RunFolder, IsNotTakenFromARunInProgress) {
  ASSERT_EQ(run(long_run("whole")).code, 0);
  const pid_t child = start_and_wait(long_run("run"), 1);
  fs::create_directory(path("second"));
  for (const auto& words : {std::vector<std::string>{"room", "--force", "-o", path("run")},
                            std::vector<std::string>{"--resume", path("run")}}) {
    const Answer answer = test::run_frontlux(test::joined({"explore"}, words), path("second"));
    EXPECT_EQ(answer.code, 2);
    expect_parts(answer.err, {path("run/run.frontlux") + ": ", "another process"});  // writes it, or has just
    EXPECT_EQ(answer.err.find("are kept"), std::string::npos) << answer.err;
  }
  EXPECT_EQ(test::exit_code(test::status_of(child)), 0) << content_of(path("err"));
  expect_same_runs("whole", "run");
}

TEST_F(RunFolder, IsMissedWhenItIsGone) {
  const auto recording = [&] { return path("run/run.frontlux"); };
  const std::vector<std::pair<std::function<void()>, std::string>> losses = {
      {[&] { fs::remove_all(path("run")); }, "no step of the run is left there"},
      {[&] { fs::remove(recording()); }, "no step of the run is left there"},
      {[&] { fs::rename(path("run"), path("moved")); }, "no step of the run is left there"},
      {[&] {
         fs::remove_all(path("run"));
         fs::create_directory(path("run"));
       },
       "no step of the run is left there"},
      {[&] { fs::resize_file(recording(), fs::file_size(recording()) / 2); }, "frontlux explore --resume"},
      {[&] { fs::resize_file(recording(), 3); }, "no step of the run is left there"},
      {[&] {
         fs::copy_file(recording(), path("copy"));
         fs::rename(path("copy"), recording());
       },
       "frontlux explore --resume"}};
  for (const auto& [lose, kept] : losses) {
    fs::remove_all(path("run"));
    fs::remove_all(path("moved"));
    const pid_t child = start_and_wait(long_run("run"), 1);
    lose();
    const std::string said = complaint_of(child);
    expect_parts(said, {path("run/run.frontlux") + ": was ", kept});
    const bool resumable = kept.starts_with("frontlux");
    EXPECT_EQ(said.find("continues the run") != std::string::npos, resumable) << said;
    if (resumable) expect_resumed("run");
  }
}

// A damage within the recording does not stop the run, but nobody is told to resume it.
TEST_F(RunFolder, SaysThatTheRecordingIsDamaged) {
  for (const bool is_longer : {false, true}) {
    fs::remove_all(path("run"));
    const pid_t child = start_and_wait(
        {"storage", "--lockstep", "--max-steps", "60", "--report", "off", "-o", path("run")}, 2);
    const int file = ::open(path("run/run.frontlux").c_str(), O_WRONLY | O_CLOEXEC);
    ASSERT_GE(file, 0);
    const auto size = static_cast<off_t>(fs::file_size(path("run/run.frontlux")));
    EXPECT_EQ(::pwrite(file, "damage", 6, is_longer ? size : size / 2), 6);
    ::close(file);
    kill(child, SIGTERM);
    EXPECT_EQ(test::exit_code(test::status_of(child)), is_longer ? 2 : 130) << "what is too long is noticed";
    const std::string said = content_of(path("err"));
    expect_parts(said, {path("run/run.frontlux") + " is damaged: the run cannot be continued"});
    EXPECT_EQ(said.find("--resume"), std::string::npos) << said;
  }
}

// Nobody is told to resume what cannot be written. Root may write anything, so the command runs as nobody
// then.
TEST_F(RunFolder, SaysThatTheRecordingIsReadOnly) {
  fs::permissions(folder_, fs::perms::all);
  const std::string recording = path("run/run.frontlux");
  const pid_t child = start_and_wait(long_run("run"), 1, test::kNobody);
  const int file = ::open(recording.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) {
    EXPECT_EQ(test::exit_code(test::status_of(child)), test::kCannotBe);
    GTEST_SKIP() << "cannot be another user here";
  }
  fs::permissions(recording, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  EXPECT_EQ(ftruncate(file, static_cast<off_t>(fs::file_size(recording) / 2)), 0);
  ::close(file);
  const std::string said = complaint_of(child);
  expect_parts(said, {recording + ": was ", "kept, but " + recording + " is read-only: make it writable"});
  EXPECT_EQ(said.find("--resume"), std::string::npos) << said;

  const std::vector<std::string> resume = {FRONTLUX_COMMAND, "explore",  "--report", "off",
                                           "--resume",       path("run")};
  expect_parts(complaint_of(test::start(resume, folder_, test::kNobody)), {recording, "permission"});
  fs::permissions(recording, fs::perms::owner_all);
  expect_resumed("run");
}

// That is known before the recorded steps are repeated.
TEST_F(RunFolder, IsNotResumedWhereNothingCanBeWritten) {
  fs::permissions(folder_, fs::perms::all);
  expect_explored("run");
  const auto writing = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  fs::permissions(path("run"), fs::perms::all & ~writing);
  const pid_t child =
      test::start({FRONTLUX_COMMAND, "explore", "--resume", path("run")}, folder_, test::kNobody);
  const int code = test::exit_code(test::status_of(child));
  fs::permissions(path("run"), fs::perms::owner_all);
  if (code == test::kCannotBe) GTEST_SKIP() << "cannot be another user here";
  EXPECT_EQ(code, 2);
  expect_parts(content_of(path("err")), {"--resume: " + path("run") + " cannot be written to; check its"});
  EXPECT_EQ(content_of(path("out")).find("repeated"), std::string::npos);
}

// A run that was killed before its first record leaves nothing to go on with, and nothing in the way.
TEST_F(RunFolder, BeginsAnewWhereARunHadNotBegun) {
  expect_explored("whole");
  const std::string bytes = content_of(path("whole/run.frontlux"));
  expect_refused({"--resume", path("run")}, {"--resume: there is no folder " + path("run"), "begin"});
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{40}}) {
    fs::remove_all(path("run"));
    fs::create_directory(path("run"));
    expect_refused({"--resume", path("run")}, {"--resume: ", "had not begun", "begin it anew"});
    write("run/run.frontlux", bytes.substr(0, size));
    expect_refused({"--resume", path("run")}, {"--resume: ", "before the run began", "begin it anew"});
    expect_explored("run");
    expect_same_runs("whole", "run");
  }
}

// What links in the folder point to, as another run's recording, stays as it is.
TEST_F(RunFolder, ReplacesLinksAndNotWhatTheyPointTo) {
  expect_explored("other");
  const std::string recording = content_of(path("other/run.frontlux"));
  fs::create_directory(path("run"));
  fs::create_symlink("../other/run.frontlux", path("run/run.frontlux"));
  expect_explored("run", {"--force"});
  EXPECT_TRUE(content_of(path("other/run.frontlux")) == recording);
  EXPECT_FALSE(fs::is_symlink(path("run/run.frontlux")));
  expect_same_runs("other", "run");
  // A run that goes on begins its tables anew.
  write("mine", "precious");
  for (const char* table : {"steps.csv", "paths.csv", "events.csv", "motion.csv", "tours.csv"}) {
    fs::remove(path("run") + "/" + table);
    fs::create_symlink("../mine", path("run") + "/" + table);
  }
  expect_resumed("run");
  EXPECT_EQ(content_of(path("mine")), "precious");
  expect_same_runs("other", "run");
}

// Neither a new run nor one that goes on stands beside pictures of what was before.
TEST_F(RunFolder, LosesTheViewsOfAnOlderState) {
  const std::vector<std::string> views = {"final_map.png",        "coverage.svg", "video.mp4",
                                          "video/frame_0001.png", "video.gif",    "report.html"};
  const auto show = [&] {
    fs::create_directories(path("run/video"));
    for (const std::string& view : views) write("run/" + view, "old");
    write("run/coverage.txt", "mine");
    write("run/video/mine", "mine");
  };
  const auto expect_shown = [&](bool there) {
    for (const std::string& view : views) EXPECT_EQ(fs::exists(path("run/" + view)), there) << view;
    EXPECT_EQ(content_of(path("run/coverage.txt")), "mine");
    EXPECT_EQ(content_of(path("run/video/mine")), "mine");
  };
  expect_explored("run");
  show();
  expect_resumed("run");
  expect_shown(true);  // nothing was added
  expect_resumed("run", {"--max-steps", "5"});
  expect_shown(false);
  show();
  expect_explored("run", {"--force"});
  expect_shown(false);
  // A folder of frames alone goes with them.
  show();
  fs::remove(path("run/video/mine"));
  expect_explored("run", {"--force"});
  EXPECT_FALSE(fs::exists(path("run/video")));
  // A file of that name is none of frontlux's, nor is what a link points to.
  write("run/video", "mine");
  fs::create_directories(path("other"));
  write("other/frame_0001.png", "mine");
  fs::create_directory_symlink(path("other"), path("run/video.unfinished"));
  expect_explored("run", {"--force"});
  EXPECT_EQ(content_of(path("run/video")), "mine");
  EXPECT_EQ(content_of(path("other/frame_0001.png")), "mine");
}

TEST_F(RunFolder, LosesWhatKilledRunsLeftUnfinished) {
  expect_explored("run");
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  test::status_of(gone);
  const std::string dead = ".part-frontlux-" + std::to_string(gone) + "-0",
                    alive = ".part-frontlux-" + std::to_string(getpid()) + "-0";
  const int locked =
      open(write("run/map.bt" + alive, "another process still writes it").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(locked, LOCK_EX | LOCK_NB), 0);
  write("run/map.ot" + dead, "half a map");
  write("run/run.json" + dead, "half");
  write("run/map.ot.part" + std::to_string(gone), "mine, as `split` names it");
  expect_resumed("run");
  close(locked);
  EXPECT_FALSE(fs::exists(path("run/map.ot" + dead)));
  EXPECT_FALSE(fs::exists(path("run/run.json" + dead)));
  EXPECT_TRUE(fs::exists(path("run/map.bt" + alive)));
  EXPECT_TRUE(fs::exists(path("run/map.ot.part" + std::to_string(gone))));
}

TEST_F(RunFolder, IsFullAtALimitOfFileSizes) {
  expect_explored("whole");
  const auto size = fs::file_size(path("whole/run.frontlux"));
  const Answer answer = run({"room", "--lockstep", "--max-steps", kSteps, "-o", path("full")},
                            "ulimit -f " + std::to_string(size / 1024) + ";");
  EXPECT_EQ(answer.code, 2) << answer.err;
  expect_parts(answer.err, {path("full/run.frontlux") + ": cannot be written: disk full",
                            "frontlux explore --resume " + path("full") + " continues the run"});
  expect_resumed("full");
  expect_same_runs("whole", "full");
}

}  // namespace
}  // namespace frontlux::planner
