#include "app/paper_robot.hpp"
#include "octomap/quiet_octomap.hpp"
#include "support/command_test.hpp"
#include "support/giant_leaf.hpp"
#include "support/plain_frontiers.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/io/path_file.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/path_planner.hpp>

#include <variant>

namespace frontlux::planner {
namespace {

using test::content_of;

std::vector<Pose> poses_in(const std::string& file) {
  EXPECT_TRUE(content_of(file).starts_with("x,y,z,yaw\n"));
  std::vector<Pose> poses;
  for (const auto& [pose, line] : io::read_pose_list(file)) poses.push_back(pose);
  return poses;
}

// A hall of 9 x 6 x 4 m over a floor, with a wall from y = 0 to 4 across its middle.
class PlanCommandTest : public test::CommandTest {
 protected:
  PlanCommandTest() : CommandTest("plan") {
    MappingOptions options;
    options.resolution = 0.3;
    Mapping mapping(options);
    mapping.mark_free(test::keys_of(
        voxels_of(mapping.grid().lattice(), {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(9, 6, 3.9)})));
    const auto occupy = [&](double x, double y, double z) {
      const Eigen::Vector3f at = Eigen::Vector3d(x, y, z).cast<float>();
      for (int hits = 0; hits < 3; ++hits) mapping.insert(at, std::vector{at});
    };
    for (double x = 0.15; x < 9; x += 0.3)
      for (double y = 0.15; y < 6; y += 0.3) occupy(x, y, -0.15);
    for (double y = 0.15; y < 4; y += 0.3)
      for (double z = 0.15; z < 4; z += 0.3) occupy(4.65, y, z);
    mapping.write(path("hall.bt"));
    write("broken.bt", "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.3\ndata\n");
  }
};

TEST_F(PlanCommandTest, WritesAPathForEachRobotAndPlanner) {
  for (const std::string robot : {"ugv", "uav"})
    for (const std::string planner : {"rrt", "rrt-connect", "rrt-star", "corridor"}) {
      const std::string z = robot == "ugv" ? "0.75" : "1.9", file = path("path.csv");
      std::vector<std::string> words =
          test::joined({path("hall.bt"), "--robot", robot, "--from", "1.5,1.1," + z + ",-0.5"},
                       {"--to", "7.5,1.3," + z + ",2", "--planner", planner, "-o", file});
      if (planner != "corridor") words.insert(words.end(), {"--iterations", "1500"});
      const std::string out = expect_answer(words);
      const std::string csv = content_of(file);
      const auto poses = poses_in(file);
      ASSERT_GE(poses.size(), 7U);
      EXPECT_EQ(poses.front().position, Eigen::Vector3d(1.5, 1.1, std::stod(z)));
      EXPECT_EQ(poses.front().yaw, -0.5);
      EXPECT_EQ(poses.back().position, Eigen::Vector3d(7.5, 1.3, std::stod(z)));
      EXPECT_EQ(poses.back().yaw, 2.0);
      bool beyond_the_wall = false;  // that is, past its end at y = 4.2
      for (const Pose& pose : poses) beyond_the_wall |= pose.position.y() > 4.2;
      EXPECT_TRUE(beyond_the_wall);
      for (std::size_t i = 1; i < poses.size(); ++i)
        EXPECT_LE((poses[i].position - poses[i - 1].position).norm(), 1.2 + 1e-9);

      const auto line = [&](const std::string& label) {
        const auto at = out.find(label);
        EXPECT_NE(at, std::string::npos) << label << " is not in\n" << out;
        return at == std::string::npos ? "" : out.substr(at + 13, out.find('\n', at) - at - 13);
      };
      EXPECT_NEAR(std::stod(line("\nlength ").substr(1)), path_length(poses), 1e-5);
      EXPECT_EQ(std::stoul(line("\nviewpoints ").substr(1)), poses.size());
      EXPECT_NE(line("\nplanner ").find(planner), std::string::npos);
      expect_answer(words);
      EXPECT_EQ(content_of(file), csv);
    }
}

TEST_F(PlanCommandTest, TakesARobotFromAFile) {
  const auto words = [&](const std::string& robot, const std::string& from, const std::string& to) {
    return std::vector<std::string>{path("hall.bt"), "--robot", robot, "--from",        from,
                                    "--to",          to,        "-o",  path("path.csv")};
  };
  for (const auto& [robot, z] : {std::pair<std::string, std::string>("ugv", "0.75"), {"uav", "1.9"}}) {
    const std::string file = write(robot + ".json", test::paper_robot(robot));
    expect_answer(words(robot, "1.5,1.1," + z + ",0", "7.5,1.3," + z));
    const std::string path_by_word = content_of(path("path.csv"));
    expect_answer(words(file, "1.5,1.1," + z + ",0", "7.5,1.3," + z));
    EXPECT_EQ(content_of(path("path.csv")), path_by_word);
  }
  // In a corner where a ugv of 1.0 m does not fit.
  const std::string small =
      write("small.json", R"({"name": "mouse", "motion": "ground", "box_m": [0.2, 0.2, 0.4],
    "mount_height_m": 0.35, "step_m": 0.3, "slope_deg": 0, "sensor": {"kind": "cone", "horizontal_deg": 30, "range_m": 5,
    "columns": 10, "rows": 1}})");
  expect_refused(words("ugv", "1.5,1.1,0.75,0", "0.3,0.3,0.75"), "--to: the path to 0.3,0.3,0.75 ");
  expect_answer(words(small, "1.5,1.1,0.35,0", "0.3,0.3,0.35"), {"robot        mouse, "});
  expect_refused(test::joined(words(small, "1.5,1.1,0.35,0", "0.3,0.3,0.35"), {"--require-ground", "off"}),
                 "--require-ground: the mouse goes up and down");
  const std::string low = write("low.json", R"({"name": "low", "motion": "ground", "box_m": [0.2, 0.2, 0.2],
    "mount_height_m": 0.15, "step_m": 0.3, "sensor": {"kind": "cone", "horizontal_deg": 30, "range_m": 5,
    "columns": 10, "rows": 1}})");
  expect_refused(words(low, "1,1,1,0", "2,2,1"), "--robot: " + low + ": travel corridor: steps and slopes");
  expect_refused(words(write("bad.json", "{"), "1,1,1,0", "2,2,1"), "bad.json: line 1");
}

TEST_F(PlanCommandTest, ArrivesLookingAheadWithoutAYaw) {
  expect_answer({path("hall.bt"), "--robot", "uav", "--from", "1,1.1,2,3", "--to", "1.3,3.1,2", "-o",
                 path("path.csv")});
  const auto poses = poses_in(path("path.csv"));
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_DOUBLE_EQ(poses.back().yaw, std::atan2(2.0, 0.3));
  EXPECT_EQ(poses.front().yaw, 3.0);
}

TEST_F(PlanCommandTest, TurnsThePathToSeeMoreFrontiers) {
  const VoxelGrid grid = make_voxel_grid(read_octree(path("hall.bt")));
  const auto frontiers = test::frontiers_by_hand(grid, *grid.known_bounds());
  // Frontiers in view of some viewpoint of the path in the file, from the map alone.
  const auto seen = [&] {
    const auto poses = poses_in(path("path.csv"));
    return std::to_string(test::seen_by_hand(grid, poses, frontiers, test::camera(10.0)).size());
  };
  const auto run_with = [&](const std::vector<std::string>& more) {
    return expect_answer(test::joined({path("hall.bt"), "--robot", "uav", "--from", "1.57,1.12,1.93,-0.5",
                                       "--to", "7.51,1.37,2.04,2", "-o", path("path.csv"), "--optimize"},
                                      more));
  };
  EXPECT_EQ(run_with({"off"}).find("\ngain"), std::string::npos);
  const std::string before = seen();
  for (const std::string mode : {"default", "paper"}) {
    const std::string out = run_with({"on", "--mode", mode});
    const std::string after = seen();
    EXPECT_GE(std::stoi(after), std::stoi(before));
    test::expect_parts(out, {"\ngain         " + before + " frontiers in view before, " + after + " after"});
    const std::string with_moves = run_with({"on", "--mode", mode, "--move", "on"});
    const std::string moved = seen();
    EXPECT_GE(std::stoi(moved), std::stoi(after));
    test::expect_parts(with_moves,
                       {"\nmoved        " + after + " frontiers in view before, " + moved + " after"});
  }
}

TEST_F(PlanCommandTest, WritesAPlyWithDirectionsOfView) {
  const std::vector<Pose> poses = {{{1, 2, 3}, 0.0}, {{2, 2, 3}, 1.5}, {{2, 3, 3.5}, -3.0}};
  io::write_path(path("path.ply"), poses);
  std::istringstream ply(content_of(path("path.ply")));
  std::string line;
  std::size_t vertices = 0, edges = 0;
  while (std::getline(ply, line) && line != "end_header") {
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element edge ")) edges = std::stoul(line.substr(13));
  }
  ASSERT_EQ(vertices, 6U);
  ASSERT_EQ(edges, 5U);
  for (std::size_t i = 0; i < vertices; ++i) {
    const Pose& pose = poses[i % 3];
    Eigen::Vector3d at, normal;
    ply >> at.x() >> at.y() >> at.z() >> normal.x() >> normal.y() >> normal.z();
    const Eigen::Vector3d view(std::cos(pose.yaw), std::sin(pose.yaw), 0.0);
    EXPECT_TRUE(normal.isApprox(view, 1e-6));
    EXPECT_TRUE(at.isApprox(pose.position + (i < 3 ? 0.0 : 0.3) * view, 1e-6));
  }
  std::set<std::pair<int, int>> joined;
  for (std::size_t i = 0; i < edges; ++i) {
    int a = 0, b = 0;
    ply >> a >> b;
    joined.emplace(a, b);
  }
  EXPECT_TRUE(ply);
  EXPECT_EQ(joined, (std::set<std::pair<int, int>>{{0, 1}, {1, 2}, {0, 3}, {1, 4}, {2, 5}}));
  EXPECT_REFUSED(io::write_path(path("path.txt"), poses));
  EXPECT_THROW(io::write_path(path("none/path.csv"), poses), std::runtime_error);
}

TEST_F(PlanCommandTest, RefusesWhatItCannotUse) {
  const std::string map = path("hall.bt"), from = "1.5,1.1,0.75,0", to = "7.5,1.3,0.75";
  const auto with = [&](const std::string& option, const std::string& value) {
    std::vector<std::string> words = {map, "--robot", "ugv", "--from", from, "--to", to};
    for (std::size_t i = 1; i + 1 < words.size(); i += 2)
      if (words[i] == option) {
        words[i + 1] = value;
        return words;
      }
    return test::joined(words, {option, value});
  };
  expect_refused(with("--robot", "boat"), "--robot: 'boat' is none of ugv, uav, and no file");
  for (const std::string word : {"1,2,3", "1,nan,0.75,0", "1,2,0.75,1e999", "1,2,0.75,0,0"})
    expect_refused(with("--from", word), "--from: '" + word + "' is not four finite numbers");
  expect_refused(with("--from", "1,2,0.75,90"), "--from: '1,2,0.75,90' has a yaw of more than a turn");
  expect_refused(with("--from", "1e9,2,0.75,0"), "--from: 1e9,2,0.75,0 lies outside");
  expect_refused(with("--from", "4.65,1.3,0.75,0"),
                 "--from: at 4.65,1.3,0.75,0 the ugv is in an occupied voxel");
  expect_refused(with("--from", "-3,1.3,0.75,0"), "--from: at -3,1.3,0.75,0 the ugv is");
  for (const std::string word : {"1,2,3,4,5", "1,2", ""})
    expect_refused(with("--to", word), "--to: '" + word + "' is not three or four finite numbers");
  expect_refused(with("--to", "7.5,1.3,2"), "--to: 7.5,1.3,2 is not on the plane of the ugv");
  expect_refused(with("--to", "4.65,1.3,0.75"), "--to: the path to 4.65,1.3,0.75 ");
  expect_refused(with("--planner", "prm"),
                 "--planner: 'prm' is none of corridor, rrt, rrt-connect, rrt-star");
  for (const std::string seed : {"-1", "1.5", "18446744073709551616", ""})
    expect_refused(with("--seed", seed), "--seed: '" + seed + "' is not a whole number from 0 to");
  for (const std::string number : {"0", "1000001", "1e3", ""})
    expect_refused(with("--iterations", number),
                   "--iterations: '" + number + "' is not a whole number from 1 to 1000000");
  for (const std::string option : {"--require-ground", "--optimize", "--move"})
    expect_refused(with(option, "maybe"), option + ": 'maybe' is none of on, off");
  expect_refused(with("--mode", "fast"), "--mode: 'fast' is none of default, paper");
  expect_refused(with("-o", path("path.txt")), "path.txt does not end in .csv or .ply");
  expect_refused(with("-o", path("none/path.csv")), "there is no folder");
  std::filesystem::create_directory(path("folder.csv"));
  expect_refused(with("-o", path("folder.csv")), "folder.csv is a folder");
  for (const std::string file : {"broken.bt", "missing.bt"})
    expect_refused({path(file), "--robot", "ugv", "--from", from, "--to", to}, file);
  const auto in_space = [&](const std::string& option, const std::string& value) {
    return std::vector<std::string>{map,    "--robot", "uav",  "--from", "1,1,2,0",
                                    "--to", "2,2,2",   option, value};
  };
  expect_refused(in_space("--min-height", "nan"), "--min-height: 'nan' is not a finite number");
  // What would change nothing beside the other options.
  expect_refused(test::joined(with("--move", "on"), {"--optimize", "off"}), "--move: ");
  expect_refused(test::joined(with("--mode", "paper"), {"--optimize", "off"}), "--mode: ");
  expect_refused(test::joined(with("--planner", "corridor"), {"--seed", "2"}), "--seed: ");
  expect_refused(test::joined(with("--planner", "corridor"), {"--iterations", "9"}), "--iterations: ");
  expect_refused(with("--min-height", "2"), "--min-height: ");
  expect_refused(in_space("--require-ground", "on"), "--require-ground: ");
}

TEST_F(PlanCommandTest, RefusesGiantLeavesBeforeTheWorkBegins) {
  const std::string map = write("giant.bt", test::giant_leaf(7));
  const std::vector<std::string> words = {map, "--robot", "uav", "--from", "3,3,3,0", "--to", "5,5,3"};
  expect_refused(words, {map + ": ", "2 leaves", "with --bounds"}, "ulimit -t 3;");
  expect_answer(test::joined(words, {"--bounds", "-1,-1,-1,8,8,8"}));
  expect_refused(test::joined(words, {"--bounds", "90,90,90,91,91,91"}),
                 {"--bounds: no voxel within is known"});
}

}  // namespace
}  // namespace frontlux::planner
