// `frontlux explore` gives the same result however it is run: on any number of threads, and resumed after
// every kind of end.

#include "app/explore_command.hpp"

#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <csignal>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::content_of;
using test::ExploreCommand;
using test::kSteps;
using test::timeless;

TEST_F(ExploreCommand, GivesTheSameResultHoweverItIsRun) {
  expect_explored("one", {"--threads", "1"});
  expect_explored("two", {"--threads", "2"});
  expect_same_runs("one", "two");
  expect_explored("grid", {"--caster", "grid"});
  expect_same_runs("one", "grid");
  // Stopped at a limit, and with another limit gone on.
  ASSERT_EQ(run({"room", "--lockstep", "--max-steps", "2", "-o", path("cut")}).code, 0);
  EXPECT_EQ(json_in("cut").at("steps"), 2);
  expect_resumed("cut", {"--max-steps", kSteps, "--threads", "1"});
  expect_same_runs("one", "cut");
  EXPECT_EQ(json_in("one").at("by_robot"), json_in("cut").at("by_robot"));
  // Going on at the end changes nothing.
  expect_resumed("two");
  expect_same_runs("one", "two");
  // Another seed is another run.
  expect_explored("other", {"--seed", "2"});
  EXPECT_NE(timeless(path("one/steps.csv")), timeless(path("other/steps.csv")));
  // In a folder that holds a run only if it is to go.
  EXPECT_EQ(explore("other").code, 2);
  expect_explored("other", {"--force"});
  expect_same_runs("one", "other");
}

TEST_F(ExploreCommand, KeepsALargerLimitThanItsOwnThatARunWentOnWith) {
  ASSERT_EQ(run({"room", "--lockstep", "--stop-time", "1", "--report", "off", "-o", path("long")}).code, 0);
  const auto limit = [&] { return json_in("long").at("max_steps"); };
  EXPECT_EQ(limit(), 1000);
  expect_resumed("long", {"--max-steps", "1500"});
  EXPECT_EQ(limit(), 1500);
  expect_resumed("long");
  EXPECT_EQ(limit(), 1500);
}

// With the same errors of its sensors, and with what their scans say.
TEST_F(ExploreCommand, GoesOnWithItsSensorModel) {
  const std::vector<std::string> words = test::joined(quick("whole", "6"), {"--noise", "0.02"});
  expect_answer(test::joined(words, {"--sensor-model", "cautious"}));
  EXPECT_EQ(json_in("whole").at("sensor_model"), "cautious");
  const std::string bytes = content_of(path("whole/run.frontlux"));
  fs::create_directory(path("cut"));
  write("cut/run.frontlux", bytes.substr(0, bytes.size() / 2));
  expect_resumed("cut");
  expect_same_runs("whole", "cut");
  const std::string map = content_of(path("whole/map.ot"));
  expect_answer(test::joined(words, {"--force"}));
  EXPECT_EQ(json_in("whole").at("sensor_model"), "octomap");
  EXPECT_FALSE(content_of(path("whole/map.ot")) == map);
}

TEST_F(ExploreCommand, GoesOnWithARecordingThatWasCutOffAnywhere) {
  expect_explored("whole");
  const std::string bytes = content_of(path("whole/run.frontlux"));
  for (const std::size_t cut : {bytes.size() - 1, bytes.size() / 2}) {
    SCOPED_TRACE("after " + std::to_string(cut) + " of " + std::to_string(bytes.size()) + " bytes");
    fs::remove_all(path("cut"));
    fs::create_directory(path("cut"));
    write("cut/run.frontlux", bytes.substr(0, cut));
    expect_resumed("cut");
    expect_same_runs("whole", "cut");
  }
}

// Poles thinner than the gaps between a sensor's rays, which robots only find when their bumpers meet them.
sim::TriangleMesh with_unseen_poles(sim::TriangleMesh mesh, const Eigen::Vector3d& start) {
  for (int column = 0; column < 8; ++column)
    for (int row = 0; row < 8; ++row) {
      const Eigen::Vector3f foot(0.5F + 1.5F * static_cast<float>(column),
                                 0.5F + 1.5F * static_cast<float>(row), 0.0F);
      if ((foot.cast<double>() - start).head<2>().norm() < 3.5) continue;
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const Eigen::Vector3f& corner : {Eigen::Vector3f(0, 0, 0), {1e-4F, 0, 0}, {0, 0, 3}})
        mesh.vertices.push_back(foot + corner);
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
  return mesh;
}

TEST_F(ExploreCommand, CountsBlockedPathsFromBeforeItWasResumed) {
  const sim::World room = sim::make_world("room", 1);
  sim::write_ply(path("poles.ply"), with_unseen_poles(room.mesh, *room.start));
  std::ostringstream at;
  at << room.start->x() << ',' << room.start->y() << ',' << room.start->z();
  for (const auto& [output, steps] : {std::pair("whole", "4"), std::pair("cut", "2")})
    expect_answer({path("poles.ply"), "--start", at.str(), "--ground", "off", "--lockstep", "--max-steps",
                   steps, "--report", "off", "-o", path(output)});
  const std::uint64_t before = json_in("cut").at("held_back");
  EXPECT_GT(before, 0U);
  EXPECT_GT(json_in("whole").at("held_back"), before);
  expect_resumed("cut", {"--max-steps", "4"});
  expect_same_runs("whole", "cut");
}

// Whether it was stopped in lock-step or in motion, or has ended.
TEST_F(ExploreCommand, RefusesALimitBelowTheRecordedSteps) {
  expect_explored("lockstep");
  expect_answer(quick("moving", "3"));
  for (const std::string folder : {"lockstep", "moving"}) {
    const int steps = json_in(folder).at("steps");
    ASSERT_GT(steps, 1) << folder;
    expect_refused({"--resume", path(folder), "--max-steps", "1"},
                   {"--resume: " + std::to_string(steps) + " steps of the run in " + path(folder) +
                        " are recorded already, more than the limit of 1",
                    "give --max-steps " + std::to_string(steps) + " or more"});
    expect_resumed(folder, {"--max-steps", std::to_string(steps)});
    EXPECT_EQ(json_in(folder).at("steps"), steps);
  }
  // A larger limit holds from then on, as long as run.json tells it.
  expect_resumed("lockstep", {"--max-steps", "5"});
  expect_resumed("lockstep");
  EXPECT_EQ(json_in("lockstep").at("steps"), 5);
  EXPECT_EQ(json_in("lockstep").at("options").at("max_steps"), 5);
  fs::remove(path("lockstep/run.json"));
  expect_refused({"--resume", path("lockstep")}, {"5 steps", "the limit of 4", "give --max-steps 5 or more"});
}

// What a robot's file may not hold, a recording may.
TEST_F(ExploreCommand, RefusesARecordedSensorOfTooManyRays) {
  expect_explored("run");
  Recording recording = read_recording(path("run/run.frontlux"));
  recording.head.robots.back().columns = recording.head.robots.back().rows = 8000;
  RecordingWriter(path("run/run.frontlux"), recording.head).write(recording.steps[0]);
  expect_refused({"--resume", path("run")},
                 {"--resume: " + path("run/run.frontlux"),
                  "robots[1].sensor.columns and rows are 8000 and 8000", "GB of memory"});
}

// Nor options that no command line takes, nor robots: each of these crashed or filled the disk.
TEST_F(ExploreCommand, RefusesARecordingThatNoRunHasWritten) {
  expect_explored("run");
  const Recording good = read_recording(path("run/run.frontlux"));
  const auto expect_refused_with = [&](const auto& change, const std::string& part) {
    Recording recording = good;
    change(recording.head);
    RecordingWriter(path("run/run.frontlux"), recording.head).write(recording.steps[0]);
    expect_refused({"--resume", path("run")}, {"--resume: ", path("run/run.frontlux"), part});
  };
  const auto option = [](const char* name, const char* value) {
    return [=](RecordingHead& head) {
      nlohmann::json options = nlohmann::json::parse(head.options);
      options[name] = nlohmann::json::parse(value);
      head.options = options.dump();
    };
  };
  for (const auto& [name, value] : {std::pair("samples", "1e300"),
                                    {"max_steps", "1e300"},
                                    {"seed", "-1"},
                                    {"stop_coverage", "-1"},
                                    {"scan_delay", "1e300"},
                                    {"latency", "0"},
                                    {"tracking_error", "1e9"},
                                    {"resolution", "0"}})
    expect_refused_with(option(name, value), std::string(name) + ": '");
  expect_refused_with(option("bumper", "3"), "type must be boolean");
  expect_refused_with([](RecordingHead& head) { head.options = std::string(1'000'000, '['); },
                      "nested too deeply");
  expect_refused_with([](RecordingHead& head) { head.robots[1].rate = 1e-12; }, "robots[1].sensor.rate_hz");
  expect_refused_with([](RecordingHead& head) { head.robots[1].robot.name = "\x1b[31m"; },
                      "robots[1].name is '?[31m'");
  expect_refused_with([](RecordingHead& head) { head.robots[1].robot.name = head.robots[0].robot.name; },
                      "the same name");
}

// A world that is large enough to be caught in the middle of.
TEST_F(ExploreCommand, GoesOnAfterItWasKilledAndAfterCtrlC) {
  const auto to = [&](const std::string& output) {
    return std::vector<std::string>{"storage",  "--lockstep", "--max-steps", "6",
                                    "--report", "off",        "-o",          path(output)};
  };
  ASSERT_EQ(run(to("whole")).code, 0);

  pid_t child = start_and_wait(to("killed"), 2);
  ASSERT_GT(child, 0);
  kill(child, SIGKILL);
  int status = test::status_of(child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status << content_of(path("err"));
  EXPECT_FALSE(fs::exists(path("killed/run.json")));
  const std::size_t recorded = read_recording(path("killed/run.frontlux")).steps.size();
  EXPECT_GE(recorded, 3U);  // steps 0 to 2 are told of, so they are kept
  EXPECT_LT(recorded, 7U);
  expect_resumed("killed");
  expect_same_runs("whole", "killed");

  child = start_and_wait(to("stopped"), 1);
  ASSERT_GT(child, 0);
  kill(child, SIGINT);
  status = test::status_of(child);
  EXPECT_EQ(test::exit_code(status), 130) << status;
  test::expect_parts(content_of(path("err")),
                     {"frontlux explore --resume " + path("stopped") + " continues the run"});
  const nlohmann::json json = json_in("stopped");
  EXPECT_EQ(json.at("end"), "stopped");
  EXPECT_GE(json.at("steps"), 1);
  EXPECT_LT(json.at("steps"), 6);
  EXPECT_EQ(read_recording(path("stopped/run.frontlux")).end, "stopped");
  EXPECT_TRUE(fs::exists(path("stopped/map.ot")));
  expect_resumed("stopped");
  expect_same_runs("whole", "stopped");
}

TEST_F(ExploreCommand, KeepsWhatItHasWhenTheDiskIsFull) {
  expect_explored("whole");
  const auto size = static_cast<std::uint64_t>(fs::file_size(path("whole/run.frontlux")));
  // A limit on the size of files, told by the signal's absence as an error of the write.
  for (const std::uint64_t part : {2U, 5U}) {
    const std::string limit = "trap '' XFSZ; ulimit -f " + std::to_string(size * part / 6 / 512) + ";";
    fs::remove_all(path("full"));
    const Answer answer = run({"room", "--lockstep", "--max-steps", kSteps, "-o", path("full")}, limit);
    EXPECT_EQ(answer.code, 2) << answer.err;
    test::expect_parts(answer.err, {path("full/run.frontlux") + ": cannot be written",
                                    "frontlux explore --resume " + path("full") + " continues the run"});
    const std::size_t kept = read_recording(path("full/run.frontlux")).steps.size();
    EXPECT_GE(kept, 1U);
    EXPECT_LT(kept, 5U);
    expect_resumed("full");
    expect_same_runs("whole", "full");
  }
  // What cannot be replaced is found before the recorded steps are repeated.
  fs::remove(path("whole/map.ot"));
  fs::create_directories(path("whole/map.ot/mine"));
  expect_refused({"--resume", path("whole")},
                 {"--resume: " + path("whole/map.ot") + " cannot be written to"});
  fs::remove_all(path("whole/map.ot"));
  // A table on a full device.
  for (const char* table : {"steps.csv", "paths.csv"}) {
    fs::remove(path("whole") + "/" + table);
    fs::create_symlink("/dev/full", path("whole") + "/" + table);
    const Answer answer = run({"--resume", path("whole")});
    EXPECT_EQ(answer.code, 2) << answer.err;
    test::expect_parts(answer.err, {std::string(table) + ": cannot be written: No space left on device"});
    fs::remove(path("whole") + "/" + table);
  }
  expect_resumed("whole");
  expect_same_runs("whole", "full");
}

// A run goes on only in the world that it is of.
TEST_F(ExploreCommand, RefusesToGoOnInAnotherWorld) {
  const auto world = [&](const char* seed) {
    return test::run_frontlux({"world", "room", "--seed", seed, "-o", path("room.ply")}, folder_);
  };
  ASSERT_EQ(world("1").code, 0);
  const Eigen::Vector3d start = *sim::make_world("room", 1).start;
  std::ostringstream at;
  at << start.x() << ',' << start.y() << ',' << start.z();
  expect_answer({path("room.ply"), "--start", at.str(), "--ground", "off", "--lockstep", "--max-steps", "1",
                 "-o", path("run")});
  ASSERT_EQ(world("2").code, 0);
  expect_refused({"--resume", path("run"), "--max-steps", "2", "--quiet"},
                 {"--resume: ", "is not what room.ply is now"});
  ASSERT_EQ(world("1").code, 0);
  expect_resumed("run", {"--max-steps", "2"});
  // One that looks the same until a robot finds out.
  Recording recording = read_recording(path("run/run.frontlux"));
  recording.steps.at(2).step.robots.at(1).changed.pop_back();
  RecordingWriter writer(path("run/run.frontlux"), recording.head);
  for (const RecordedStep& step : recording.steps) writer.write(step);
  writer.write_end("stopped");
  expect_refused({"--resume", path("run"), "--max-steps", "2", "--quiet"},
                 {"--resume: in step 2 the robots see another world"});
}

}  // namespace
}  // namespace frontlux::planner
