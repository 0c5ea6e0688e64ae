#include "support/command.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/map_world.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace frontlux::sim {
namespace {

using test::Answer;
using test::content_of;

class WorldCommand : public testing::Test {
 protected:
  WorldCommand()
      : folder_(std::filesystem::temp_directory_path() / ("frontlux_world_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~WorldCommand() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] Answer run(std::vector<std::string> words) const {
    words.insert(words.begin(), "world");
    return test::run_frontlux(words, folder_);
  }

  void expect_refusal(const std::vector<std::string>& words, const std::vector<std::string>& parts) const {
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    EXPECT_TRUE(answer.err.starts_with("frontlux: ")) << answer.err;
    EXPECT_EQ(answer.err.find('\n'), answer.err.size() - 1) << answer.err;
    for (const auto& part : parts)
      EXPECT_NE(answer.err.find(part), std::string::npos) << part << "\nin\n" << answer.err;
  }

  void expect_answer(const std::vector<std::string>& words, const std::vector<std::string>& parts) const {
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 0);
    EXPECT_EQ(answer.err, "");
    for (const auto& part : parts)
      EXPECT_NE(answer.out.find(part), std::string::npos) << part << "\nin\n" << answer.out;
  }

  // A box of 4 x 5 x 6 units on z = 0 whose corners are `scale` times as far.
  std::string box(const std::string& name, float scale = 1) const {
    TriangleMesh mesh;
    for (const float z : {0.F, 6.F})
      for (const float y : {0.F, 5.F})
        for (const float x : {0.F, 4.F}) mesh.vertices.emplace_back(x * scale, y * scale, z * scale);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    write_ply(file(name), mesh);
    return file(name);
  }

  std::filesystem::path folder_;
};

TEST_F(WorldCommand, ListsTheBuiltInWorlds) {
  const Answer answer = run({});
  EXPECT_EQ(answer.code, 0);
  for (const auto& [name, description] : built_in_worlds()) {
    EXPECT_NE(answer.out.find(name), std::string::npos);
    EXPECT_NE(answer.out.find(description), std::string::npos);
  }
}

TEST_F(WorldCommand, WritesWhatTheLibraryMakes) {
  for (const auto& [name, description] : built_in_worlds()) {
    const World world = make_world(name, 6);
    expect_answer({std::string(name), "--seed", "6", "-o", file("world.ply")},
                  {"seed         6\n", "triangles    " + std::to_string(world.mesh.triangles.size()) + "\n"});
    write_ply(file("expected.ply"), world.mesh);
    EXPECT_EQ(content_of(file("world.ply")), content_of(file("expected.ply"))) << name;
  }
}

TEST_F(WorldCommand, MeasuresABox) {
  expect_answer({box("box.ply")}, {"size         4 x 5 x 6 m, 4998 voxels of 0.3 m\n",
                                   "bounds x     0 to 4 m\n", "triangles    12\n", "surface      148 m^2\n",
                                   "free         0 m^3, of 120 m^3", "start        none"});
  expect_answer({file("box.ply"), "--scale", "0.5", "--up", "y"},
                {"size         2 x 3 x 2.5 m", "y     -3 to 0 m"});
}

TEST_F(WorldCommand, AlignsTheGround) {
  box("box.ply");
  expect_answer({file("box.ply"), "--start", "1,1,2", "--ground", "auto"},
                {"z     -0.05 to 5.95 m", "start        1, 1, 1.95 m, above a floor at z = -0.05 m",
                 "ground       moved by -0.05 m along z"});
  expect_answer({file("box.ply"), "--ground", "-0.4"}, {"moved by 0.05 m"});
  expect_answer({"room", "--ground", "auto"}, {"moved by 0 m"});
}

TEST_F(WorldCommand, TakesMaps) {
  const std::string path = std::string(FRONTLUX_DATA_DIR) + "/maps/room_0.1m.bt";
  octomap::OcTree tree(path);
  tree.expand();
  std::size_t occupied = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
    occupied += tree.isNodeOccupied(*leaf) ? 1 : 0;
  ASSERT_GT(occupied, 1000U);
  write_ply(file("expected.ply"), make_map_world(make_voxel_grid(tree)).mesh);
  expect_answer({path, "-o", file("map.ply")}, {"world        room_0.1m.bt\n", "m^3, of "});
  EXPECT_EQ(content_of(file("map.ply")), content_of(file("expected.ply")));
  EXPECT_NEAR(solid_volume(read_mesh_world(file("map.ply")).mesh).value(),
              1e-3 * static_cast<double>(occupied), 1e-4);
}

TEST_F(WorldCommand, RefusesBadInput) {
  box("box.ply");
  expect_refusal({"hangar"}, {"'hangar'", "maze, factory, station, storage, room"});
  expect_refusal({file("none.ply")}, {file("none.ply"), "no such file"});
  expect_refusal({file("none.bt")}, {file("none.bt"), "no such file"});
  expect_refusal({"maze", "--seed", "two"}, {"--seed"});
  expect_refusal({"maze", "--seed", "-1"}, {"--seed", "'-1'"});
  expect_refusal({"maze", "--seed", ""}, {"--seed"});
  expect_refusal({"maze", "--seed", "18446744073709551616"}, {"--seed"});
  expect_refusal({"maze", "--scale", "2"}, {"--scale", "mesh files", "maze"});
  expect_refusal({"maze", "--up", "y"}, {"--up", "mesh files"});
  expect_refusal({file("box.ply"), "--seed", "3"}, {"--seed", "built-in"});
  expect_refusal({file("box.ply"), "--scale", "0"}, {"--scale", "not positive"});
  expect_refusal({file("box.ply"), "--scale", "-1"}, {"--scale", "not positive"});
  expect_refusal({file("box.ply"), "--scale", "nan"}, {"--scale", "'nan'"});
  expect_refusal({file("box.ply"), "--up", "w"}, {"--up", "'w'"});
  expect_refusal({file("box.ply"), "--resolution", "0"}, {"--resolution"});
  expect_refusal({file("box.ply"), "--start", "1,2"}, {"--start", "'1,2'"});
  expect_refusal({file("box.ply"), "--start", "1,1,7"}, {"--start", "outside", "4, 5, 6"});
  expect_refusal({file("box.ply"), "--start", "-1,1,1"}, {"--start", "outside"});
  expect_refusal({file("box.ply"), "--ground", "low"}, {"--ground", "'low'"});
  expect_refusal({file("box.ply"), "--ground", "auto"}, {"--ground auto", "--start"});
  std::ofstream(file("broken.ply")) << "ply\n";
  expect_refusal({file("broken.ply"), "-o", file("out.ply")}, {file("broken.ply"), "end_header"});
  EXPECT_FALSE(std::filesystem::exists(file("out.ply")));
  expect_refusal({"room", "-o", file("no/out.ply")}, {"-o", file("no/out.ply")});
  std::ofstream(file("empty.bt")) << "# Octomap OcTree binary file\nid OcTree\nsize 0\nres 0.1\ndata\n";
  expect_refusal({file("empty.bt")}, {file("empty.bt"), "no occupied voxel"});
}

TEST_F(WorldCommand, RefusesAbsurdSizesAndWarnsOfLargeOnes) {
  box("mm.ply", 1000.F);  // somebody's millimetres: 4 x 5 x 6 km
  expect_refusal({file("mm.ply"), "-o", file("out.ply")}, {"4000 x 5000 x 6000 m", "e+12 voxels", "--scale"});
  EXPECT_FALSE(std::filesystem::exists(file("out.ply")));
  expect_answer({file("mm.ply"), "--scale", "0.001"}, {"4 x 5 x 6 m"});
  const Answer large = run({file("mm.ply"), "--scale", "0.05"});  // 200 x 250 x 300 m
  EXPECT_EQ(large.code, 0);
  EXPECT_TRUE(large.err.starts_with("frontlux: warning: ")) << large.err;
  EXPECT_NE(large.err.find("voxels of 0.3 m"), std::string::npos) << large.err;
  EXPECT_NE(large.err.find("--scale"), std::string::npos) << large.err;
}

}  // namespace
}  // namespace frontlux::sim
