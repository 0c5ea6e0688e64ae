// `frontlux explore --task`: tasks from files, what the command line changes of them, and what is refused.

#include "app/explore_command.hpp"
#include "support/input_test.hpp"
#include "support/test.hpp"

#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <csignal>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::ExploreCommand;
using test::joined;

const std::string kUav =
    R"({"name": "uav", "motion": "space", "body": {"kind": "box", "size_m": [0.4, 0.4, 0.4]}, "margin_m": 0.05, )"
    R"("limits": {"speed_m_s": 2, "acceleration_m_s2": 3, "yaw_rate_deg_s": 90, "per_axis": true}, )"
    R"("sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 73.74, "range_m": 5, "columns": 80, )"
    R"("rows": 60, "rate_hz": 10}, "start": [1.5, 1.5, 1, 30]})";

class TaskCommand : public ExploreCommand {
 protected:
  void expect_done(const std::string& task, const std::string& output,
                   const std::vector<std::string>& more = {}) const {
    expect_answer(joined({"--task", task, "-o", path(output), "--report", "off"}, more));
  }
  /// The task in run.json as a file.
  [[nodiscard]] std::string task_of(const std::string& output) const {
    return write(output + "_task.json", json_in(output).at("task").dump());
  }
  /// A floor of 12 x 12 m, and walls around 6 x 6 m of it; no ceiling.
  void write_court() const {
    sim::TriangleMesh mesh;
    const auto add = [&](const Eigen::Vector3f& corner, const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const Eigen::Vector3f& vertex : {corner, Eigen::Vector3f(corner + a),
                                            Eigen::Vector3f(corner + a + b), Eigen::Vector3f(corner + b)})
        mesh.vertices.push_back(vertex);
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    };
    const Eigen::Vector3f x = 6 * Eigen::Vector3f::UnitX(), y = 6 * Eigen::Vector3f::UnitY(),
                          z = 3 * Eigen::Vector3f::UnitZ();
    add({-3, -3, 0}, 2 * x, 2 * y);
    add({0, 0, 0}, x, z);
    add({0, 0, 0}, y, z);
    add({0, 6, 0}, x, z);
    add({6, 0, 0}, y, z);
    sim::write_ply(path("court.ply"), mesh);
  }
  [[nodiscard]] std::string court(const std::string& members = "") const {
    return write("court.json",
                 R"({"world": "court.ply", "box_m": [[0, 0, 0], [6, 6, 2]], "resolution_m": 0.2, )" +
                     members + R"("end": {"time_s": 3}, "robots": [)" + kUav + "]}");
  }
};

TEST_F(TaskCommand, OfABuiltInWorldIsTheRunOfTheCommandLine) {
  const std::string room = (fs::path(FRONTLUX_DATA_DIR) / "tasks/room.json").string();
  expect_answer({"room", "--seed", "1", "--stop-time", "4", "--report", "off", "-o", path("words")});
  expect_done(room, "task", {"--stop-time", "4"});
  expect_same_runs("words", "task");
  EXPECT_EQ(content_of(path("words/motion.csv")), content_of(path("task/motion.csv")));
  // The task of each run is the same run again.
  for (const char* run : {"words", "task"}) {
    expect_done(task_of(run), std::string(run) + "_again");
    expect_same_runs("words", std::string(run) + "_again");
  }
}

TEST_F(TaskCommand, GivesWayToTheCommandLine) {
  const std::string file =
      write("t.json", R"({"name": "n", "world": "room", "world_seed": 3, "seed": 5, "latency_s": 0.2,
    "lockstep": true, "method": "nearest", "resolution_m": 0.25, "end": {"coverage": 0.5, "time_s": 100},
    "robots": [{"file": "r.json"}], "options": {"max-steps": 1, "noise": "0.01", "caster": "grid"}})");
  fs::copy_file(fs::path(FRONTLUX_DATA_DIR) / "robots/ugv.json", path("r.json"));
  expect_done(file, "plain");
  nlohmann::json task = json_in("plain").at("task");
  EXPECT_EQ(task.at("name"), "n");
  EXPECT_EQ(task.at("world_seed"), 3);
  EXPECT_EQ(task.at("seed"), 5);
  EXPECT_EQ(task.at("latency_s"), 0.2);
  EXPECT_EQ(task.at("lockstep"), true);
  EXPECT_EQ(task.at("method"), "nearest");
  EXPECT_EQ(task.at("resolution_m"), 0.25);
  EXPECT_EQ(task.at("end"), nlohmann::json::parse(R"({"coverage": 0.5, "time_s": 100.0})"));
  EXPECT_EQ(task.at("options"),
            nlohmann::json::parse(R"({"caster": "grid", "max-steps": "1", "noise": "0.01"})"));
  EXPECT_EQ(task.at("robots").size(), 1U);
  EXPECT_EQ(task.at("robots")[0].at("name"), "ugv");
  EXPECT_EQ(json_in("plain").at("steps"), 1);
  EXPECT_EQ(json_in("plain").at("goal"), "nearest");
  expect_done(task_of("plain"), "again");
  expect_same_runs("plain", "again");

  expect_done(
      file, "other",
      {"--seed", "6", "--latency", "0.3", "--lockstep=false", "--mode", "default", "--resolution", "0.3",
       "--stop-coverage", "0.4", "--stop-time", "2", "--team", "uav", "--noise", "0", "--max-steps", "3"});
  task = json_in("other").at("task");
  EXPECT_EQ(task.at("world_seed"), 3);
  EXPECT_EQ(task.at("seed"), 6);
  EXPECT_EQ(task.at("latency_s"), 0.3);
  EXPECT_EQ(task.at("lockstep"), false);
  EXPECT_EQ(task.at("method"), "tour");
  EXPECT_EQ(task.at("resolution_m"), 0.3);
  EXPECT_EQ(task.at("end"), nlohmann::json::parse(R"({"coverage": 0.4, "time_s": 2.0})"));
  EXPECT_EQ(task.at("options"), nlohmann::json::parse(R"({"caster": "grid", "max-steps": "3"})"));
  ASSERT_EQ(task.at("robots").size(), 1U);
  EXPECT_EQ(task.at("robots")[0].at("name"), "uav");
}

// The command's words, which are others than by default, of all options that a task may hold.
TEST_F(TaskCommand, PublishesEveryOption) {
  write_court();
  const std::vector<std::string> in_motion = {
      "--goal",         "render", "--planner",        "rrt",     "--renderer",     "rays",
      "--samples",      "16",     "--assign",         "off",     "--optimize",     "off",
      "--caster",       "grid",   "--lambda",         "0.2",     "--advance",      "1",
      "--min-distance", "0.5",    "--epsilon",        "5",       "--max-steps",    "2",
      "--bumper",       "off",    "--noise",          "0.01",    "--dropout",      "0.1",
      "--drift",        "0.01",   "--fix-every",      "5",       "--scan-delay",   "0.2",
      "--scan-loss",    "0.1",    "--fail",           "uav=500", "--sensor-model", "cautious",
      "--stray",        "0.001",  "--tracking-error", "0.05",    "--join",         "uav=600",
      "--noise-growth", "0.001"};
  const std::vector<std::string> of_world = {
      "--mode", "paper", "--goal",  "nearest",   "--ground",    "0", "--scale", "0.9",
      "--up",   "z",     "--start", "1.5,1.5,1", "--max-steps", "2", "--team",  "uav"};
  const auto expect_published = [&](const std::string& run, const std::vector<std::string>& words) {
    expect_answer(joined(words, {"--report", "off", "-o", path(run)}));
    expect_done(task_of(run), run + "_again");
    expect_same_runs(run, run + "_again");
    const nlohmann::json task = json_in(run).at("task");
    EXPECT_EQ(task, json_in(run + "_again").at("task"));
    return task;
  };
  const nlohmann::json motion = expect_published("motion", joined({"room"}, in_motion));
  const nlohmann::json world = expect_published("world", joined({path("court.ply")}, of_world));
  const nlohmann::json tours =
      expect_published("tours", {"room", "--tours-without", "joining", "--max-steps", "2"});
  EXPECT_EQ(motion.at("method"), "render");
  EXPECT_EQ(world.at("method"), "paper");
  // What the command says it knows; the start is a member of its robot.
  const std::string unknown = write("unknown.json", R"({"world": "room", "options": {"": 1}})");
  const std::string said = run({"--task", unknown, "-o", path("none")}).err;
  const std::size_t begin = said.find("known here: ") + 12;
  std::istringstream list(said.substr(begin, said.find(';', begin) - begin));
  int known = 0;
  for (std::string name; std::getline(list >> std::ws, name, ',');) {
    ++known;
    if (name == "start") continue;
    EXPECT_TRUE(motion.at("options").contains(name) || world.at("options").contains(name) ||
                tours.at("options").contains(name))
        << name;
  }
  EXPECT_EQ(known, 30);
}

TEST_F(TaskCommand, ExploresABoxOfAWorld) {
  write_court();
  expect_done(court(), "run");
  const Recording run = read_recording(path("run/run.frontlux"));
  // 30 x 30 x 10 voxels of 0.2 m; walls and floor lie on the faces.
  EXPECT_EQ(run.head.bounding, 9000U);
  EXPECT_EQ(run.head.observable, 9000U);
  ASSERT_EQ(run.head.starts.size(), 1U);
  EXPECT_EQ(run.head.starts[0].pose.position, Eigen::Vector3d(1.5, 1.5, 1.0));
  EXPECT_DOUBLE_EQ(run.head.starts[0].pose.yaw, std::numbers::pi / 6);
  const Robot& uav = run.head.robots.at(0).robot;
  EXPECT_EQ(uav.travel.floor, 0.0);
  EXPECT_EQ(uav.travel.min_height, 0.2);
  EXPECT_EQ(uav.travel.margin, 0.05);
  EXPECT_EQ(uav.limits.speed, 2.0);
  EXPECT_TRUE(uav.limits.per_axis);
  EXPECT_EQ(run.head.robots[0].rate, 10.0);
  EXPECT_EQ(run.end, "time_limit");
  EXPECT_GT(json_in("run").at("coverage_observable"), 0.2);
  EXPECT_EQ(json_in("run").at("contacts"), 0);
  const nlohmann::json task = json_in("run").at("task");
  EXPECT_EQ(task.at("name"), "court");
  EXPECT_EQ(task.at("world"), path("court.ply"));
  EXPECT_EQ(task.at("robots")[0].at("start"), nlohmann::json::parse("[1.5, 1.5, 1.0, 30.0]"));
  EXPECT_EQ(task.at("robots")[0].at("sensor").at("vertical_deg"), 73.74);
  EXPECT_FALSE(task.contains("options"));
  expect_done(task_of("run"), "again");
  expect_same_runs("run", "again");
}

TEST_F(TaskCommand, IsResumedWithoutItsFile) {
  write_court();
  const std::string file = court();
  expect_done(file, "whole");
  expect_done(file, "cut", {"--max-steps", "1"});
  fs::remove(file);
  expect_resumed("cut", {"--max-steps", "100000"});
  expect_same_runs("whole", "cut");
  EXPECT_EQ(json_in("cut").at("task").at("box_m"), json_in("whole").at("task").at("box_m"));
}

// Among lockers, on any number of threads, resumed, and repeated from run.json.
TEST_F(TaskCommand, OfARoundBodyIsTheSameAgain) {
  const std::string kBox = R"({"kind": "box", "size_m": [0.4, 0.4, 0.4]})",
                    kRound = R"({"kind": "cylinder", "diameter_m": 0.5, "height_m": 0.3})",
                    kStart = R"(, "start": [1.5, 1.5, 1, 30])";
  const std::string uav = test::replaced(test::replaced(kUav, kBox, kRound), kStart, "");
  const std::string file = write("round.json", R"({"world": "room", "seed": 1, "resolution_m": 0.2, )"
                                               R"("end": {"time_s": 4}, "robots": [)" +
                                                   uav + "]}");
  expect_done(file, "one", {"--threads", "1"});
  expect_done(file, "two", {"--threads", "2"});
  expect_same_runs("one", "two");
  expect_done(file, "cut", {"--max-steps", "2"});
  expect_resumed("cut", {"--max-steps", "100000"});
  expect_same_runs("one", "cut");
  EXPECT_EQ(content_of(path("one/motion.csv")), content_of(path("cut/motion.csv")));
  EXPECT_EQ(json_in("one").at("task").at("robots")[0].at("body"), nlohmann::json::parse(kRound));
  EXPECT_EQ(read_recording(path("cut/run.frontlux")).head.robots.at(0).robot.travel.shape,
            BodyShape::kCylinder);
  expect_done(task_of("one"), "again");
  expect_same_runs("one", "again");
  EXPECT_EQ(json_in("one").at("contacts"), 0);
}

TEST_F(TaskCommand, NumbersEqualNamesPastThoseThatAreTaken) {
  write_court();
  const auto robot = [](const std::string& name, int x) {
    return test::replaced(test::replaced(kUav, R"("name": "uav")", R"("name": ")" + name + '"'),
                          "[1.5, 1.5, 1, 30]", '[' + std::to_string(x) + ", 1.5, 1, 30]");
  };
  const std::string longest(40, 'n');
  write("team.json", R"({"world": "court.ply", "box_m": [[0, 0, 0], [6, 6, 2]], "resolution_m": 0.2, )"
                     R"("end": {"time_s": 0.2}, "robots": [)" +
                         robot("u", 1) + ", " + robot("u", 2) + ", " + robot("u1", 3) + ", " +
                         robot(longest, 4) + ", " + robot(longest, 5) + "]}");
  expect_done(path("team.json"), "run");
  const std::vector<std::string> names = {"u2", "u3", "u1", std::string(39, 'n') + '1',
                                          std::string(39, 'n') + '2'};
  EXPECT_EQ(json_in("run").at("robots"), names);
  EXPECT_EQ(json_in("run").at("by_robot").size(), names.size());
  // The names that a run has got are those of its task.
  expect_done(task_of("run"), "again");
  EXPECT_EQ(json_in("again").at("robots"), names);
  expect_same_runs("run", "again");
}

TEST_F(TaskCommand, MayNameItsGoalTwice) {
  for (const auto& [method, goal] : {std::pair("render", "render"), {"paper", "nearest"}}) {
    const std::string file =
        write("goal.json", std::string(R"({"world": "room", "method": ")") + method +
                               R"(", "options": {"max-steps": 1, "goal": ")" + goal + "\"}}");
    expect_done(file, method);
    EXPECT_EQ(json_in(method).at("goal"), goal);
    expect_done(task_of(method), std::string(method) + "_again");
  }
  // Contradictions with the command line name the task.
  const std::string file = write("steps.json", R"({"world": "room", "lockstep": true})");
  expect_refused({"--task", file, "--goal", "tour", "-o", path("none")},
                 {"--goal tour is not for --lockstep", "the task " + file});
}

TEST_F(TaskCommand, RefusesStartsInEachOther) {
  write_court();
  const std::string other = test::replaced(test::replaced(kUav, R"("uav")", R"("second")"),
                                           "[1.5, 1.5, 1, 30]", "[1.5, 1.8, 1, 0]");
  const auto task = [&](const std::string& second) {
    return write("two.json",
                 R"({"world": "court.ply", "box_m": [[0, 0, 0], [6, 6, 2]], "resolution_m": 0.2, )"
                 R"("end": {"time_s": 0.2}, "robots": [)" +
                     kUav + ", " + second + "]}");
  };
  const std::string overlap =
      "the bodies of the robots 'uav' and 'second' overlap, with their sensors 0.30 m apart";
  expect_refused({"--task", task(other), "-o", path("run")},
                 {"two.json: the start of the robot 'second': " + overlap});
  const std::string apart = task(test::replaced(other, "1.8, 1, 0", "2.1, 1, 0"));
  expect_refused({"--task", apart, "--pose", "second=1.5,1.2,1,0", "-o", path("run")},
                 {"--pose: 'second=1.5,1.2,1,0': " + overlap});
  expect_done(apart, "run");
}

// A step of a minute with a thousand scans a second.
TEST_F(TaskCommand, NoticesAnInterruptInALongStep) {
  write_court();
  const std::string busy = test::replaced(kUav, R"("rate_hz": 10)", R"("rate_hz": 10000)");
  const std::string file =
      write("busy.json", R"({"world": "court.ply", "resolution_m": 0.1, "latency_s": 60, )"
                         R"("box_m": [[0, 0, 0], [6, 6, 2]], "robots": [)" +
                             busy + "]}");
  const pid_t child = start_and_wait({"--task", file, "--report", "off", "-o", path("run")}, 0);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  kill(child, SIGINT);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(test::exit_code(test::status_of(child)), 130) << content_of(path("err"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));
  EXPECT_EQ(json_in("run").at("end"), "stopped");
  EXPECT_EQ(read_recording(path("run/run.frontlux")).end, "stopped");
  expect_refused({"--task", file, "--latency", "60.1", "-o", path("none")},
                 {"--latency: '60.1' is not a number above 0, at most 60"});
}

TEST_F(TaskCommand, WithoutABoxIsShiftedLikeTheCommandLine) {
  write_court();
  const std::string file =
      write("open.json", R"({"world": "court.ply", "end": {"time_s": 1}, "robots": [)" + kUav + "]}");
  expect_done(file, "run");
  EXPECT_NE(read_recording(path("run/run.frontlux")).head.starts.at(0).pose.position.z(), 1.0);
  expect_done(task_of("run"), "again");
  expect_same_runs("run", "again");
}

TEST_F(TaskCommand, RefusesWhatCannotBe) {
  write_court();
  const std::string output = path("new");
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& parts) {
    const std::string file = write("bad.json", text);
    expect_refused({"--task", file, "-o", output}, joined({"--task", "bad.json: "}, parts));
  };
  const auto court_with = [&](const std::string& from, const std::string& to) {
    return test::replaced(content_of(court()), from, to);
  };
  refuse("", {"is empty"});
  refuse(R"({"name": "n"})", {"world is missing"});
  refuse(R"({"world": "castle"})", {"world is 'castle'", "frontlux world"});
  refuse(R"({"world": "court.ply", "world_seed": 3})", {"world_seed is 3", "leave it out"});
  refuse(R"({"world": "room", "method": "greedy"})", {"method is 'greedy'", "nearest"});
  refuse(R"({"world": "room", "team": "car"})", {"team: 'car' is not a team"});
  refuse(R"({"world": "room", "team": ""})", {"team: ''"});
  refuse(R"({"world": "room", "latency_s": 0})", {"latency_s is 0", "above 0"});
  refuse(R"({"world": "room", "options": {"force": "on"}})", {"'options.force' is not known", "noise"});
  refuse(R"({"world": "room", "options": {"seed": 3}})", {"'options.seed' is not known"});
  refuse(R"({"world": "room", "options": {"noise": -1}})",
         {"options.noise", "'-1' is not a number from 0 to 10"});
  refuse(R"({"world": "room", "robots": [{"file": "none.json"}]})", {"none.json"});
  // Members that contradict each other, by their names.
  const std::string lockstep = R"({"world": "room", "lockstep": true, )";
  refuse(lockstep + R"("method": "tour"})",
         {"lockstep is true, but method is 'tour'", "leave one of them out"});
  refuse(lockstep + R"("options": {"goal": "tour"}})", {"lockstep is true, but options.goal is 'tour'"});
  refuse(lockstep + R"("options": {"drift": 0.01}})", {"lockstep is true, but there is options.drift"});
  refuse(lockstep + R"("options": {"fail": "uav=3"}})", {"lockstep is true, but there is options.fail"});
  refuse(R"({"world": "room", "method": "render", "options": {"goal": "nearest"}})",
         {"method is 'render', but options.goal is 'nearest'", "leave one of them out"});
  refuse(R"({"world": "room", "method": "paper", "options": {"goal": "tour"}})",
         {"method is 'paper', but options.goal is 'tour'"});
  refuse(court_with("[6, 6, 2]", "[6, 6, 0.5]"), {"robots[0].start is [1.5,1.5,1,30], outside of box_m"});
  refuse(court_with("\"speed_m_s\": 2", "\"speed_m_s\": -2"), {"robots[0].limits.speed_m_s is -2"});
  // Boxes, before their worlds are read.
  write("none.ply", "ply");
  for (const auto& [box, part] :
       {std::pair("[[0, 0, 0], [6000, 6000, 20]]", "none.ply: 6000 x 6000 x 20 m are"),
        std::pair("[[1e6, 0, 0], [1000006, 6, 2]]", "the map ends at")})
    expect_refused({"--task",
                    write("bad.json", std::string(R"({"world": "none.ply", "resolution_m": 0.1, "box_m": )") +
                                          box + ", \"robots\": [" +
                                          test::replaced(kUav, R"(, "start": [1.5, 1.5, 1, 30])", "") + "]}"),
                    "-o", output},
                   {part});
  // What only the world shows.
  const auto refuse_in_world = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_refused({"--task", write("bad.json", text), "-o", output}, joined({"bad.json"}, parts));
  };
  refuse_in_world(court_with("[1.5, 1.5, 1, 30]", "[0.1, 1.5, 1, 30]"),
                  {"the start of the robot 'uav' is not a free place", "beyond the world's bounds"});
  refuse_in_world(
      test::replaced(court_with("[1.5, 1.5, 1, 30]", "[6, 1.5, 1, 30]"), "[6, 6, 2]", "[7.1, 6, 2]"),
      {"the start of the robot 'uav' is not a free place", "give another one"});
  refuse_in_world(
      test::replaced(court_with("\"box_m\": [[0, 0, 0], [6, 6, 2]], ", ""), "1.5, 1.5, 1,", "99, 1, 1,"),
      {"the start of the robot 'uav'", "outside the world"});
  expect_refused({"--task", path("none.json"), "-o", output}, {"--task", "none.json"});
  expect_refused({path("bad.json"), "-o", output},
                 {"bad.json: is no world; if it is a task, give it as --task "});
  expect_refused({"--task", folder_.string(), "-o", output}, {"--task", folder_.string()});
  expect_refused({"--task", court(), "-o", output, "--ground", "auto"}, {"--ground", "box"});
  expect_refused({"--task", court(), "-o", output, "--world-seed", "2"},
                 {"--world-seed", "not a built-in world"});
  expect_refused({"--task", court(), "-o", output, "--pose", "ugv=1,1,1,0"},
                 {"--pose", "its robots are uav"});
  expect_refused({"--task", court(), "--resume", output}, {"--resume", "--task"});
}

}  // namespace
}  // namespace frontlux::planner
