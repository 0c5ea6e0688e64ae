#include "support/command_test.hpp"
#include "support/quiet_octomap.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/io/path_file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/ray_caster.hpp>

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Answer;
using test::content_of;

std::vector<Pose> poses_in(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,yaw");
  std::vector<Pose> poses;
  while (std::getline(lines, line)) {
    Pose pose;
    char comma = 0;
    std::istringstream words(line);
    words >> pose.position.x() >> comma >> pose.position.y() >> comma >> pose.position.z() >> comma >>
        pose.yaw;
    EXPECT_TRUE(words && words.peek() == EOF) << line;
    poses.push_back(pose);
  }
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
      for (int hits = 0; hits < 3; ++hits)
        mapping.insert(Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)),
                       std::vector<Eigen::Vector3f>{Eigen::Vector3f(
                           static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))});
    };
    for (double x = 0.15; x < 9; x += 0.3)
      for (double y = 0.15; y < 6; y += 0.3) occupy(x, y, -0.15);
    for (double y = 0.15; y < 4; y += 0.3)
      for (double z = 0.15; z < 4; z += 0.3) occupy(4.65, y, z);
    mapping.write(path("hall.bt"));
    std::ofstream(path("broken.bt")) << "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.3\ndata\n";
  }
};

TEST_F(PlanCommandTest, WritesAPathForEachRobotAndPlanner) {
  for (const std::string robot : {"ugv", "uav"})
    for (const std::string planner : {"rrt", "rrt-connect", "rrt-star", "corridor"}) {
      const std::string z = robot == "ugv" ? "0.75" : "1.9", file = path("path.csv");
      std::vector<std::string> words = {path("hall.bt"),
                                        "--robot",
                                        robot,
                                        "--from",
                                        "1.5,1.1," + z + ",-0.5",
                                        "--to",
                                        "7.5,1.3," + z + ",2",
                                        "--planner",
                                        planner,
                                        "-o",
                                        file};
      if (planner != "corridor") words.insert(words.end(), {"--iterations", "1500"});
      const Answer answer = run(words);
      ASSERT_EQ(answer.code, 0) << answer.err;
      EXPECT_EQ(answer.err, "");
      const std::string csv = content_of(file);
      const auto poses = poses_in(csv);
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
        const auto at = answer.out.find(label);
        EXPECT_NE(at, std::string::npos) << label << " is not in\n" << answer.out;
        return at == std::string::npos ? "" : answer.out.substr(at + 13, answer.out.find('\n', at) - at - 13);
      };
      EXPECT_NEAR(std::stod(line("\nlength ").substr(1)), path_length(poses), 1e-5);
      EXPECT_EQ(std::stoul(line("\nviewpoints ").substr(1)), poses.size());
      EXPECT_NE(line("\nplanner ").find(planner), std::string::npos);
      ASSERT_EQ(run(words).code, 0);
      EXPECT_EQ(content_of(file), csv);
    }
}

TEST_F(PlanCommandTest, ArrivesLookingAheadWithoutAYaw) {
  const Answer answer = run({path("hall.bt"), "--robot", "uav", "--from", "1,1.1,2,3", "--to", "1.3,3.1,2",
                             "-o", path("path.csv")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const auto poses = poses_in(content_of(path("path.csv")));
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_DOUBLE_EQ(poses.back().yaw, std::atan2(2.0, 0.3));
  EXPECT_EQ(poses.front().yaw, 3.0);
}

// Frontiers in view of some viewpoint of a UAV, from the map alone.
std::uint64_t seen(const VoxelGrid& grid, const std::vector<Pose>& poses) {
  const auto caster = make_grid_ray_caster(grid);
  const KeyBox bounds = *grid.known_bounds();
  const double pi = std::numbers::pi;
  std::uint64_t count = 0;
  for (int x = bounds.min.x; x <= bounds.max.x; ++x)
    for (int y = bounds.min.y; y <= bounds.max.y; ++y)
      for (int z = bounds.min.z; z <= bounds.max.z; ++z) {
        const auto key = [&](int dx, int dy, int dz) {
          return VoxelKey{static_cast<std::uint16_t>(x + dx), static_cast<std::uint16_t>(y + dy),
                          static_cast<std::uint16_t>(z + dz)};
        };
        const auto is_free = [&](int dx, int dy, int dz) {
          return grid.at(key(dx, dy, dz)) == Occupancy::kFree;
        };
        if (grid.at(key(0, 0, 0)) != Occupancy::kUnknown) continue;
        if (!is_free(1, 0, 0) && !is_free(-1, 0, 0) && !is_free(0, 1, 0) && !is_free(0, -1, 0) &&
            !is_free(0, 0, 1) && !is_free(0, 0, -1))
          continue;
        const Eigen::Vector3f at = grid.lattice().center(key(0, 0, 0));
        bool in_view = false;
        for (const Pose& pose : poses) {
          const Eigen::Vector3d to = at.cast<double>() - pose.position;
          const double ahead = std::cos(pose.yaw) * to.x() + std::sin(pose.yaw) * to.y();
          const double left = std::cos(pose.yaw) * to.y() - std::sin(pose.yaw) * to.x();
          if (to.norm() > 10.0 || std::abs(left) > ahead || std::abs(to.z()) > std::tan(pi / 5) * ahead)
            continue;
          const std::vector<Segment> segment = {{pose.position.cast<float>(), at}};
          std::vector<std::uint8_t> visible(1);
          caster->visible(segment, visible, UnknownPolicy::kBlock);
          in_view |= visible[0] != 0;
        }
        count += static_cast<std::uint64_t>(in_view);
      }
  return count;
}

TEST_F(PlanCommandTest, TurnsThePathToSeeMoreFrontiers) {
  const VoxelGrid grid =
      std::visit([](const auto& tree) { return make_voxel_grid(*tree); }, read_octree(path("hall.bt")));
  const std::vector<std::string> words = {
      path("hall.bt"), "--robot",          "uav", "--from",         "1.57,1.12,1.93,-0.5",
      "--to",          "7.51,1.37,2.04,2", "-o",  path("path.csv"), "--optimize"};
  const auto run_with = [&](const std::vector<std::string>& more) {
    auto all = words;
    all.insert(all.end(), more.begin(), more.end());
    const Answer answer = run(all);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return answer.out;
  };
  EXPECT_EQ(run_with({"off"}).find("\ngain"), std::string::npos);
  const std::uint64_t before = seen(grid, poses_in(content_of(path("path.csv"))));
  for (const std::string mode : {"default", "paper"}) {
    const std::string out = run_with({"on", "--mode", mode});
    const std::uint64_t after = seen(grid, poses_in(content_of(path("path.csv"))));
    EXPECT_GE(after, before);
    EXPECT_NE(out.find("\ngain         " + std::to_string(before) + " frontiers in view before, " +
                       std::to_string(after) + " after"),
              std::string::npos)
        << before << ", " << after << " in\n"
        << out;
    const std::string with_moves = run_with({"on", "--mode", mode, "--move", "on"});
    const std::uint64_t moved = seen(grid, poses_in(content_of(path("path.csv"))));
    EXPECT_GE(moved, after);
    EXPECT_NE(with_moves.find("\nmoved        " + std::to_string(after) + " frontiers in view before, " +
                              std::to_string(moved) + " after"),
              std::string::npos)
        << after << ", " << moved << " in\n"
        << with_moves;
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
  EXPECT_THROW(io::write_path(path("path.txt"), poses), std::invalid_argument);
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
    words.push_back(option);
    words.push_back(value);
    return words;
  };
  expect_refused(with("--robot", "boat"), "--robot: 'boat' is none of ugv, uav");
  for (const std::string word : {"1,2,3", "1,nan,0.75,0", "1,2,0.75,1e999", "1,2,0.75,0,0"})
    expect_refused(with("--from", word), "--from: '" + word + "' is not four finite numbers");
  expect_refused(with("--from", "1e9,2,0.75,0"), "--from: 1e9,2,0.75,0 lies outside");
  expect_refused(with("--from", "4.65,1.3,0.75,0"),
                 "--from: at 4.65,1.3,0.75,0 the ugv is in an occupied voxel");
  expect_refused(with("--from", "-3,1.3,0.75,0"), "--from: at -3,1.3,0.75,0 the ugv is");
  for (const std::string word : {"1,2,3,4,5", "1,2", ""})
    expect_refused(with("--to", word), "--to: '" + word + "' is not three or four finite numbers");
  expect_refused(with("--to", "7.5,1.3,2"), "--to: 7.5,1.3,2 is not on the ugv's plane");
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
  expect_refused({path("broken.bt"), "--robot", "ugv", "--from", from, "--to", to}, "broken.bt");
  expect_refused({path("missing.bt"), "--robot", "ugv", "--from", from, "--to", to}, "missing.bt");
  expect_refused({map, "--robot", "uav", "--from", "1,1,2,0", "--to", "2,2,2", "--min-height", "nan"},
                 "--min-height: 'nan' is not a finite number");
  // What would change nothing beside the other options.
  const auto beside = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refused(beside(with("--move", "on"), {"--optimize", "off"}), "--move: ");
  expect_refused(beside(with("--mode", "paper"), {"--optimize", "off"}), "--mode: ");
  expect_refused(beside(with("--planner", "corridor"), {"--seed", "2"}), "--seed: ");
  expect_refused(beside(with("--planner", "corridor"), {"--iterations", "9"}), "--iterations: ");
  expect_refused(with("--min-height", "2"), "--min-height: ");
  expect_refused({map, "--robot", "uav", "--from", "1,1,2,0", "--to", "2,2,2", "--require-ground", "on"},
                 "--require-ground: ");
}

}  // namespace
}  // namespace frontlux::planner
