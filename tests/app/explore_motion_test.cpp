// `frontlux explore` in motion: what its files say of times, ways and safety, and how it goes on.

#include "app/explore_motion.hpp"

#include "sim/mesh/box_mesh.hpp"
#include "support/plain_revisits.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/recorded_map.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <numeric>
#include <variant>

namespace frontlux::planner {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::ExploreMotion;
using test::joined;
using test::Table;

TEST_F(ExploreMotion, ItsFilesAgree) {
  constexpr double kSeconds = 7.0, kLatency = 0.15;
  expect_answer(joined(quick("run", "7"), {"--latency", "0.15", "--bumper", "off"}), {"contacts     0"});
  const nlohmann::json json = json_in("run");
  const Recording recording = read_recording(path("run/run.frontlux"));
  EXPECT_EQ(json.at("end"), "time_limit");
  EXPECT_EQ(json.at("lockstep"), false);
  EXPECT_EQ(json.at("latency_s"), kLatency);
  const std::vector<std::string> names = {"one", "two"};
  EXPECT_EQ(json.at("robots"), names);

  // A row for each planning: all steps but the start and the end.
  const Table events(path("run/events.csv"));
  EXPECT_EQ(content_of(path("run/events.csv")).substr(0, 20), "time_s,step,robot,re");
  ASSERT_EQ(events.size(), recording.steps.size() - 2);
  EXPECT_GT(events.size(), 10U);
  std::vector<double> planning;
  int in_time = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const ExplorationStep& step = recording.steps[i + 1].step;
    EXPECT_EQ(events.number(i, "step"), static_cast<double>(i + 1));
    EXPECT_EQ(events.number(i, "time_s"), step.time);
    const std::string& name = events.text(i, "robot");
    const std::size_t robot = name == "one" ? 0 : 1;
    EXPECT_EQ(name, names[robot]);
    EXPECT_EQ(events.text(i, "reason") == "start", i < 2) << "the first planning of each";
    EXPECT_EQ(events.text(i, "goal_state"), name_of(step.robots[robot].goal.state));
    const double begin = events.number(i, "begin_s");
    EXPECT_LE(begin, step.time + kLatency + 1e-9);
    in_time += std::abs(begin - step.time - kLatency) < 1e-9 ? 1 : 0;
    EXPECT_GE(events.number(i, "end_s"), begin);
    EXPECT_GE(events.number(i, "length_m"), 0.0);
    EXPECT_EQ(events.number(i, "planning_s"), step.planning_seconds());
    planning.push_back(step.planning_seconds());
  }
  EXPECT_GT(in_time, static_cast<int>(events.size()) / 2) << "most plannings give a new trajectory";

  // The tours: the first stop of each planning is the robot's goal.
  const Table tours(path("run/tours.csv"));
  std::size_t firsts = 0, chosen = 0, moved = 0;
  std::array<std::pair<Eigen::Vector3d, double>, 2> goals{};
  for (std::size_t i = 0; i < tours.size(); ++i) {
    const auto number = static_cast<std::size_t>(tours.number(i, "stop"));
    ASSERT_EQ(number, number == 1 ? 1U : static_cast<std::size_t>(tours.number(i - 1, "stop")) + 1);
    EXPECT_GE(tours.number(i, "clusters"), 1.0);
    if (number > 1) continue;
    const planner::ExplorationStep& step =
        recording.steps[static_cast<std::size_t>(tours.number(i, "step"))].step;
    const auto robot = tours.text(i, "robot") == names[0] ? 0U : 1U;
    ASSERT_TRUE(step.robots[robot].goal.pose.has_value());
    // A stop that it keeps has the pose and the gain that it was chosen for; others may have shared it out
    // anew, and found another viewpoint.
    const double gain = step.robots[robot].goal.gain;
    const auto goal = std::pair<Eigen::Vector3d, double>(step.robots[robot].goal.pose->position, gain);
    const bool keeps = std::exchange(goals[robot], goal) == goal;
    moved += tours.point(i, "", "_m") != step.robots[robot].goal.pose->position ? 1 : 0;
    if (!keeps) {
      EXPECT_EQ(tours.point(i, "", "_m"), step.robots[robot].goal.pose->position);
      EXPECT_EQ(tours.number(i, "yaw_rad"), step.robots[robot].goal.pose->yaw);
      EXPECT_EQ(tours.number(i, "frontiers"), gain) << i;
      ++chosen;
    }
    ++firsts;
  }
  EXPECT_GT(firsts, 5U);
  EXPECT_GT(2 * chosen, firsts);
  EXPECT_LE(10 * moved, firsts);

  // A hundred rows a second for each robot: within its limits, and as fast as its places say.
  const Table motion(path("run/motion.csv"));
  ASSERT_GE(motion.size(), 2 * static_cast<std::size_t>(kSeconds * 100));
  std::vector<double> metres(2);
  std::vector<std::vector<Eigen::Vector3d>> went(2);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < motion.size(); ++i) {
    ASSERT_EQ(motion.text(i, "robot"), names[i % 2]);
    ASSERT_NEAR(motion.number(i, "time_s"), static_cast<double>(i / 2) / 100, 1e-9);
    const Eigen::Vector3d at = motion.point(i, "", "_m"), velocity = motion.point(i, "v", "_m_s");
    went[i % 2].push_back(at);
    ASSERT_LE(velocity.norm(), 2.0 * 1.001);
    ASSERT_LE(std::abs(motion.number(i, "yaw_rate_rad_s")), std::numbers::pi / 2 * 1.001);
    if (i < 2) {
      EXPECT_EQ(at, recording.head.starts[i].pose.position);
      continue;
    }
    const Eigen::Vector3d step = at - motion.point(i - 2, "", "_m");
    const Eigen::Vector3d mean = (velocity + motion.point(i - 2, "v", "_m_s")) / 2;
    ASSERT_LT((step / 0.01 - mean).norm(), 3.0 * 0.01)
        << "half of what it can gain in a hundredth of a second";
    metres[i % 2] += step.norm();
    if (i % 2 == 0) continue;
    const Eigen::AlignedBox3d body(Eigen::Vector3d(-0.35, -0.35, -0.25), Eigen::Vector3d(0.35, 0.35, 0.25));
    nearest = std::min(nearest,
                       body.translated(at).exteriorDistance(body.translated(motion.point(i - 1, "", "_m"))));
  }
  // run.json against both.
  const nlohmann::json& by_robot = json.at("by_robot");
  double idle = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_NEAR(by_robot.at(names[r]).at("length_m"), metres[r], 0.02 * metres[r]);
    EXPECT_GT(metres[r], 2.0);
    EXPECT_NEAR(by_robot.at(names[r]).at("revisited"), test::plain_revisited_part(went[r]), 0.02);
    EXPECT_NEAR(json.at("path_length_m").at(names[r]), metres[r], 0.05 * metres[r]);
    EXPECT_EQ(by_robot.at(names[r]).at("held_back"), 0);
    const Pose& start = recording.head.starts[r].pose;
    const std::vector<double> place{start.position.x(), start.position.y(), start.position.z(), start.yaw};
    EXPECT_EQ(by_robot.at(names[r]).at("start"), place);
    idle += by_robot.at(names[r]).at("idle_s").get<double>();
  }
  constexpr double kTick = 0.02;  // [s] one in which a robot sets out is not idle
  EXPECT_GE(idle, 2 * (kLatency - kTick)) << "both wait for their first planning";
  EXPECT_LT(idle, 2 * kSeconds);
  EXPECT_NEAR(json.at("separation_min_m"), nearest, 0.05);
  EXPECT_GT(json.at("separation_min_m"), 0.0);
  EXPECT_GT(json.at("clearance_min_m"), 0.0);
  EXPECT_LT(json.at("clearance_min_m"), 1.0);
  EXPECT_EQ(json.at("contacts"), 0);
  EXPECT_NEAR(
      json.at("path_length_total_m"),
      json.at("path_length_m").at("one").get<double>() + json.at("path_length_m").at("two").get<double>(),
      1e-9);
  EXPECT_EQ(json.at("unseen"), nullptr) << "it has not ended by itself";
  std::sort(planning.begin(), planning.end());
  const auto place = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(planning.size()))) - 1;
  EXPECT_EQ(json.at("planning_p99_s"), planning[place]);
  EXPECT_EQ(json.at("planning_max_s"), planning.back());
  EXPECT_NEAR(json.at("planning_mean_s"),
              std::accumulate(planning.begin(), planning.end(), 0.0) / static_cast<double>(planning.size()),
              1e-12);

  // Times and the area under the curve lie between what the steps around them say.
  const Table steps(path("run/steps.csv"));
  double low = 0.0, high = 0.0;
  for (std::size_t i = 2; i < steps.size(); i += 2) {
    const double passed = steps.number(i, "time_s") - steps.number(i - 2, "time_s");
    EXPECT_GE(passed, 0.0);
    low += passed * steps.number(i - 2, "coverage_observable");
    high += passed * steps.number(i, "coverage_observable");
  }
  const double end = json.at("time_s").at("end");
  EXPECT_GE(end, kSeconds);
  EXPECT_LT(end, kSeconds + 0.2);
  EXPECT_EQ(steps.number(steps.size() - 1, "time_s"), end);
  EXPECT_GE(json.at("auc"), low / end - 1e-9);
  EXPECT_LE(json.at("auc"), high / end + 1e-9);
  EXPECT_GT(high, low);
  ASSERT_GE(steps.number(steps.size() - 1, "coverage_observable"), 0.5);
  const double half = json.at("time_s").at("50");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_TRUE(steps.number(i, "time_s") >= half || steps.number(i, "coverage_observable") < 0.5);
    EXPECT_TRUE(steps.number(i, "time_s") < half || steps.number(i, "coverage_observable") >= 0.5);
  }
  EXPECT_NEAR(json.at("explored_m3"),
              json.at("coverage_box").get<double>() * static_cast<double>(recording.head.bounding) * 0.027,
              1e-6);
}

TEST_F(ExploreMotion, EndsWhenEnoughIsMapped) {
  expect_answer(joined(quick("run", "60"), {"--stop-coverage", "0.3"}), {"\nend          coverage"});
  const nlohmann::json json = json_in("run");
  EXPECT_EQ(json.at("end"), "coverage");
  EXPECT_GE(json.at("coverage_observable"), 0.3);
  EXPECT_LT(json.at("coverage_observable"), 0.6) << "it ends at once";
  EXPECT_FALSE(json.at("time_s").contains("90"));
}

// The times that plannings took are of this machine, so the latency says which run is warned of.
TEST_F(ExploreMotion, WarnsWhenPlanningTakesLongerThanTheClockCharges) {
  const auto warned = [&](const std::string& latency, const std::string& plannings) {
    const test::Answer answer =
        run(joined(quick("run", "60"), {"--latency", latency, "--max-steps", plannings, "--force"}));
    EXPECT_EQ(answer.code, 0) << answer.err;
    const nlohmann::json json = json_in("run");
    const bool slow = json.at("planning_p99_s") > json.at("latency_s") && json.at("steps") >= 20;
    EXPECT_EQ(json.at("warnings").size(), slow ? 1U : 0U);
    EXPECT_EQ(answer.err, slow ? "warning: " + json.at("warnings").at(0).get<std::string>() + "\n" : "");
    return answer.err;
  };
  test::expect_parts(warned("1e-6", "20"), {"99 % of the plannings took up to ",
                                            "the clock charges 1e-06 s for each", "explore with --latency "});
  EXPECT_EQ(warned("1e-6", "19"), "") << "so few do not tell";
  EXPECT_EQ(warned("60", "20"), "");
}

// All robots' goals are below such an epsilon, in three plannings each.
TEST_F(ExploreMotion, WarnsWhenItEndsFarFromDone) {
  const test::Answer answer =
      run(joined(quick("run", "60"), {"--goal", "render", "--latency", "1", "--epsilon", "1e6"}));
  EXPECT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json json = json_in("run");
  EXPECT_EQ(json.at("end"), "low_gain");
  EXPECT_LT(json.at("coverage_observable"), 0.9);
  // Where the rest is.
  double unseen = 0.0;
  for (const char* where : {"in_view", "narrow", "hidden"}) {
    const double part = json.at("unseen").at(where);
    EXPECT_GE(part, 0.0) << where;
    unseen += part;
  }
  EXPECT_EQ(json.at("unseen").size(), 3U);
  EXPECT_NEAR(unseen, 1.0 - json.at("coverage_observable").get<double>(), 1e-6);
  test::expect_parts(answer.out, {"low_gain: expected gain stayed below 1e+06 frontiers 3 times in a row\n"});
  test::expect_parts(answer.err, {"warning: the run has ended with ", " of the observable space mapped"});
  test::expect_parts(json.at("warnings").at(0), {"the run has ended with "});
}

// Shut in at its start by what its sensor makes up, or with a sensor that does not reach the next voxel.
TEST_F(ExploreMotion, SaysWhyARobotThatNeverMovesDoesNot) {
  const auto warning = [&](const std::string& output, const std::vector<std::string>& words) {
    const test::Answer answer = run(joined({"room", "--report", "off", "-o", path(output)}, words));
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(json_in(output).at("end"), "nothing_to_do");
    return json_in(output).at("warnings").at(0).get<std::string>();
  };
  test::expect_parts(warning("stray", {"--stray", "0.02"}),
                     {"the run has ended with ", "; ugv: no goal: ", "; uav: no goal: ",
                      "; stray returns (--stray 0.02) close space to robots"});
  write("near.json",
        R"({"name": "near", "motion": "space", "box_m": [0.5, 0.5, 0.3], "sensor": {"kind": "camera",
      "horizontal_deg": 90, "vertical_deg": 70, "range_m": 0.05, "columns": 16, "rows": 12}})");
  test::expect_parts(
      warning("near", {"--team", "", "--robot", path("near.json")}),
      {"; near: no goal: ", " are hidden from everywhere, or out of the reach of their sensors"});
  const std::string failed = warning("failed", {"--fail", "ugv=0.5,uav=0.5"});
  EXPECT_EQ(failed.find("could have been seen"), std::string::npos);
  test::expect_parts(failed, {": all robots have failed"});
}

TEST_F(ExploreMotion, ContactsAreJudgedByTheMap) {
  const std::vector<std::string> words = {
      wires(), "--start=-2.5,0.1,1.5", "--team", "",         "--robot", slow_camera(), "--bumper",
      "off",   "--stop-time",          "25",     "--report", "off"};
  const test::Answer answer = run(joined(words, {"-o", path("run")}));
  EXPECT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json json = json_in("run");
  const std::uint64_t contacts = json.at("contacts"), in_free = json.at("contacts_in_free");
  EXPECT_GT(in_free, 0U);
  EXPECT_LE(in_free, contacts);
  test::expect_parts(answer.out,
                     {"contacts     " + std::to_string(contacts) + ", " + std::to_string(in_free) +
                      " with surfaces in free voxels, least clearance 0.00 m"});
  ASSERT_EQ(run(joined(words, {"--lockstep", "-o", path("steps")})).code, 0);
  EXPECT_EQ(json_in("steps").at("contacts_in_free"), nullptr) << "not judged in lock-step";
}

// The wires stop the robot between two scans, a quarter of a second apart. What is written down of its motion
// ends at the contact, and does not go on to the scan and jump back.
TEST_F(ExploreMotion, MotionEndsWhereABumperStopsIt) {
  const std::vector<std::string> words = {
      wires(), "--start=-2.5,0.1,1.5", "--team", "", "--robot", slow_camera(), "--report", "off", "--threads",
      "1"};
  expect_answer(joined(words, {"--stop-time", "25", "-o", path("run")}));
  ASSERT_GT(json_in("run").at("held_back"), 0);
  const auto expect_no_jump = [&](const std::string& run) {
    const Table motion(path(run + "/motion.csv"));
    for (std::size_t i = 1; i < motion.size(); ++i) {
      const Eigen::Vector3d step = motion.point(i, "", "_m") - motion.point(i - 1, "", "_m");
      const double speed =
          std::max(motion.point(i, "v", "_m_s").norm(), motion.point(i - 1, "v", "_m_s").norm());
      ASSERT_LE(step.norm(), 0.0101 * speed) << run << " at " << motion.number(i, "time_s") << " s";
    }
  };
  expect_no_jump("run");
  // In two parts it is the same, and so it is up to where a run is cut off.
  ASSERT_EQ(run(joined(words, {"--stop-time", "25", "--max-steps", "12", "-o", path("parts")})).code, 0);
  ASSERT_EQ(run({"--resume", path("parts"), "--max-steps", "1000000", "--report", "off"}).code, 0);
  expect_same_motions("run", "parts");
}

TEST_F(ExploreMotion, RobotsFailAndDriftAndAreHeardLateAsAsked) {
  const auto words = [&](const std::string& output, const std::string& seconds) {
    return joined(quick(output, seconds),
                  {"--fail", "two=3", "--drift", "0.02", "--fix-every", "2", "--scan-delay", "0.5",
                   "--scan-loss", "0.1", "--tracking-error", "0.1"});
  };
  const test::Answer answer = run(joined(words("run", "6"), {"--threads", "1"}));
  EXPECT_EQ(answer.code, 0);
  EXPECT_NE(answer.out.find("failed after 3"), std::string::npos) << answer.out;
  EXPECT_NE(answer.err.find("warning: the robot 'two' failed after 3"), std::string::npos) << answer.err;
  const nlohmann::json json = json_in("run");
  EXPECT_FALSE(json.at("by_robot").at("one").contains("failed_s"));
  EXPECT_NEAR(json.at("by_robot").at("two").at("failed_s").get<double>(), 3.0, 0.2);
  EXPECT_EQ(json.at("task").at("options").at("fail"), "two=3");
  EXPECT_EQ(json.at("task").at("options").at("drift"), "0.02");
  EXPECT_EQ(json.at("task").at("options").at("scan-delay"), "0.5");
  EXPECT_EQ(json.at("task").at("options").at("scan-loss"), "0.1");
  EXPECT_GT(json.at("map").at("surface_found"), 0.1);
  EXPECT_GT(json.at("map").at("false_free"), 0.0);
  const Table events(path("run/events.csv"));
  for (std::size_t i = 0; i < events.size(); ++i)
    EXPECT_TRUE(events.number(i, "time_s") < 3.2 || events.text(i, "robot") == "one");
  // The same on more threads, and in two parts.
  ASSERT_EQ(run(joined(words("threads", "6"), {"--threads", "2"})).code, 0);
  expect_same_motions("run", "threads");
  ASSERT_EQ(run(joined(words("parts", "6"), {"--max-steps", "12"})).code, 0);
  ASSERT_EQ(run({"--resume", path("parts"), "--max-steps", "1000000", "--report", "off"}).code, 0);
  EXPECT_TRUE(content_of(path("run/motion.csv")) == content_of(path("parts/motion.csv")));
}

// After 28 s, when it had mapped a twelfth, this team once ended its run: two robots rested in the third
// one's way.
// Half of what the voxels around a body leave it to each side, so that no voxel more has to be free.
TEST_F(ExploreMotion, TheTeamKeepsMarginsForWhichItsVoxelsHaveRoom) {
  const auto margins = [&](const std::string& resolution, const std::vector<std::string>& more) {
    const std::string name = "margins" + resolution + std::to_string(more.size());
    expect_answer(joined({"room", "--resolution", resolution, "--report", "off", "-o", path(name)}, more));
    std::vector<double> found;
    for (const planner::RobotDescription& robot : read_recording(path(name + "/run.frontlux")).head.robots)
      found.push_back(robot.robot.travel.margin);
    return found;  // of the UGV, which comes first, and the UAV
  };
  const std::vector<std::string> short_run{"--stop-time", "0.5"};
  EXPECT_EQ(margins("0.3", short_run), (std::vector<double>{0.05, 0.025}));
  EXPECT_EQ(margins("0.2", short_run), (std::vector<double>{0.0, 0.05}));
  EXPECT_EQ(margins("0.3", {"--lockstep", "--max-steps", "1"}), (std::vector<double>{0.0, 0.0}));
}

TEST_F(ExploreMotion, ALimitOfNoPlanningsIsKept) {
  expect_answer(joined(quick("run", "60"), {"--max-steps", "0"}), {"step_limit"});
  EXPECT_EQ(json_in("run").at("steps"), 0);
  expect_answer({"--resume", path("run"), "--max-steps", "2"});
  EXPECT_EQ(json_in("run").at("steps"), 2);
}

TEST_F(ExploreMotion, RobotsInEachOthersWayDoNotEndARun) {
  expect_answer({"maze", "--seed", "1", "--team", "3uav", "--latency", "0.25", "--stop-time", "45",
                 "--report", "off", "-o", path("run")});
  EXPECT_EQ(json_in("run").at("end"), "time_limit");
  EXPECT_GT(json_in("run").at("coverage_observable"), 0.1);
}

// Runs that end by themselves have mapped their world: nobody gave up early, or was in another one's way.
TEST_F(ExploreMotion, LongRunsMapTheirWorld) {
  for (const char* world : {"maze", "factory"})
    for (const char* seed : {"1", "9"})
      for (const char* team : {"uav", "3uav", "uav+ugv"}) {
        SCOPED_TRACE(std::string(world) + " " + seed + " " + team);
        expect_answer({world, "--seed", seed, "--team", team, "--latency", "0.25", "--report", "off",
                       "--force", "-o", path("run")});
        EXPECT_EQ(json_in("run").at("end"), "nothing_to_do");
        EXPECT_GT(json_in("run").at("coverage_observable"), 0.99);
      }
}

// A goal of low gain counts when it is chosen, and not again at each planning until the robot is there: this
// run once ended on its way to one, at 62 %.
TEST_F(ExploreMotion, GoalsOfLowGainAreReachedBeforeTheEnd) {
  expect_answer({"room", "--team", "ugv", "--goal", "cluster", "--report", "off", "-o", path("run")});
  EXPECT_GT(json_in("run").at("coverage_observable"), 0.98);
}

// Ten frontiers are more than a place shows if voxels are large, or if a sensor is short: these runs ended at
// once.
TEST_F(ExploreMotion, LargeVoxelsAndShortSensorsHaveSomethingToDo) {
  const auto robot = [&](const std::string& range) {
    return write("robot" + range + ".json",
                 R"({"name": "uav", "motion": "space", "body": {"kind": "box", "size_m": [0.4, 0.4, 0.3]},
    "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72, "range_m": )" +
                     range + R"(, "columns": 48, "rows": 36, "rate_hz": 4}})");
  };
  for (const char* resolution : {"0.6", "0.8", "1"}) {
    expect_answer({"room", "--team", "", "--robot", robot("10"), "--resolution", resolution, "--report",
                   "off", "--force", "-o", path("run")});
    EXPECT_GT(json_in("run").at("coverage_observable"), 0.97) << resolution;
  }
  expect_answer({"room", "--team", "", "--robot", robot("1"), "--stop-time", "40", "--report", "off",
                 "--force", "-o", path("run")});
  EXPECT_EQ(json_in("run").at("end"), "time_limit");
}

TEST_F(ExploreMotion, EndsInTimeIfNoScanArrives) {
  expect_answer(joined(quick("run", "3"), {"--scan-loss", "1"}));
  EXPECT_EQ(json_in("run").at("end"), "time_limit");
  EXPECT_NEAR(json_in("run").at("time_s").at("end").get<double>(), 3.0, 0.2);
  // The map is that of the start, for all that the robots have planned and done.
  const Recording recording = read_recording(path("run/run.frontlux"));
  ASSERT_GT(recording.steps.size(), 4U);
  RecordedMap start(recording.head.resolution);
  start.apply(recording.steps[0]);
  EXPECT_GT(recording.steps[0].step.robots[0].changed.size(), 0U);
  const auto map = std::get<std::shared_ptr<octomap::OcTree>>(read_octree(path("run/map.ot")));
  EXPECT_TRUE(make_voxel_grid(*map) == start.grid());
}

TEST_F(ExploreMotion, GoesOnWithARecordingThatWasCutOffAnywhere) {
  expect_answer(quick("whole", "5"));
  // In the middle of a step, and at the very end.
  const std::string bytes = content_of(path("whole/run.frontlux"));
  for (const std::size_t size : {bytes.size() * 2 / 3, bytes.size()}) {
    SCOPED_TRACE(size);
    fs::remove_all(path("cut"));
    fs::create_directory(path("cut"));
    write("cut/run.frontlux", bytes.substr(0, size));
    expect_resumed("cut", {"--threads", "1"});
    expect_same_motions("whole", "cut");
  }
}

TEST_F(ExploreMotion, RefusesWrongTimesAndParts) {
  const auto refuses = [&](const char* option, const std::vector<std::string>& values) {
    for (const std::string& value : values)
      expect_refused({"room", "-o", path("new"), option, value}, {option + std::string(": '") + value});
  };
  refuses("--latency", {"0", "-0.1", "nan", "inf", "1s", ""});
  refuses("--stop-coverage", {"-0.1", "1.01", "nan", "50%", ""});
  refuses("--stop-time", {"-1", "nan", "inf", "1h", ""});
}

// Cameras see floor and ceiling askew only, and would leave holes of some square metres in them.
TEST_F(ExploreMotion, LeavesNoHolesInPlainRooms) {
  sim::write_ply(path("tiny.ply"),
                 sim::test::box_mesh({Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(2, 2, 2.5F)}));
  expect_answer(
      {path("tiny.ply"), "--team", "uav", "--start", "1,1,1.2", "--report", "off", "-o", path("tiny")});
  EXPECT_GT(json_in("tiny").at("coverage_observable"), 0.98) << "all that is left is small here";
  sim::write_ply(path("plain.ply"),
                 sim::test::box_mesh({Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(6, 4.5F, 3)}));
  int rooms = 0;
  for (const std::string start : {"3,2.25,1", "2,2,1.5"}) {
    const std::string output = "run" + std::to_string(++rooms);
    expect_answer(
        {path("plain.ply"), "--team", "uav", "--start", start, "--report", "off", "-o", path(output)});
    EXPECT_GT(json_in(output).at("coverage_observable"), 0.995) << start;
    EXPECT_EQ(json_in(output).at("end"), "nothing_to_do");
  }
}

}  // namespace
}  // namespace frontlux::planner
