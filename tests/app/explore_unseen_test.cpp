// `frontlux explore` where a part of the world is behind an opening that is too narrow: who is told by how
// much.

#include "app/explore_command.hpp"
#include "sim/mesh/box_mesh.hpp"

#include <frontlux/sim/mesh_file.hpp>

namespace frontlux::test {
namespace {

using Eigen::Vector3f;
using nlohmann::json;

std::string percents(const json& part) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << 100.0 * part.get<double>() << " %";
  return text.str();
}

class ExploreUnseen : public ExploreCommand {
 protected:
  // A cube in space, in a room of 5 x 4 x 2.2 m beside another one, with 0.6 m between the ends of the thick
  // wall that divides them: on voxels of 0.2 m the opening is at y from 2 to 2.6 m, three voxels wide.
  [[nodiscard]] Answer explore(const std::string& output, const std::string& edge, bool into_closet,
                               const std::vector<std::string>& more = {}) const {
    const float end = into_closet ? 6.0F : 6.4F;
    sim::World world;
    sim::test::add_box(world.mesh, {Vector3f(0.0F, 0.0F, 0.0F), Vector3f(end, 4.0F, 2.2F)});
    sim::test::add_box(world.mesh,
                       {Vector3f(5.0F, 0.0F, 0.0F), Vector3f(into_closet ? end : 5.6F, 2.0F, 2.2F)});
    sim::test::add_box(world.mesh, {Vector3f(5.0F, 2.6F, 0.0F), Vector3f(5.6F, 4.0F, 2.2F)});
    sim::write_ply(path("rooms.ply"), world.mesh);
    write("cube.json",
          R"({"name": "cube", "motion": "space", "margin_m": 0, "body": {"kind": "box", "size_m": [)" + edge +
              ", " + edge + ", " + edge + R"(]}, "limits": {"speed_m_s": 2},
      "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 90, "range_m": 8, "columns": 64,
                 "rows": 64, "rate_hz": 8}})");
    return run(joined({path("rooms.ply"), "--start", "1.5,2,1.1", "--ground", "off", "--resolution", "0.2",
                       "--team", "", "--robot", path("cube.json"), "--report", "off", "-o", path(output)},
                      more));
  }
};

TEST_F(ExploreUnseen, TellsByHowMuchARobotIsTooLarge) {
  const Answer answer = explore("run", "0.9", true);
  ASSERT_EQ(answer.code, 0) << answer.err;
  const json run = json_in("run"), cube = run.at("unseen_why").at("cube");
  EXPECT_EQ(run.at("unseen_why").size(), 1U);
  EXPECT_EQ(cube.at("narrow_by_m"), 0.3) << "0.9 m in three voxels of 0.2 m";
  const double narrow = run.at("unseen").at("narrow"), then = cube.at("in_view_then");
  EXPECT_GT(then, 0.9 * narrow) << "all of the other room";
  EXPECT_LE(then, narrow);
  EXPECT_EQ(cube.at("without_min_height"), 0.0);
  EXPECT_GT(run.at("coverage_observable"), 0.95);
  EXPECT_GT(narrow, 0.01);
  const std::string openings = percents(then) + " behind openings that are 0.3 m too narrow for cube";
  const std::string seen_by =
      percents(narrow) + " of the observable space are where only smaller robots see them: ";
  expect_parts(answer.out, {"\nunseen       " + percents(narrow) + " where only smaller robots see it (" +
                            openings + "), "});
  expect_parts(answer.err,
               {"warning: " + seen_by + openings + ", in voxels of 0.2 m; finer ones (--resolution) "});
  expect_parts(run.at("warnings").at(0), {seen_by});
  EXPECT_EQ(answer.err.find("the run has ended with"), std::string::npos) << "so much is mapped";
}

TEST_F(ExploreUnseen, TellsItBesideThatMuchIsLeft) {
  const Answer answer = explore("run", "0.9", false);
  const json run = json_in("run");
  EXPECT_LT(run.at("coverage_observable"), 0.95);
  expect_parts(run.at("warnings").at(0), {"the run has ended with ", "; cube: no goal: "});
  expect_parts(run.at("warnings").at(1), {" behind openings that are 0.3 m too narrow for cube"});
  // A finished run says what each robot was about last.
  const std::string goal = run.at("by_robot").at("cube").at("goal");
  EXPECT_TRUE(goal.starts_with("no goal: ")) << goal;
  expect_parts(answer.out, {"\ncube         travelled ", " times; " + goal + "\n"});
}

TEST_F(ExploreUnseen, TellsThatRaysLeaveHolesBesideThatMuchIsLeft) {
  ASSERT_EQ(explore("dense", "0.9", false).code, 0);
  const std::string dense = json_in("dense").at("warnings").at(0);
  EXPECT_EQ(dense.find("rays of"), std::string::npos) << "0.25 m apart: " << dense;
  std::string text = test::content_of(path("cube.json"));
  text.replace(text.find(R"("columns": 64)"), 13, R"("columns": 32)");
  write("few.json", text);
  const Answer answer =
      run({path("rooms.ply"), "--start", "1.5,2,1.1", "--ground", "off", "--resolution", "0.2", "--team", "",
           "--robot", path("few.json"), "--report", "off", "-o", path("few")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  expect_parts(json_in("few").at("warnings").at(0),
               {"; the rays of cube are 0.50 m apart at its range, and leave holes between them in voxels of "
                "0.2 m"});
}

TEST_F(ExploreUnseen, TellsThatARobotStartsFarFromWhereItWasAskedTo) {
  ASSERT_EQ(explore("run", "0.9", true, {"--stop-time", "0.5"}).code, 0);
  EXPECT_EQ(json_in("run").at("warnings"), json::array());
  // At the end of a corridor that is too narrow for it.
  sim::World world;
  for (const auto& [low, high] : {std::pair(Vector3f(0.0F, 0.0F, 0.0F), Vector3f(8.0F, 3.0F, 2.2F)),
                                  {Vector3f(4.0F, 0.0F, 0.0F), Vector3f(8.0F, 1.2F, 2.2F)},
                                  {Vector3f(4.0F, 1.8F, 0.0F), Vector3f(8.0F, 3.0F, 2.2F)}})
    sim::test::add_box(world.mesh, {low, high});
  sim::write_ply(path("corridor.ply"), world.mesh);
  const std::vector<std::string> there = {path("corridor.ply"),
                                          "--start",
                                          "7.5,1.5,1.1",
                                          "--ground",
                                          "off",
                                          "--resolution",
                                          "0.2",
                                          "--team",
                                          "",
                                          "--robot",
                                          path("cube.json"),
                                          "--report",
                                          "off",
                                          "--stop-time",
                                          "0.5",
                                          "-o",
                                          path("far")};
  ASSERT_EQ(run(there).code, 0);
  const json warnings = json_in("far").at("warnings");
  ASSERT_EQ(warnings.size(), 1U);
  expect_parts(warnings.at(0), {"'cube' has started at 3.", " m from the start that was given"});
}

TEST_F(ExploreUnseen, TellsNothingOfRobotsThatFit) {
  const Answer answer = explore("run", "0.5", true);
  ASSERT_EQ(answer.code, 0) << answer.err;
  const json run = json_in("run");
  EXPECT_EQ(run.at("end"), "nothing_to_do");
  EXPECT_LT(run.at("unseen").at("narrow"), 0.01);
  EXPECT_EQ(run.at("unseen_why"), json::object());
  expect_parts(answer.out, {" where only smaller robots see it, "});
  EXPECT_EQ(answer.err.find("smaller robots"), std::string::npos) << answer.err;
}

TEST_F(ExploreUnseen, TellsHowMuchLiesOutsideTheBoxOfATask) {
  ASSERT_EQ(explore("whole", "0.5", true).code, 0);
  EXPECT_EQ(json_in("whole").at("surface_out_of_bounds"), 0.0);
  write("first.json", R"({"world": "rooms.ply", "box_m": [[0, 0, 0], [5, 4, 2.2]], "resolution_m": 0.2,
      "robots": [{"name": "cube", "motion": "space", "body": {"kind": "box", "size_m": [0.5, 0.5, 0.5]},
                  "start": [1.5, 2, 1.1, 0],
                  "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 90, "range_m": 8,
                             "columns": 64, "rows": 64, "rate_hz": 8}}]})");
  const Answer answer = run({"--task", path("first.json"), "--report", "off", "-o", path("first")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  // Of floor and ceiling 40 m2, of the walls along x 22 m2, and 8.8 m2 and 7.48 m2 of those across it are in
  // the first room: 78.28 of 119.68 m2. The box counts as 0.1 mm larger, which holds 0.003 m2 more.
  const double out = json_in("first").at("surface_out_of_bounds");
  EXPECT_NEAR(out, 1.0 - 78.28 / 119.68, 5e-5);
  expect_parts(answer.out, {"\noutside      " + percents(out) + " of the world's surface"});
}

TEST_F(ExploreUnseen, IsNotAskedOfARunThatHasNotEndedByItself) {
  ASSERT_EQ(explore("run", "0.9", false, {"--stop-time", "0.5"}).code, 0);
  EXPECT_EQ(json_in("run").at("end"), "time_limit");
  EXPECT_EQ(json_in("run").at("unseen_why"), nullptr);
}

}  // namespace
}  // namespace frontlux::test
