#include "sim/mesh/box_mesh.hpp"
#include "support/command_test.hpp"
#include "support/giant_leaf.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/map_world.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <octomap/OcTree.h>

namespace frontlux::test {
namespace {

using sim::World, sim::built_in_worlds, sim::make_map_world, sim::make_world, sim::read_mesh_world,
    sim::solid_volume, sim::write_ply;

class WorldCommand : public CommandTest {
 protected:
  WorldCommand() : CommandTest("world") {}

  // A box of 4 x 5 x 6 units on z = 0 whose corners are `scale` times as far.
  std::string box(const std::string& name, float scale = 1) const {
    sim::TriangleMesh mesh;
    for (const float z : {0.F, 6.F})
      for (const float y : {0.F, 5.F})
        for (const float x : {0.F, 4.F}) mesh.vertices.emplace_back(x * scale, y * scale, z * scale);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    write_ply(path(name), mesh);
    return path(name);
  }
};

TEST_F(WorldCommand, ListsTheBuiltInWorlds) {
  for (const auto& [name, description] : built_in_worlds())
    expect_answer({}, {std::string(name), std::string(description)});
}

TEST_F(WorldCommand, WritesWhatTheLibraryMakes) {
  for (const auto& [name, description] : built_in_worlds()) {
    const World world = make_world(name, 6);
    expect_answer({std::string(name), "--seed", "6", "-o", path("world.ply")},
                  {"seed         6\n", "triangles    " + std::to_string(world.mesh.triangles.size()) + "\n"});
    write_ply(path("expected.ply"), world.mesh);
    EXPECT_EQ(content_of(path("world.ply")), content_of(path("expected.ply"))) << name;
  }
}

TEST_F(WorldCommand, MeasuresABox) {
  expect_answer(
      {box("box.ply")},
      {"size         4 x 5 x 6 m, 4998 voxels of 0.3 m\n", "bounds x     0 to 4 m\n", "triangles    12\n",
       "surface      148 m^2\n", "free         not known: the surface faces outwards", "start        none"});
  expect_answer({path("box.ply"), "--scale", "0.5", "--up", "y"},
                {"size         2 x 3 x 2.5 m", "y     -3 to 0 m"});
}

// Six slabs around a room, as solids and with all triangles turned over.
TEST_F(WorldCommand, NotesThatTrianglesFaceTheWrongWay) {
  World world;
  using Eigen::Vector3f;
  for (const auto& [low, high] : {std::pair(Vector3f(0, 0, 0), Vector3f(4.5F, 3.5F, 0.25F)),
                                  {Vector3f(0, 0, 2.25F), Vector3f(4.5F, 3.5F, 2.5F)},
                                  {Vector3f(0, 0, 0.25F), Vector3f(0.25F, 3.5F, 2.25F)},
                                  {Vector3f(4.25F, 0, 0.25F), Vector3f(4.5F, 3.5F, 2.25F)},
                                  {Vector3f(0.25F, 0, 0.25F), Vector3f(4.25F, 0.25F, 2.25F)},
                                  {Vector3f(0.25F, 3.25F, 0.25F), Vector3f(4.25F, 3.5F, 2.25F)}})
    sim::test::add_box(world.mesh, {low, high});
  write_ply(path("room.ply"), world.mesh);
  for (auto& triangle : world.mesh.triangles) std::swap(triangle[1], triangle[2]);
  write_ply(path("turned.ply"), world.mesh);
  const auto arguments = [&](const std::string& name) {
    return std::vector<std::string>{path(name), "--start", "2,2,1", "--resolution", "0.1"};
  };
  expect_answer(arguments("room.ply"), {"free         24 m^3, of 39.375 m^3 within the bounds"});
  expect_answer(arguments("turned.ply"), {"free         not known: more of it can be observed"});
}

TEST_F(WorldCommand, AlignsTheGround) {
  box("box.ply");
  expect_answer({path("box.ply"), "--start", "1,1,2", "--ground", "auto"},
                {"z     -0.05 to 5.95 m", "start        1, 1, 1.95 m, above a floor at z = -0.05 m",
                 "ground       shifted by -0.05 m along z"});
  expect_answer({path("box.ply"), "--ground", "-0.4"}, {"shifted by 0.05 m"});
  expect_answer({"room", "--ground", "auto"}, {"shifted by 0 m"});
  expect_refused({"room", "--ground", "100"}, {"--ground: 100 m is far from the world", "to 3.25 m high"});
}

TEST_F(WorldCommand, TakesMaps) {
  const std::string map = std::string(FRONTLUX_DATA_DIR) + "/maps/room_0.1m.bt";
  octomap::OcTree tree(map);
  tree.expand();
  std::size_t occupied = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
    occupied += tree.isNodeOccupied(*leaf) ? 1 : 0;
  ASSERT_GT(occupied, 1000U);
  write_ply(path("expected.ply"), make_map_world(make_voxel_grid(tree)).mesh);
  expect_answer({map, "-o", path("map.ply")}, {"world        room_0.1m.bt\n", "m^3, of "});
  EXPECT_EQ(content_of(path("map.ply")), content_of(path("expected.ply")));
  EXPECT_NEAR(solid_volume(read_mesh_world(path("map.ply")).mesh).value(),
              1e-3 * static_cast<double>(occupied), 1e-4);
}

TEST_F(WorldCommand, RefusesBadInput) {
  expect_refused({std::string(300, 'x')}, "is neither a file nor a built-in world");
  box("box.ply");
  expect_refused({"-o", path("of_none.ply")}, {"--output: give the WORLD"});
  expect_refused({"--seed", "3"}, {"--seed: give the WORLD"});
  expect_refused({""}, {"''", "maze, factory, station, storage, room"});
  expect_refused({"hangar"}, {"'hangar'", "maze, factory, station, storage, room"});
  expect_refused({path("none.ply")}, {path("none.ply"), "no such file"});
  expect_refused({path("none.bt")}, {path("none.bt"), "no such file"});
  for (const std::string seed : {"two", "-1", "", "18446744073709551616"})
    expect_refused({"maze", "--seed", seed}, {"--seed: '" + seed + "'"});
  expect_refused({"maze", "--scale", "2"}, {"--scale: maze is not a mesh file"});
  expect_refused({"maze", "--up", "y"}, {"--up: maze is not a mesh file"});
  expect_refused({path("box.ply"), "--seed", "3"}, {"--seed", "is not a built-in world"});
  for (const std::string scale : {"0", "-1", "nan"})
    expect_refused({path("box.ply"), "--scale", scale}, {"--scale: '" + scale + "' is not a number above 0"});
  expect_refused({path("box.ply"), "--up", "w"}, {"--up", "'w'"});
  expect_refused({path("box.ply"), "--resolution", "0"}, {"--resolution"});
  expect_refused({path("box.ply"), "--start", "1,2"}, {"--start", "'1,2'"});
  expect_refused({path("box.ply"), "--start", "1,1,7"}, {"--start", "outside", "4, 5, 6"});
  expect_refused({path("box.ply"), "--start", "-1,1,1"}, {"--start", "outside"});
  expect_refused({path("box.ply"), "--ground", "low"}, {"--ground: 'low' is not auto, off or a height"});
  expect_refused({path("box.ply"), "--ground", "auto"}, {"--ground: auto", "--start"});
  expect_refused({write("broken.ply", "ply\n"), "-o", path("out.ply")}, {path("broken.ply"), "end_header"});
  EXPECT_FALSE(std::filesystem::exists(path("out.ply")));
  expect_refused({"room", "-o", path("no/out.ply")}, {"--output: ", path("no/out.ply")});
  write("empty.bt", "# Octomap OcTree binary file\nid OcTree\nsize 0\nres 0.1\ndata\n");
  expect_refused({path("empty.bt")}, {path("empty.bt"), "no occupied voxel"});
}

TEST_F(WorldCommand, RefusesOutputsBeforeItReadsTheWorld) {
  write("none.ply", "ply");
  std::filesystem::create_directory(path("folder.ply"));
  expect_refused({path("none.ply"), "-o", path("folder.ply")}, {"--output", "is a folder"});
  expect_refused({path("none.ply"), "-o", path("no/out.ply")}, {"--output", "there is no folder"});
  expect_refused({path("none.ply"), "-o", path("out.obj")}, {"--output", "does not end in .ply"});
  expect_refused({path("none.ply"), "-o", path(std::string(245, 'n') + ".ply")},
                 {"--output", "name is too long"});
  // The world itself, by another name too.
  box("box.ply");
  std::filesystem::create_symlink("box.ply", path("link.ply"));
  for (const char* output : {"box.ply", "link.ply"})
    expect_refused({path("box.ply"), "--up", "y", "-o", path(output)},
                   {"--output", "is what is read: " + path("box.ply"), "name another file"});
}

// A link is replaced, whether it points to a file or not, and nothing else is left.
TEST_F(WorldCommand, ReplacesALinkByTheFile) {
  write("mine.ply", "mine");
  std::filesystem::create_symlink("mine.ply", path("link.ply"));
  std::filesystem::create_symlink("/proc/none.ply", path("dangling.ply"));
  for (const char* output : {"link.ply", "dangling.ply"}) {
    expect_answer({"room", "-o", path(output)});
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path(output)))) << output;
    EXPECT_GT(std::filesystem::file_size(path(output)), 1000U);
  }
  EXPECT_EQ(content_of(path("mine.ply")), "mine");
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
}

// Before its surface is made, of which there is too much as well.
TEST_F(WorldCommand, RefusesATooLargeMapByItsBounds) {
  const std::string map = write("giant.bt", giant_leaf(3, kOccupiedLeaf));
  expect_refused({map},
                 {"giant.bt: 819.3 x 819.3 x 819.3 m are", "too many: a map holds at most 2147483648"});
  expect_refused({map, "--resolution", "5"}, {"giant.bt: the map's occupied voxels have more than"});
}

TEST_F(WorldCommand, ComplainsOnOneLineWhateverAFileIsCalled) {
  const Answer answer = run({path("a\nb\x1b[31m.ply")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(std::ranges::count(answer.err, '\n'), 1) << answer.err;
  EXPECT_NE(answer.err.find("a?b?[31m.ply"), std::string::npos) << answer.err;
  box("c\x1b[31m.ply");
  expect_answer({path("c\x1b[31m.ply")}, {"c?[31m.ply"});
}

TEST_F(WorldCommand, RefusesAbsurdSizesAndWarnsOfLargeOnes) {
  box("mm.ply", 1000.F);  // somebody's millimetres: 4 x 5 x 6 km
  expect_refused(
      {path("mm.ply"), "-o", path("out.ply")},
      {"4000 x 5000 x 6000 m", "e+12 voxels", "at most 536800000 of a mesh so small", "--scale", "box_m"});
  EXPECT_FALSE(std::filesystem::exists(path("out.ply")));
  expect_answer({path("mm.ply"), "--scale", "0.001"}, {"4 x 5 x 6 m"});
  const Answer large = run({path("mm.ply"), "--scale", "0.04"});  // 160 x 200 x 240 m
  EXPECT_EQ(large.code, 0);
  EXPECT_TRUE(large.err.starts_with("frontlux: warning: ")) << large.err;
  expect_parts(large.err, {"voxels of 0.3 m", "--scale"});
}

}  // namespace
}  // namespace frontlux::test
