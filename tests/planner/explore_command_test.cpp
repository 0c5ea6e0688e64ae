// `frontlux explore` from the outside: its files, going on after every kind of end, and what it refuses.

#include "planner/team_in_world.hpp"
#include "support/command.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/recorded_map.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>
#include <variant>
#include <vector>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::content_of;
using test::expect_same;

constexpr const char* kSteps = "4";

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

std::vector<std::vector<std::string>> table_of(const fs::path& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(content_of(csv));
  for (std::string line; std::getline(lines, line);) rows.push_back(cells_of(line));
  return rows;
}

// steps.csv without what it tells of time.
std::vector<std::vector<std::string>> timeless(const fs::path& csv) {
  auto rows = table_of(csv);
  if (rows.empty()) return rows;
  const std::vector<std::string> header = rows.front();
  for (auto& row : rows)
    for (std::size_t i = header.size(); i-- > 0;)
      if (header[i].ends_with("_s") && i < row.size())
        row.erase(row.begin() + static_cast<std::ptrdiff_t>(i));
  return rows;
}

class ExploreCommand : public testing::Test {
 protected:
  ExploreCommand() : folder_(fs::temp_directory_path() / ("frontlux_explore_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ExploreCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] Answer run(std::vector<std::string> words, const std::string& before = "") const {
    words.insert(words.begin(), "explore");
    return test::run_frontlux(words, folder_, before);
  }
  // The room in four steps.
  [[nodiscard]] Answer explore(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"room", "--max-steps", kSteps, "-o", path(output)});
    return run(more);
  }
  void expect_explored(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--report", "off"});
    const Answer answer = explore(output, more);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
  }
  void expect_resumed(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--report", "off", "--resume", path(output)});
    const Answer answer = run(more);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
  }

  [[nodiscard]] nlohmann::json json_in(const std::string& output) const {
    return nlohmann::json::parse(content_of(path(output + "/run.json")));
  }

  // All but the times is that of another run.
  void expect_same_runs(const std::string& a, const std::string& b) const {
    SCOPED_TRACE(a + " and " + b);
    EXPECT_GT(content_of(path(a + "/map.ot")).size(), 1000U);
    for (const char* file : {"/map.ot", "/map.bt", "/paths.csv"})
      EXPECT_TRUE(content_of(path(a + file)) == content_of(path(b + file))) << file;
    EXPECT_EQ(timeless(path(a + "/steps.csv")), timeless(path(b + "/steps.csv")));
    const Recording x = read_recording(path(a + "/run.frontlux")),
                    y = read_recording(path(b + "/run.frontlux"));
    EXPECT_EQ(x.end, y.end);
    EXPECT_FALSE(x.truncated || y.truncated);
    ASSERT_EQ(x.steps.size(), y.steps.size());
    for (std::size_t i = 0; i < x.steps.size(); ++i) {
      expect_same(x.steps[i].step, y.steps[i].step);
      EXPECT_EQ(x.steps[i].known, y.steps[i].known);
      EXPECT_EQ(x.steps[i].collisions, y.steps[i].collisions);
    }
    const nlohmann::json p = json_in(a), q = json_in(b);
    for (const char* name :
         {"end", "steps", "coverage_observable", "coverage_box", "path_length_m", "collisions", "held_back"})
      EXPECT_EQ(p.at(name), q.at(name)) << name;
  }

  // Starts the command and waits until it has told of so many steps.
  [[nodiscard]] pid_t start_and_wait(const std::vector<std::string>& words, int steps) const {
    std::vector<std::string> all = {FRONTLUX_COMMAND, "explore"};
    all.insert(all.end(), words.begin(), words.end());
    fs::remove(path("out"));
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGINT, SIG_DFL);
      static_cast<void>(std::freopen(path("out").c_str(), "w", stdout));
      static_cast<void>(std::freopen(path("err").c_str(), "w", stderr));
      std::vector<char*> argv;
      for (std::string& word : all) argv.push_back(word.data());
      argv.push_back(nullptr);
      execv(FRONTLUX_COMMAND, argv.data());
      _exit(127);
    }
    const std::string last = "step " + std::to_string(steps) + ":";
    for (int i = 0; i < 6000 && content_of(path("out")).find(last) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return child;
  }
  static int status_of(pid_t child) {
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return status;
  }

  // Every file below the folder with its bytes, but for what the command prints.
  [[nodiscard]] std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      all[entry.path().string()] = entry.is_regular_file() ? content_of(entry.path()) : "";
    all.erase(path("out"));
    all.erase(path("err"));
    return all;
  }
  void expect_refused(const std::vector<std::string>& words, const std::vector<std::string>& parts) const {
    const auto before = files();
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    EXPECT_TRUE(answer.err.starts_with("frontlux: ")) << answer.err;
    EXPECT_EQ(answer.err.find('\n'), answer.err.size() - 1) << answer.err;
    for (const std::string& part : parts)
      EXPECT_NE(answer.err.find(part), std::string::npos) << part << "\nin\n" << answer.err;
    EXPECT_TRUE(files() == before) << "something was written: " << answer.err;
  }

  fs::path folder_;
};

TEST_F(ExploreCommand, ItsFilesTellTheSame) {
  ASSERT_EQ(explore("run").code, 0);
  EXPECT_GT(content_of(path("run/report.html")).size(), 1000U);
  const Recording recording = read_recording(path("run/run.frontlux"));
  ASSERT_EQ(recording.steps.size(), 5U);
  EXPECT_EQ(recording.end, "step_limit");

  // steps.csv against the recording.
  const auto rows = table_of(path("run/steps.csv"));
  ASSERT_EQ(rows.size(), 1 + 2 * recording.steps.size());
  const auto& header = rows.front();
  EXPECT_EQ(
      content_of(path("run/steps.csv")).substr(0, content_of(path("run/steps.csv")).find('\n')),
      "step,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,dropped,"
      "goal_state,assigned,released,received,left_over,goal_x_m,goal_y_m,goal_z_m,goal_yaw_rad,goal_gain,"
      "path,viewpoints,length_m,travelled_m,gain_tangent,gain_predicted,gained,stubborn,collisions,rays,"
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
      EXPECT_EQ(cell("robot"), r == 0 ? "ugv" : "uav");
      const auto& known = recorded.known;
      EXPECT_EQ(std::stod(cell("coverage_observable")),
                part(known[0].observable + known[1].observable, recording.head.observable));
      EXPECT_EQ(std::stod(cell("coverage_box")),
                part(known[0].bounding + known[1].bounding, recording.head.bounding));
      EXPECT_EQ(std::stod(cell("robot_observable")), part(known[r].observable, recording.head.observable));
      EXPECT_EQ(std::stod(cell("robot_box")), part(known[r].bounding, recording.head.bounding));
      EXPECT_EQ(cell("frontiers"), std::to_string(recorded.step.frontiers));
      EXPECT_EQ(cell("dropped"), std::to_string(recorded.step.dropped));
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
  EXPECT_EQ(json.at("caster"), "embree");
  EXPECT_EQ(json.at("distribute"), true);
  EXPECT_EQ(json.at("robots"), (std::vector<std::string>{"ugv", "uav"}));
  EXPECT_EQ(json.at("end"), "step_limit");
  EXPECT_EQ(json.at("steps"), 4);
  EXPECT_EQ(json.at("collisions"), 0);
  EXPECT_EQ(json.at("resolution_m"), 0.3);
  EXPECT_EQ(json.at("coverage_observable"), std::stod(rows.back()[2]));
  EXPECT_EQ(json.at("coverage_box"), std::stod(rows.back()[3]));
  EXPECT_EQ(json.at("path_length_m").at("ugv"), travelled[0]);
  EXPECT_EQ(json.at("path_length_m").at("uav"), travelled[1]);
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
  for (const char* part : {"\nend          step_limit", "\nsteps        4\n", "\ncollisions   0\n"})
    EXPECT_NE(out.find(part), std::string::npos) << part << " in " << out;
}

TEST_F(ExploreCommand, ComesToTheSameHoweverItIsRun) {
  expect_explored("one", {"--threads", "1"});
  expect_explored("two", {"--threads", "2"});
  expect_same_runs("one", "two");
  expect_explored("grid", {"--caster", "grid"});
  expect_same_runs("one", "grid");
  // Stopped at a limit, and with another limit gone on.
  ASSERT_EQ(run({"room", "--max-steps", "2", "-o", path("cut")}).code, 0);
  EXPECT_EQ(json_in("cut").at("steps"), 2);
  expect_resumed("cut", {"--max-steps", kSteps, "--threads", "1"});
  expect_same_runs("one", "cut");
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

TEST_F(ExploreCommand, GoesOnWithARecordingThatWasCutOffAnywhere) {
  expect_explored("whole");
  const std::string bytes = content_of(path("whole/run.frontlux"));
  for (const std::size_t cut : {bytes.size() - 1, bytes.size() / 2}) {
    SCOPED_TRACE("after " + std::to_string(cut) + " of " + std::to_string(bytes.size()) + " bytes");
    fs::remove_all(path("cut"));
    fs::create_directory(path("cut"));
    std::ofstream(path("cut/run.frontlux"), std::ios::binary) << bytes.substr(0, cut);
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

TEST_F(ExploreCommand, CountsTheWaysThatWereClosedBeforeItWentOn) {
  const sim::World room = sim::make_world("room", 1);
  sim::write_ply(path("poles.ply"), with_unseen_poles(room.mesh, *room.start));
  std::ostringstream at;
  at << room.start->x() << ',' << room.start->y() << ',' << room.start->z();
  for (const auto& [output, steps] : {std::pair("whole", "4"), std::pair("cut", "2")}) {
    const Answer answer = run({path("poles.ply"), "--start", at.str(), "--ground", "off", "--max-steps",
                               steps, "--report", "off", "-o", path(output)});
    ASSERT_EQ(answer.code, 0) << answer.err;
  }
  const std::uint64_t before = json_in("cut").at("held_back");
  EXPECT_GT(before, 0U);
  EXPECT_GT(json_in("whole").at("held_back"), before);
  expect_resumed("cut", {"--max-steps", "4"});
  expect_same_runs("whole", "cut");
}

// A world that is large enough to be caught in the middle of.
TEST_F(ExploreCommand, GoesOnAfterItWasKilledAndAfterCtrlC) {
  const std::vector<std::string> words = {"storage", "--max-steps", "6", "--report", "off", "-o"};
  const auto to = [&](const std::string& output) {
    auto all = words;
    all.push_back(path(output));
    return all;
  };
  ASSERT_EQ(run(to("whole")).code, 0);

  pid_t child = start_and_wait(to("killed"), 2);
  ASSERT_GT(child, 0);
  kill(child, SIGKILL);
  int status = status_of(child);
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
  status = status_of(child);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_NE(content_of(path("err")).find("frontlux explore --resume " + path("stopped") + " goes on"),
            std::string::npos)
      << content_of(path("err"));
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
  for (const std::uint64_t part : {2, 5}) {
    const std::string limit = "trap '' XFSZ; ulimit -f " + std::to_string(size * part / 6 / 512) + ";";
    fs::remove_all(path("full"));
    const Answer answer = run({"room", "--max-steps", kSteps, "-o", path("full")}, limit);
    EXPECT_EQ(answer.code, 2) << answer.err;
    for (const std::string& words : {path("full/run.frontlux") + ": cannot be written",
                                     "frontlux explore --resume " + path("full") + " goes on"})
      EXPECT_NE(answer.err.find(words), std::string::npos) << words << " in " << answer.err;
    const std::size_t kept = read_recording(path("full/run.frontlux")).steps.size();
    EXPECT_GE(kept, 1U);
    EXPECT_LT(kept, 5U);
    expect_resumed("full");
    expect_same_runs("whole", "full");
  }
  // A table on a full device.
  for (const char* table : {"steps.csv", "paths.csv"}) {
    fs::remove(path("whole") + "/" + table);
    fs::create_symlink("/dev/full", path("whole") + "/" + table);
    const Answer answer = run({"--resume", path("whole")});
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_NE(answer.err.find(std::string(table) + ": cannot be written: No space left on device"),
              std::string::npos)
        << answer.err;
    fs::remove(path("whole") + "/" + table);
  }
  expect_resumed("whole");
  expect_same_runs("whole", "full");
}

TEST_F(ExploreCommand, RefusesWhatCannotBe) {
  const std::string output = path("new");
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"room", "-o", output});
    return words;
  };
  expect_refused({"castle", "-o", output}, {"castle"});
  expect_refused({path("none.ply"), "-o", output}, {"none.ply"});
  expect_refused({"-o", output}, {"WORLD"});
  expect_refused({"room"}, {"-o"});
  for (const char* team : {"", "+", "uav+", "car", "0uav", "-1uav", "uav ugv", "99uav", "uav+99999999999ugv"})
    expect_refused(with({"--team", team}), {"--team"});
  expect_refused(with({"--robot", path("none.json")}), {"none.json"});
  std::ofstream(path("bad.json")) << R"({"name": "cart", "motion": "sideways"})";
  expect_refused(with({"--robot", path("bad.json")}), {"bad.json", "motion"});
  for (const char* pose : {"ugv", "car=1,1,1,0", "ugv=1,1,0.75", "ugv=1,1,0.75,0,0", "ugv=1,1,x,0",
                           "ugv=nan,1,1,0", "ugv=-5,-5,0.75,0", "uav=1e300,1,1,0", "=1,1,1,0", ""})
    expect_refused(with({"--pose", pose}), {"--pose"});
  expect_refused(with({"--goal", "best"}), {"--goal", "'best'", "render, cluster, nearest"});
  expect_refused(with({"--caster", "gpu"}), {"--caster", "'gpu'", "embree, grid, octomap"});
  expect_refused(with({"--mode", "fast"}), {"--mode", "'fast'"});
  expect_refused(with({"--planner", "prm"}), {"--planner", "'prm'"});
  expect_refused(with({"--distribute", "yes"}), {"--distribute", "'yes'"});
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
  expect_refused(with({"--epsilon", "-2"}), {"epsilon"});
  expect_refused(with({"--epsilon", "nan"}), {"--epsilon"});
  expect_refused(with({"--lambda", "-1"}), {"lambda"});
  expect_refused(with({"--advance", "-1"}), {"advance"});
  expect_refused(with({"--min-distance", "-1"}), {"min"});
  expect_refused(with({"--samples", "0"}), {"--samples"});
  expect_refused(with({"--noise", "-0.1"}), {"--noise"});
  expect_refused(with({"--dropout", "1.01"}), {"--dropout"});
  expect_refused(with({"--what"}), {"--what"});
  expect_refused(with({"--resume", output}), {"--resume"});
}

TEST_F(ExploreCommand, RefusesFoldersAndRecordingsThatDoNotFit) {
  fs::create_directory(path("kept"));
  std::ofstream(path("kept/notes.txt")) << "mine";
  expect_refused({"room", "-o", path("kept")}, {"--output", "is not empty", "--force"});
  std::ofstream(path("file")) << "mine";
  expect_refused({"room", "-o", path("file")}, {"--output", "is a file"});
  expect_refused({"room", "-o", path("file/run")}, {"--output"});
  expect_refused({"room", "-o", path("no/folder/run")}, {"--output", "cannot be made"});
  expect_refused({"room", "-o", ""}, {"--output"});
  expect_refused({"--resume", path("kept")}, {"--resume", "holds no run.frontlux"});
  expect_refused({"--resume", path("nowhere")}, {"--resume", "holds no run.frontlux"});
  // With --force all that is not of a run stays.
  ASSERT_EQ(run({"room", "--max-steps", "0", "-o", path("kept"), "--force"}).code, 0);
  EXPECT_EQ(content_of(path("kept/notes.txt")), "mine");
  const std::string bytes = content_of(path("kept/run.frontlux"));

  expect_refused({"--resume", path("kept"), "-o", path("new")}, {"--resume", "-o"});
  expect_refused({"--resume", path("kept"), "--force"}, {"--resume", "--force"});
  expect_refused({"--resume", path("kept"), "--team", "uav"}, {"--resume", "--team"});
  expect_refused({"--resume", path("kept"), "--seed", "1"}, {"--resume", "--seed"});
  expect_refused({"--resume", path("kept"), "room"}, {"--resume", "WORLD"});
  expect_refused({"--resume", path("kept"), "--max-steps", "x"}, {"--max-steps"});

  const auto expect_refused_recording = [&](const std::string& content, const std::string& part) {
    std::ofstream(path("kept/run.frontlux"), std::ios::binary) << content;
    expect_refused({"--resume", path("kept")}, {"--resume", "run.frontlux", part});
  };
  const std::size_t version = bytes.find('\n') - 1;
  expect_refused_recording(std::string(bytes).replace(version, 1, "7"), "format 7");
  expect_refused_recording("# Octomap OcTree file\n", "is not a recording");
  expect_refused_recording("", "is not a recording");
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
    const int status = status_of(child);
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "cannot be another user here";
    EXPECT_EQ(WEXITSTATUS(status), 2);
    EXPECT_NE(content_of(path("open/err")).find("--output: " + path(name)), std::string::npos)
        << content_of(path("open/err"));
    EXPECT_TRUE(fs::is_empty(path("locked")));
  }
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
  const Answer answer =
      run({path("room.ply"), "--start", at.str(), "--ground", "off", "--max-steps", "1", "-o", path("run")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  ASSERT_EQ(world("2").code, 0);
  expect_refused({"--resume", path("run"), "--max-steps", "2"},
                 {"--resume: ", "is not what room.ply is now"});
  ASSERT_EQ(world("1").code, 0);
  expect_resumed("run", {"--max-steps", "2"});
  // One that looks the same until a robot finds out.
  Recording recording = read_recording(path("run/run.frontlux"));
  recording.steps.at(2).step.robots.at(1).changed.pop_back();
  RecordingWriter writer(path("run/run.frontlux"), recording.head);
  for (const RecordedStep& step : recording.steps) writer.write(step);
  writer.write_end("stopped");
  expect_refused({"--resume", path("run")}, {"--resume: in step 2 the robots see another world"});
}

}  // namespace
}  // namespace frontlux::planner
