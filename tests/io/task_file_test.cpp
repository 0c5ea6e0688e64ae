#include "planner/recording/random_recording.hpp"
#include "support/input_test.hpp"

#include <frontlux/io/robot_file.hpp>
#include <frontlux/io/task_file.hpp>

namespace frontlux::io {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

const std::string kUav =
    R"({"name": "uav", "motion": "space", "body": {"kind": "box", "size_m": [0.4, 0.4, 0.3]}, "margin_m": 0.05, )"
    R"("limits": {"speed_m_s": 2, "acceleration_m_s2": 3, "yaw_rate_deg_s": 90, "per_axis": true}, )"
    R"("sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 73.74, "range_m": 5, "columns": 16, )"
    R"("rows": 12, "rate_hz": 20}, "start": [1, 0, 1, 45]})";
const std::string kGood =
    R"({"name": "office", "world": "office.ply", "box_m": [[-15, -15, 0], [15, 15, 2]], "resolution_m": 0.1, )"
    R"("seed": 7, "latency_s": 0.25, "lockstep": true, "method": "nearest", )"
    R"("end": {"coverage": 0.99, "time_s": 1200}, "options": {"noise": 0.02, "bumper": "off"}, "robots": [)" +
    kUav + "]}";

class TaskFile : public test::InputTest {
 protected:
  TaskFile() : InputTest([](const auto& file) { static_cast<void>(read_task(file)); }) {}

  [[nodiscard]] Task read(const std::string& text) const { return read_task(save("t.json", text)); }
};

// Member by member, and no member is left out: the binding takes all.
void expect_equal(const Task& a, const Task& b) {
  const auto& [name, world, world_seed, box, resolution, seed, latency, lockstep, method, end_coverage,
               end_time, team, robots, options] = a;
  EXPECT_EQ(name, b.name);
  EXPECT_EQ(world, b.world);
  EXPECT_EQ(world_seed, b.world_seed);
  ASSERT_EQ(box.has_value(), b.box.has_value());
  if (box) {
    EXPECT_EQ(box->min(), b.box->min());
    EXPECT_EQ(box->max(), b.box->max());
  }
  EXPECT_EQ(resolution, b.resolution);
  EXPECT_EQ(seed, b.seed);
  EXPECT_EQ(latency, b.latency);
  EXPECT_EQ(lockstep, b.lockstep);
  EXPECT_EQ(method, b.method);
  EXPECT_EQ(end_coverage, b.end_coverage);
  EXPECT_EQ(end_time, b.end_time);
  EXPECT_EQ(team, b.team);
  EXPECT_EQ(options, b.options);
  ASSERT_EQ(robots.size(), b.robots.size());
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const auto& [description, start] = robots[r];
    EXPECT_EQ(test::listed(description), test::listed(b.robots[r].description));
    ASSERT_EQ(start.has_value(), b.robots[r].start.has_value());
    if (!start) continue;
    EXPECT_EQ(start->position, b.robots[r].start->position);
    EXPECT_EQ(start->yaw, b.robots[r].start->yaw);
  }
}

TEST_F(TaskFile, ReadsAllMembers) {
  const Task task = read(kGood);
  EXPECT_EQ(task.name, "office");
  EXPECT_EQ(task.world, "office.ply");
  EXPECT_EQ(task.world_seed, std::nullopt);
  ASSERT_TRUE(task.box);
  EXPECT_EQ(task.box->min(), Eigen::Vector3d(-15, -15, 0));
  EXPECT_EQ(task.box->max(), Eigen::Vector3d(15, 15, 2));
  EXPECT_EQ(task.resolution, 0.1);
  EXPECT_EQ(task.seed, 7U);
  EXPECT_EQ(task.latency, 0.25);
  EXPECT_EQ(task.lockstep, true);
  EXPECT_EQ(task.method, TaskMethod{planner::GoalSearch::kNearest});
  EXPECT_EQ(task.end_coverage, 0.99);
  EXPECT_EQ(task.end_time, 1200.0);
  EXPECT_EQ(task.team, std::nullopt);
  EXPECT_EQ(task.options,
            (std::vector<std::pair<std::string, std::string>>{{"bumper", "off"}, {"noise", "0.02"}}));
  ASSERT_EQ(task.robots.size(), 1U);
  const planner::RobotDescription& uav = task.robots[0].description;
  EXPECT_EQ(uav.robot.name, "uav");
  EXPECT_EQ(uav.robot.travel.motion, planner::Motion::kSpace);
  EXPECT_EQ(uav.robot.travel.extents, Eigen::Vector3d(0.4, 0.4, 0.3));
  EXPECT_EQ(uav.robot.travel.margin, 0.05);
  EXPECT_EQ(uav.robot.travel.min_height, 0.15);
  EXPECT_EQ(uav.robot.limits, (planner::MotionLimits{2.0, 3.0, 90 * kDegree, true}));
  EXPECT_EQ(uav.robot.view.horizontal, 90 * kDegree);
  EXPECT_EQ(uav.rate, 20.0);
  ASSERT_TRUE(task.robots[0].start);
  EXPECT_EQ(task.robots[0].start->position, Eigen::Vector3d(1, 0, 1));
  EXPECT_EQ(task.robots[0].start->yaw, 45 * kDegree);
}

TEST_F(TaskFile, NeedsOnlyAWorld) {
  const Task task = read(R"({"world": "room"})");
  EXPECT_EQ(task.name, "t");
  EXPECT_EQ(task.world, "room");
  EXPECT_FALSE(task.world_seed || task.box || task.resolution || task.seed || task.latency || task.lockstep ||
               task.method || task.end_coverage || task.end_time || task.team);
  EXPECT_TRUE(task.robots.empty() && task.options.empty());
  EXPECT_EQ(read(R"({"world": "room", "world_seed": 18446744073709551615, "team": "2uav"})").team, "2uav");
}

TEST_F(TaskFile, TakesRobotsFromFiles) {
  write("r.json",
        R"({"name": "r", "motion": "space", "box_m": [1, 1, 0.7], "limits": {"speed_m_s": 3}, "margin_m": 0.1,
           "sensor": {"kind": "cone", "horizontal_deg": 30, "range_m": 5, "columns": 9, "rows": 1}})");
  const Task task =
      read(R"({"world": "room", "robots": [{"file": "r.json", "start": [1, 2, 3, 0]}, {"file": "r.json"}]})");
  ASSERT_EQ(task.robots.size(), 2U);
  const planner::RobotDescription& robot = task.robots[0].description;
  EXPECT_EQ(robot.robot.travel.min_height, 0.35);
  EXPECT_EQ(read_robot(path("r.json")).robot.travel.min_height, 0.35);
  EXPECT_EQ(robot.robot.travel.margin, 0.1);
  EXPECT_EQ(robot.robot.limits, (planner::MotionLimits{.speed = 3.0}));
  EXPECT_EQ(robot.rate, 10.0);
  EXPECT_EQ(task.robots[0].start->position, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(task.robots[1].start);
}

TEST_F(TaskFile, IsReadAsItWasWritten) {
  Task task;
  task.name = "a \"name\" ";
  task.world = "maze";
  task.world_seed = 3;
  task.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1.5, -2.0, 1e-3), Eigen::Vector3d(1.0 / 3.0, 7.0, 2.5));
  task.resolution = 0.17;
  task.seed = 18446744073709551615ULL;
  task.latency = 0.25;
  task.lockstep = true;
  task.method = TaskMethod{};
  task.end_coverage = 0.99;
  task.end_time = 1200.5;
  task.team = "2uav";
  task.options = {{"bumper", "off"}, {"noise", "0.02"}};
  expect_equal(read(task_text(task)), task);
  task.method = TaskMethod{planner::GoalSearch::kNearest};
  task.lockstep = false;
  expect_equal(read(task_text(task)), task);

  task.team.reset();
  task.box.reset();
  for (const auto& description : {planner::ugv_description(), planner::uav_description(),
                                  planner::uav_description(planner::Method::kPaper)})
    task.robots.push_back({description, planner::Pose{{0.1, 1.0 / 3.0, -7e-9}, -1.2345}});
  task.robots.push_back({read(kGood).robots[0].description, std::nullopt});
  planner::RobotDescription& ugv = task.robots[0].description;
  ugv.rate = 7.5;
  ugv.robot.limits = {0.5, 0.3, 0.7, true};
  ugv.robot.travel.margin = 0.07;
  ugv.robot.travel.require_ground = false;
  expect_equal(read(task_text(task)), task);
  Task robots, same;
  robots.robots = robots_of(robots_text(task.robots));
  same.robots = task.robots;
  expect_equal(robots, same);
}

TEST_F(TaskFile, ThoseThatShipAreOfThePapersRobots) {
  for (const char* world : {"room", "maze", "factory", "station"}) {
    const Task task =
        read_task(std::filesystem::path(FRONTLUX_DATA_DIR) / "tasks" / (std::string(world) + ".json"));
    EXPECT_EQ(task.world, world);
    ASSERT_EQ(task.robots.size(), 2U);
    const auto equal = [](const planner::RobotDescription& a, const planner::RobotDescription& b) {
      EXPECT_EQ(test::listed(a), test::listed(b));
      EXPECT_EQ(a.robot.limits, b.robot.limits);
      EXPECT_EQ(a.rate, b.rate);
    };
    // As in motion at 0.3 m.
    planner::RobotDescription ugv = planner::ugv_description(), uav = planner::uav_description();
    ugv.robot.travel.margin = 0.05;
    uav.robot.travel.margin = 0.025;
    equal(task.robots[0].description, ugv);
    uav.robot.travel.min_height = 0.4;  // half its height: it keeps apart from the UGV in time
    equal(task.robots[1].description, uav);
  }
}

TEST_F(TaskFile, TakesRoundBodies) {
  const auto expect_body = [&](const std::string& body, planner::BodyShape shape,
                               const Eigen::Vector3d& extents) {
    write("t.json", test::replaced(kGood, R"({"kind": "box", "size_m": [0.4, 0.4, 0.3]})", body));
    const Task task = read_task(path("t.json"));
    write("again.json", task_text(task));
    for (const Task& read : {task, read_task(path("again.json"))}) {
      const planner::TravelOptions& travel = read.robots.at(0).description.robot.travel;
      EXPECT_EQ(travel.shape, shape);
      EXPECT_EQ(travel.extents, extents);
    }
  };
  expect_body(R"({"kind": "box", "size_m": [0.5, 0.6, 0.3]})", planner::BodyShape::kBox, {0.5, 0.6, 0.3});
  expect_body(R"({"kind": "cylinder", "diameter_m": 0.5, "height_m": 0.3})", planner::BodyShape::kCylinder,
              {0.5, 0.5, 0.3});
  expect_body(R"({"kind": "sphere", "diameter_m": 0.6})", planner::BodyShape::kSphere, {0.6, 0.6, 0.6});
}

TEST_F(TaskFile, SaysWhatIsWrongAndWhatToDo) {
  const auto with = [](const std::string& from, const std::string& to) {
    return test::replaced(kGood, from, to);
  };
  const auto robots = [](const std::string& list) { return R"({"world": "room", "robots": )" + list + "}"; };
  std::string many = kUav;
  for (int i = 0; i < 32; ++i) many += ", " + kUav;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with(R"("world": "office.ply", )", ""), "world is missing; give a file relative to the task's folder"},
      {with(R"("office.ply")", "3"), "world is 3; give a file"},
      {with(R"("office.ply")", R"("a\u0000b")"), "world holds a NUL character; give a file"},
      {with(R"("office")", R"("")"), "name is ''; give 1 to 255 characters"},
      {with(R"("office")", R"("a\nb")"), "name is 'a?b'; give 1 to 255 characters"},
      {with(R"("seed": 7)", R"("seed": -7)"), "seed is -7; give a whole number from 0"},
      {with(R"("seed": 7)", R"("seed": 1.5)"), "seed is 1.5; give a whole number"},
      {with(R"("seed": 7)", R"("seed": 18446744073709551616)"), "seed is 1.8446744073709552e+19; give"},
      {with(R"("seed": 7)", R"("world_seed": "1")"), "world_seed is '1'; give a whole number"},
      {with(R"("resolution_m": 0.1)", R"("resolution_m": 0)"),
       "resolution_m is 0; give a number from 0.001 to 1000 m"},
      {with("0.25", "0"), "latency_s is 0; give a number above 0 s"},
      {with("0.25", "60.5"), "latency_s is 60.5; give a number above 0 s, at most 60 s"},
      {with("0.25", "-1"), "latency_s is -1; give a number above 0 s"},
      {with("0.25", "NaN"), "this is not JSON (after 'latency_s')"},
      {with("0.25", "Infinity"), "this is not JSON (after 'latency_s')"},
      {with("0.25", "1e999"), "a number is too large, in or after 'latency_s'"},
      {with("0.25", "null"), "latency_s is null; give"},
      {with("true, \"method\"", "1, \"method\""), "lockstep is 1; give true or false"},
      {with("nearest", "greedy"),
       R"(method is 'greedy'; give "tour", "render", "cluster", "nearest" or "paper")"},
      {with(R"("nearest")", "[]"), "method is an array of 0; give \"tour\""},
      {with("0.99", "1.01"), "end.coverage is 1.01; give a number from 0 to 1 of the observable space"},
      {with("1200", "-1"), "end.time_s is -1; give a number of at least 0 s"},
      {with("\"time_s\"", "\"time\""),
       "the member 'end.time' is not known (did you mean time_s?); known here: coverage, time_s"},
      {with(R"("seed": 7)", R"("sead": 7)"),
       "the member 'sead' is not known (did you mean seed?); known here: name, world,"},
      {with("[[-15, -15, 0], [15, 15, 2]]", "[[-15, -15, 0]]"),
       "box_m is an array of 1; give the lowest and"},
      {with("[15, 15, 2]", "[15, 15]"), "box_m[1] is an array of 2; give the lowest and"},
      {with("[15, 15, 2]", "[15, \"15\", 2]"), "box_m[1][1] is '15'; give a number from -1e+09"},
      {with("[15, 15, 2]", "[15, 15, 0]"), "box_m is [[-15,-15,0],[15,15,0]], where not every number"},
      {with("[15, 15, 2]", "[15, 15, 0.5]"),
       "robots[0].start is [1,0,1,45], outside of box_m; give a start in"},
      {with("[1, 0, 1, 45]", "[1, 0, 1]"), "robots[0].start is an array of 3; give x, y and z in metres"},
      {with("[1, 0, 1, 45]", "[1, 0, 1, true]"), "robots[0].start[3] is true; give"},
      {with("\"noise\": 0.02", "\"noise\": [1]"), "options.noise is an array of 1; give what is written"},
      {robots("[]"), "robots is an array of 0; give an array of 1 to 32 robots"},
      {robots("3"), "robots is 3; give an array"},
      {robots("[" + many + "]"), "robots is an array of 33; give an array of 1 to 32 robots"},
      {robots("[" + kUav + ", 3]"), "robots[1] is 3; give an object"},
      {robots(R"([{"file": "none.json"}])"), "robots[0].file: "},
      {robots(R"([{"file": ""}])"), "robots[0].file is ''; give the name of a robot's file"},
      {robots(R"([{"file": "t.json"}])"), "t.json: name is missing"},
      {with(R"("robots":)", R"("team": "uav", "robots":)"), "team is for a task without robots; leave one"},
      {with(R"("kind": "box")", R"("kind": "cone")"),
       R"(robots[0].body.kind is 'cone'; give "box", "cylinder" or "sphere")"},
      {with(R"("kind": "box")", R"("kind": "sphere")"), "robots[0].body.diameter_m is missing"},
      {with(R"("kind": "box", "size_m": [0.4, 0.4, 0.3])", R"("kind": "cylinder", "diameter_m": 0.5)"),
       "robots[0].body.height_m is missing"},
      {with(R"("kind": "box", "size_m": [0.4, 0.4, 0.3])",
            R"("kind": "cylinder", "diameter_m": -0.5, "height_m": 0.3)"),
       "robots[0].body.diameter_m is -0.5; give a number from 0.01"},
      {with(R"("kind": "box", "size_m": [0.4, 0.4, 0.3])",
            R"("kind": "sphere", "diameter_m": 0.5, "height_m": 0.3)"),
       "height_m"},
      {with(R"("kind": "box", )", ""), "robots[0].body.kind is missing"},
      {with(R"("kind": "box",)", R"("kind": "box", "mass": 1,)"),
       "the member 'robots[0].body.mass' is not known"},
      {with("[0.4, 0.4, 0.3]", "[0.4, 0.4, -0.3]"),
       "robots[0].body.size_m[2] is -0.3; give a number from 0.01"},
      {with(R"("body": {"kind": "box", "size_m": [0.4, 0.4, 0.3]})", R"("body": 1)"),
       "robots[0].body is 1; give {"},
      {with(R"("body": {"kind": "box", "size_m": [0.4, 0.4, 0.3]})", R"("box_m": [1, 1, 1])"),
       "robots[0].box_m is for a robot file"},
      {with(R"("margin_m": 0.05)", R"("margin_m": -1)"), "robots[0].margin_m is -1; give a number from 0"},
      {with(R"("speed_m_s": 2)", R"("speed_m_s": -2)"),
       "robots[0].limits.speed_m_s is -2; give a number from 0.001 to 1000 m/s"},
      {with(R"("acceleration_m_s2": 3)", R"("acceleration_m_s2": 0)"),
       "robots[0].limits.acceleration_m_s2 is 0"},
      {with(R"("yaw_rate_deg_s": 90)", R"("yaw_rate_deg_s": "90")"),
       "robots[0].limits.yaw_rate_deg_s is '90'"},
      {with(R"("yaw_rate_deg_s": 90)", R"("yaw_rate_deg_s": 0.05)"),  // slower than a trajectory may be
       "robots[0].limits.yaw_rate_deg_s is 0.05; give a number from 0.1"},
      {with(R"("per_axis": true)", R"("per_axis": "yes")"),
       "robots[0].limits.per_axis is 'yes'; give true or"},
      {with(R"("per_axis": true)", R"("jerk": 3)"), "the member 'robots[0].limits.jerk' is not known"},
      {with(R"("rate_hz": 20)", R"("rate_hz": 0)"), "robots[0].sensor.rate_hz is 0; give a number from 0.01"},
      {with(R"("space")", R"("hover")"), R"(robots[0].motion is 'hover'; give "plane", "ground" or "space")"},
      {with(R"("seed": 7)", R"("seed": 7, "seed": 8)"), "the member 'seed' is there twice; keep one"},
      {with(R"("rate_hz": 20)", R"("rate_hz": 20, "rows": 3)"), "the member 'rows' is there twice"},
      {with(R"("seed": 7)", R"("seed": [[[[[[1]]]]]])"), "'seed' is nested too deeply; see docs/tasks.md"},
      {with(R"("seed": 7)", R"("version": "0.1.0", "task": {"robots": [{"body": {"size_m": [1]}}]})"),
       "holds the results of a run; save its member task alone"},
      {std::string(200'000, '['), "is nested too deeply"},
      {with("[1, 0, 1, 45]", "[" + std::string(100'000, '1') + "]"), "is too large"},
      {with("7,", "7 " + std::string(1 << 20, ' ') + ","),
       "too many for a task; give a description of at most 1048576"},
      {"", "is empty"},
      {"[]", "holds an array of 0 and no object; describe a task between { and }, see docs/tasks.md"},
      {kGood + "x", "this is not JSON"},
      {kGood + std::string("\n\0, x", 5), "line 2, column 1: there is a NUL byte"},
      {kGood.substr(0, 3) + '\0' + kGood.substr(3), "line 1, column 4: there is a NUL byte"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string what = complaint("t.json", text);
    test::expect_parts(what, {expected});
    for (const char c : what) EXPECT_TRUE(c >= ' ' && c <= '~') << what;
  }
  EXPECT_THROW(static_cast<void>(read_task(folder_ / "none.json")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(read_task(folder_)), std::runtime_error);
}

TEST_F(TaskFile, SurvivesEveryTruncationAndFlippedByte) {
  for (std::size_t i = 0; i < kGood.size(); ++i) EXPECT_NE(complaint("t.json", kGood.substr(0, i)), "") << i;
  for (std::size_t i = 0; i < kGood.size(); ++i)
    for (const int bit : {0, 3, 7}) {
      std::string damaged = kGood;
      damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ (1U << bit));
      test::complaint_of<std::runtime_error>([&] { static_cast<void>(task_text(read(damaged))); });
    }
}

}  // namespace
}  // namespace frontlux::io
