// `frontlux explore` from the outside: its files, and what it refuses.

#include "app/explore_command.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/recorded_map.hpp>
#include <frontlux/planner/recording.hpp>

#include <sys/wait.h>

#include <cstdio>
#include <unistd.h>
#include <variant>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::ExploreCommand;
using test::table_of;

TEST_F(ExploreCommand, ItsFilesAgree) {
  ASSERT_EQ(explore("run").code, 0);
  EXPECT_GT(content_of(path("run/report.html")).size(), 1000U);
  const Recording recording = read_recording(path("run/run.frontlux"));
  ASSERT_EQ(recording.steps.size(), 5U);
  EXPECT_EQ(recording.end, "step_limit");

  // steps.csv against the recording.
  const auto rows = table_of(path("run/steps.csv"));
  ASSERT_EQ(rows.size(), 1 + 2 * recording.steps.size());
  const auto& header = rows.front();
  const std::string csv = content_of(path("run/steps.csv"));
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "step,time_s,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,"
      "abandoned,goal_state,assigned,released,received,uncovered,goal_x_m,goal_y_m,goal_z_m,goal_yaw_rad,"
      "goal_gain,"
      "path,viewpoints,length_m,travelled_m,gain_tangent,gain_predicted,gained,still_unknown,contacts,rays,"
      "frontiers_s,caster_s,goals_s,paths_s,optimization_s,planning_s,moving_s");
  std::vector<double> travelled(2);
  std::size_t row = 1;
  for (const RecordedStep& recorded : recording.steps)
    for (std::size_t r = 0; r < 2; ++r, ++row) {
      ASSERT_EQ(rows[row].size(), header.size());
      const auto cell = [&](const char* name) {
        return rows[row][static_cast<std::size_t>(std::ranges::find(header, name) - header.begin())];
      };
      const RobotStep& robot = recorded.step.robots[r];
      travelled[r] += robot.length;
      const auto part = [](std::uint64_t known, std::uint64_t all) {
        return static_cast<double>(known) / static_cast<double>(all);
      };
      EXPECT_EQ(cell("step"), std::to_string(recorded.step.number));
      EXPECT_EQ(std::stod(cell("time_s")), recorded.step.time);
      EXPECT_EQ(cell("robot"), r == 0 ? "ugv" : "uav");
      const auto& known = recorded.known;
      EXPECT_EQ(std::stod(cell("coverage_observable")),
                part(known[0].observable + known[1].observable, recording.head.observable));
      EXPECT_EQ(std::stod(cell("coverage_box")),
                part(known[0].bounding + known[1].bounding, recording.head.bounding));
      EXPECT_EQ(std::stod(cell("robot_observable")), part(known[r].observable, recording.head.observable));
      EXPECT_EQ(std::stod(cell("robot_box")), part(known[r].bounding, recording.head.bounding));
      EXPECT_EQ(cell("frontiers"), std::to_string(recorded.step.frontiers));
      EXPECT_EQ(cell("abandoned"), std::to_string(recorded.step.abandoned));
      EXPECT_EQ(cell("goal_state"),
                recorded.step.number == 0 ? "start" : std::string(name_of(robot.goal.state)));
      if (robot.goal.pose) {
        EXPECT_EQ(std::stod(cell("goal_x_m")), robot.goal.pose->position.x());
        EXPECT_EQ(std::stod(cell("goal_yaw_rad")), robot.goal.pose->yaw);
        EXPECT_EQ(std::stod(cell("goal_gain")), robot.goal.gain);
      } else {
        EXPECT_EQ(cell("goal_x_m") + cell("goal_yaw_rad") + cell("goal_gain"), "");
      }
      EXPECT_EQ(cell("viewpoints"), std::to_string(robot.planned.size()));
      EXPECT_EQ(std::stod(cell("length_m")), robot.length);
      EXPECT_EQ(std::stod(cell("travelled_m")), travelled[r]);
      EXPECT_EQ(cell("gain_predicted"), std::to_string(robot.gain_predicted));
      EXPECT_EQ(cell("gained"), std::to_string(robot.gained));
      EXPECT_EQ(cell("rays"), std::to_string(recorded.step.rays));
      EXPECT_EQ(std::stod(cell("planning_s")), recorded.step.planning_seconds());
    }

  // paths.csv
  const auto viewpoints = table_of(path("run/paths.csv"));
  std::size_t planned = 1;
  for (const RecordedStep& recorded : recording.steps)
    for (const RobotStep& robot : recorded.step.robots)
      for (std::size_t i = 0; i < robot.planned.size(); ++i, ++planned) {
        ASSERT_LT(planned, viewpoints.size());
        ASSERT_EQ(viewpoints[planned].size(), 8U);
        EXPECT_EQ(viewpoints[planned][2], std::to_string(i));
        EXPECT_EQ(viewpoints[planned][3], i < robot.travelled ? "1" : "0");
        EXPECT_EQ(std::stod(viewpoints[planned][5]), robot.planned[i].position.y());
      }
  EXPECT_EQ(planned, viewpoints.size());

  // The maps against what the recorded changes come to.
  RecordedMap map(recording.head.resolution);
  for (const RecordedStep& step : recording.steps) map.apply(step);
  for (const char* file : {"run/map.ot", "run/map.bt"}) {
    const auto tree = std::get<std::shared_ptr<octomap::OcTree>>(read_octree(path(file)));
    EXPECT_TRUE(make_voxel_grid(*tree) == map.grid()) << file;
  }

  // run.json against both.
  const nlohmann::json json = json_in("run");
  EXPECT_EQ(json.at("world"), "room");
  EXPECT_EQ(json.at("seed"), 1);
  EXPECT_EQ(json.at("mode"), "default");
  EXPECT_EQ(json.at("caster"), "fast");
  EXPECT_EQ(json.at("assign"), true);
  EXPECT_EQ(json.at("robots"), (std::vector<std::string>{"ugv", "uav"}));
  EXPECT_EQ(json.at("end"), "step_limit");
  EXPECT_EQ(json.at("steps"), 4);
  EXPECT_EQ(json.at("contacts"), 0);
  EXPECT_EQ(json.at("resolution_m"), 0.3);
  EXPECT_EQ(json.at("coverage_observable"), std::stod(rows.back()[3]));
  EXPECT_EQ(json.at("coverage_box"), std::stod(rows.back()[4]));
  EXPECT_EQ(json.at("path_length_m").at("ugv"), travelled[0]);
  EXPECT_EQ(json.at("path_length_m").at("uav"), travelled[1]);
  EXPECT_NEAR(json.at("path_length_total_m"), travelled[0] + travelled[1], 1e-9);
  EXPECT_EQ(json.at("unseen"), nullptr) << "it has not ended by itself";
  double sum = 0.0, most = 0.0;
  for (std::size_t i = 1; i < recording.steps.size(); ++i) {
    sum += recording.steps[i].step.planning_seconds();
    most = std::max(most, recording.steps[i].step.planning_seconds());
  }
  EXPECT_NEAR(json.at("planning_mean_s").get<double>(), sum / 4, 1e-12);
  EXPECT_EQ(json.at("planning_max_s"), most);
  EXPECT_GT(json.at("memory_mb"), 1.0);

  // A line for each step, and a summary.
  const std::string out = content_of(path("out"));
  for (int step = 0; step <= 4; ++step)
    EXPECT_NE(out.find("step " + std::to_string(step) + ": "), std::string::npos) << out;
  test::expect_parts(out, {"\nend          step_limit", "\nsteps        4\n", "\ncontacts     0\n"});
}

TEST_F(ExploreCommand, RefusesWhatCannotBe) {
  const std::string output = path("new");
  const auto with = [&](const std::vector<std::string>& words) {
    return test::joined({"room", "-o", output}, words);
  };
  expect_refused({"castle", "-o", output}, {"castle"});
  expect_refused({"sttaion", "-o", output},
                 {"'sttaion' is neither", "(did you mean station?); built-in worlds: "});
  expect_refused({path("none.ply"), "-o", output}, {"none.ply"});
  expect_refused({"-o", output}, {"WORLD"});
  for (const char* team :
       {"", "+", "uav+", "car", "0uav", "-1uav", "uav ugv", "99uav", "uav+99999999999ugv", "32uav+32uav"})
    expect_refused(with({"--team", team}), {"--team"});
  expect_refused(with({"--robot", path("none.json")}), {"none.json"});
  expect_refused(with({"--robot", write("bad.json", R"({"name": "cart", "motion": "sideways"})")}),
                 {"bad.json", "motion"});
  for (const char* pose : {"ugv", "car=1,1,1,0", "ugv=1,1,0.75", "ugv=1,1,0.75,0,0", "ugv=1,1,x,0",
                           "ugv=nan,1,1,0", "ugv=-5,-5,0.75,0", "uav=1e300,1,1,0", "=1,1,1,0", ""})
    expect_refused(with({"--pose", pose}), {"--pose"});
  expect_refused(with({"--goal", "best"}), {"--goal", "'best'", "tour, render, cluster, nearest"});
  expect_refused(with({"--goal", "tour", "--lockstep"}), {"--goal tour is not for --lockstep"});
  expect_refused(with({"--goal", "tour", "--mode", "paper"}), {"--goal tour is not for --mode paper"});
  expect_refused(with({"--caster", "gpu"}), {"--caster", "'gpu'", "fast, embree, grid, octomap"});
  expect_refused(with({"--mode", "fast"}), {"--mode", "'fast'"});
  expect_refused(with({"--planner", "prm"}), {"--planner", "'prm'"});
  expect_refused(with({"--assign", "yes"}), {"--assign: 'yes' is none of on, off"});
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--assign", "off"},
                                                 {"--lambda", "0.1"},
                                                 {"--advance", "2"},
                                                 {"--min-distance", "1"},
                                                 {"--samples", "32"},
                                                 {"--renderer", "rays"}})
    expect_refused(with(option), {option.front() + " is not for tours", "--goal render"});
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--advance", "2"}, {"--samples", "32"}, {"--renderer", "rays"}}) {
    std::vector<std::string> words = with(option);
    words.insert(words.end(), {"--goal", "nearest"});
    expect_refused(words, {option.front() + " is not for --goal nearest", "--goal render or cluster"});
  }
  expect_refused(with({"--goal", "render", "--renderer", "exact", "--samples", "32"}),
                 {"--samples is not for --renderer exact", "--renderer rays"});
  expect_refused(with({"--fix-every", "3"}), {"--fix-every is for --drift"});
  expect_refused(with({"--tours-without", "zones", "--goal", "render"}),
                 {"--tours-without is for robots on tours"});
  expect_refused(with({"--tours-without", "legs"}), {"--tours-without: 'legs' is none of nothing, zones"});
  expect_refused(with({"--optimize", "1"}), {"--optimize", "'1'"});
  expect_refused(with({"--report", "maybe"}), {"--report", "'maybe'"});
  for (const char* number : {"-1", "1.5", "1025", "two", "", "99999999999999999999"})
    expect_refused(with({"--threads", number}), {"--threads"});
  for (const char* number : {"-1", "1.5", "many", "", "99999999999"})
    expect_refused(with({"--max-steps", number}), {"--max-steps"});
  for (const char* number : {"-1", "x", "18446744073709551616"})
    expect_refused(with({"--seed", number}), {"--seed"});
  for (const char* number : {"0", "-0.3", "nan", "inf", "1e-9", "x"})
    expect_refused(with({"--resolution", number}), {"--resolution"});
  for (const char* option : {"--epsilon", "--lambda", "--advance", "--min-distance"})
    for (const std::string number : {"-2", "nan", "inf", "1e999", "1m", ""})
      expect_refused(with({option, number}),
                     {option + std::string(": '") + number + "' is not a number of at least 0"});
  expect_refused(with({"--samples", "0"}), {"--samples"});
  for (const char* option : {"--dropout", "--drift", "--scan-loss"})
    expect_refused(with({option, "1.01"}), {option});
  for (const char* option : {"--dropout", "--scan-loss"}) {
    expect_refused(with({option, "1"}), {option, "of 1 nothing is ever measured", "--stop-time"});
    expect_refused(with({option, "1", "--fail", "uav=3"}), {option, "of 1 nothing is ever measured"});
  }
  expect_refused(with({"--fix-every", "-1"}), {"--fix-every"});
  for (const char* option : {"--tracking-error", "--noise"})
    for (const char* metres : {"-0.1", "10.1", "nan"})
      expect_refused(with({option, metres}), {option, "from 0 to 10"});
  for (const char* growth : {"-0.1", "1.1", "nan"})
    expect_refused(with({"--noise-growth", growth}), {"--noise-growth"});
  for (const char* seconds : {"-1", "nan", "61"})
    expect_refused(with({"--scan-delay", seconds}), {"--scan-delay"});
  for (const char* word : {"", "ugv", "ugv=", "=3", "ugv=-1", "ugv=1,", "ugv=1,uav", "ugv=x", "ugv=1e6"})
    for (const std::string option : {"--fail", "--join"})
      expect_refused(with({option, word}), {option, "NAME=SECONDS, 0 to 100000"});
  for (const std::string option : {"--fail", "--join"}) {
    expect_refused(with({option, "car=3"}), {option + ": 'car=3'", "not in the team", "ugv, uav"});
    expect_refused(with({option, "uav=3,uav=4"}), {option + ": 'uav=3,uav=4' names uav twice"});
    expect_refused(with({option, "uav=3", "--lockstep"}), {option + " is not for --lockstep"});
  }
  expect_refused(with({"--fail", "uav=3", "--join", "ugv=3,uav=3"}),
                 {"--join: 'ugv=3,uav=3': uav fails at that time"});
  expect_refused(with({"--pose", "uav=1,1,1,0", "--pose", "uav=2,1,1,0"}),
                 {"--pose: 'uav=2,1,1,0' places uav, which another --pose does already"});
  expect_refused(with({"--drift", "0.1", "--lockstep"}), {"--drift is not for --lockstep"});
  expect_refused(with({"--tracking-error", "0.1", "--lockstep"}), {"--tracking-error is not for --lockstep"});
  expect_refused(with({"--scan-loss", "0.1", "--lockstep"}), {"--scan-loss is not for --lockstep"});
  expect_refused(with({"--what"}), {"--what"});
  expect_refused(with({"--resume", output}), {"--resume"});
}

TEST_F(ExploreCommand, RefusesFoldersAndRecordingsThatDoNotFit) {
  fs::create_directory(path("kept"));
  write("kept/notes.txt", "mine");
  expect_refused({"room", "-o", path("kept")}, {"--output", "is not empty", "--force"});
  write("file", "mine");
  expect_refused({"room", "-o", path("file")}, {"--output", "is a file"});
  expect_refused({"room", "-o", path("file/run")}, {"--output"});
  expect_refused({"room", "-o", path("no/folder/run")}, {"--output", "cannot be created"});
  expect_refused({"room", "-o", ""}, {"--output"});
  // Before a world is read; here it is none.
  write("none.ply", "ply");
  fs::create_directories(path("blocked/map.bt/mine"));
  for (const auto& [output, part] :
       {std::pair("kept", "is not empty"), {"no/folder/run", "cannot be created"}})
    expect_refused({path("none.ply"), "--start", "1,1,1", "-o", path(output)}, {"--output", part});
  expect_refused({path("none.ply"), "--start", "1,1,1", "--force", "-o", path("blocked")},
                 {"--output: " + path("blocked") + " holds a folder map.bt"});
  // A run may not replace the world that it explores.
  fs::create_directory(path("mine"));
  fs::copy_file(fs::path(FRONTLUX_DATA_DIR) / "maps/room_0.2m.ot", path("mine/map.ot"));
  expect_refused({path("mine/map.ot"), "--start", "6,3,1", "--force", "-o", path("mine")},
                 {"holds what is read, " + path("mine/map.ot")});
  expect_refused({"--resume", path("kept")}, {"--resume", "holds no run.frontlux"});
  expect_refused({"--resume", path("nowhere")}, {"--resume: there is no folder " + path("nowhere")});
  expect_refused({"--resume", path("file")}, {"is a file; name its folder, " + folder_.string()});
  // Files that have the names of a run's may be a user's own.
  for (const char* name : {"map.bt", "report.html", "video.mp4", "coverage.svg"}) {
    fs::create_directory(path("own"));
    write(std::string("own/") + name, "mine");
    expect_refused({"room", "--max-steps", "0", "-o", path("own"), "--force"},
                   {std::string("holds ") + name + ", but no run"});
    EXPECT_EQ(content_of(path(std::string("own/") + name)), "mine");
    fs::remove_all(path("own"));
  }
  // With --force all that is not of a run stays.
  ASSERT_EQ(run({"room", "--max-steps", "0", "-o", path("kept"), "--force"}).code, 0);
  EXPECT_EQ(content_of(path("kept/notes.txt")), "mine");
  const std::string bytes = content_of(path("kept/run.frontlux"));

  const auto refuse_to_resume = [&](const std::vector<std::string>& more,
                                    const std::vector<std::string>& parts) {
    expect_refused(test::joined({"--resume", path("kept")}, more), parts);
  };
  refuse_to_resume({"-o", path("new")}, {"--resume", "-o"});
  refuse_to_resume({"--force"}, {"--resume", "--force"});
  refuse_to_resume({"--team", "uav"}, {"--resume", "--team"});
  refuse_to_resume({"--seed", "1"}, {"--resume", "--seed"});
  refuse_to_resume({"room"}, {"--resume", "WORLD"});
  refuse_to_resume({"--max-steps", "x"}, {"--max-steps"});

  const auto expect_refused_recording = [&](const std::string& content, const std::string& part) {
    write("kept/run.frontlux", content);
    refuse_to_resume({}, {"--resume", "run.frontlux", part});
  };
  const std::size_t version = bytes.find('\n') - 1;
  std::string newer = bytes;
  newer[version] = '7';
  expect_refused_recording(newer, "format 7");
  expect_refused_recording("# Octomap OcTree file\n", "is not a recording");
  expect_refused_recording("", "before the run began");
  expect_refused_recording(bytes.substr(0, version + 30), "before the run began");
  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 1);
  expect_refused_recording(flipped, "damaged");
}

// A folder in which this user may not write; root may everywhere, so the command runs as nobody then.
TEST_F(ExploreCommand, RefusesAFolderThatMayNotBeWritten) {
  fs::create_directory(path("locked"));
  fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                                      fs::perms::others_exec);
  fs::create_directory(path("open"));
  fs::permissions(path("open"), fs::perms::all);
  for (const char* name : {"locked", "locked/inner"}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      static_cast<void>(std::freopen(path("open/err").c_str(), "w", stderr));
      if (geteuid() == 0 && setuid(65534) != 0) _exit(77);
      const std::string output = path(name);
      execl(FRONTLUX_COMMAND, FRONTLUX_COMMAND, "explore", "room", "--max-steps", "0", "-o", output.c_str(),
            static_cast<char*>(nullptr));
      _exit(77);
    }
    const int status = test::status_of(child);
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "cannot be another user here";
    EXPECT_EQ(WEXITSTATUS(status), 2);
    test::expect_parts(content_of(path("open/err")), {"--output: " + path(name)});
    EXPECT_TRUE(fs::is_empty(path("locked")));
  }
}

}  // namespace
}  // namespace frontlux::planner
