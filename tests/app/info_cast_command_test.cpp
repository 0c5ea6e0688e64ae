#include "octomap/quiet_octomap.hpp"
#include "support/address_limits.hpp"
#include "support/command_test.hpp"
#include "support/maps.hpp"
#include "support/tree_state.hpp"
#include "support/voxel_keys.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <random>

namespace {

using frontlux::test::Answer;
using frontlux::test::expect_parts;
using frontlux::test::full_record;
using frontlux::test::joined;
using Json = nlohmann::ordered_json;

constexpr double kResolution = 0.1;
constexpr const char* kNoLimits = "the sanitizer needs more address space than a limit would leave";
constexpr std::array kCasters = {"fast", "embree", "grid", "octomap"};

octomap::OcTreeKey key(int x, int y, int z) {
  return frontlux::test::tree_key(frontlux::test::key_at(x, y, z));
}

// A room of free voxels with a wall at x = 4 that has a hole, and noise around it.
template <class Tree>
void furnish(Tree& tree) {
  for (int x = -6; x < 20; ++x)
    for (int y = -6; y < 10; ++y)
      for (int z = 0; z < 17; ++z) tree.updateNode(key(x, y, z), x == 4 && !(y == 3 && z == 3));
  std::mt19937 random(3);
  for (int i = 0; i < 400; ++i) {
    const auto along = [&] { return static_cast<int>(random() % 48) - 24; };
    const int x = along(), y = along(), z = along();
    tree.updateNode(key(x, y, z), i % 2 == 0);
  }
  tree.toMaxLikelihood();
  tree.prune();
}

class InfoCastCommand : public frontlux::test::CommandTest {
 protected:
  InfoCastCommand() : CommandTest("") {
    octomap::OcTree tree(kResolution);
    furnish(tree);
    std::ofstream map(path("map.bt"), std::ios::binary);
    tree.writeBinary(map);
  }

  [[nodiscard]] std::vector<std::string> cast(const std::vector<std::string>& words) const {
    return joined({"cast", path("map.bt")}, words);
  }

  /// With --json the command prints one line.
  /// @param values  of it, by JSON pointer: "/bounds/min_key"
  void expect_json(std::vector<std::string> words, const Json& values) const {
    words.insert(words.begin() + 1, "--json");
    const Answer answer = run(words);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
    EXPECT_EQ(answer.out.find('\n'), answer.out.size() - 1) << answer.out;
    const Json json = Json::parse(answer.out);
    for (const auto& [pointer, value] : values.items())
      EXPECT_EQ(json.value(Json::json_pointer(pointer), Json("missing")), value) << pointer << " in " << json;
  }
};

// What `frontlux info --json` says, voxel by voxel.
template <class Tree>
Json expected_info(const Tree& tree) {
  using frontlux::Occupancy, frontlux::VoxelKey, frontlux::test::key_at;
  const auto state = [&](const VoxelKey& voxel) { return frontlux::test::state_of(tree, voxel); };
  const frontlux::KeyBox searched{key_at(-40, -40, -40), key_at(40, 40, 40)};
  frontlux::KeyBox bounds{searched.max, searched.min};
  for_each_key(searched, [&](const VoxelKey& voxel) {
    if (state(voxel) != Occupancy::kUnknown) bounds = hull(bounds, {voxel, voxel});
  });
  std::array<int, 3> count{};
  int frontiers = 0;
  for_each_key(bounds, [&](const VoxelKey& voxel) {
    ++count[static_cast<std::size_t>(state(voxel))];
    if (state(voxel) != Occupancy::kUnknown) return;
    for (const auto& [x, y, z] :
         {std::array{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
      if (state(*offset_key(voxel, x, y, z)) == Occupancy::kFree) {
        ++frontiers;
        return;
      }
  });
  const auto triple = [](const VoxelKey& voxel) { return Json{voxel.x, voxel.y, voxel.z}; };
  const std::size_t leaves = tree.getNumLeafNodes();
  return {{"/tree", tree.getTreeType()},
          {"/resolution_m", 0.1},
          {"/bounds/min_key", triple(bounds.min)},
          {"/bounds/max_key", triple(bounds.max)},
          {"/voxels", {{"occupied", count[2]}, {"free", count[1]}, {"unknown", count[0]}}},
          {"/frontiers", frontiers},
          {"/leaves", leaves},
          {"/inner_nodes", tree.size() - leaves},
          {"/memory_bytes/tree", tree.memoryUsage()}};
}

TEST_F(InfoCastCommand, InfoCountsEveryVoxel) {
  octomap::OcTree tree(kResolution);
  furnish(tree);
  expect_json({"info", path("map.bt")}, expected_info(tree));
  octomap::ColorOcTree color(kResolution);
  furnish(color);
  color.updateNode(key(-30, 7, -9), true);
  ASSERT_TRUE(color.write(path("map.ot")));
  expect_json({"info", path("map.ot")}, expected_info(color));
}

TEST_F(InfoCastCommand, InfoCountsFrontiersBesideLargeBlocks) {
  // Free blocks of 16 and 64 voxels, some next to each other, beside single voxels and what is unknown.
  octomap::OcTree tree(kResolution);
  const auto fill = [](octomap::OcTree& into, int x, int y, int z, int edge, float log_odds) {
    for_each_key(cube(frontlux::test::key_at(x, y, z), edge), [&](const frontlux::VoxelKey& voxel) {
      into.setNodeValue(frontlux::test::tree_key(voxel), log_odds, true);
    });
  };
  fill(tree, -16, -16, 0, 16, -2.F);
  fill(tree, 0, -16, 0, 16, -2.F);
  fill(tree, 0, 0, 0, 16, -2.F);
  fill(tree, -16, 0, -16, 8, 2.F);
  fill(tree, -8, 0, -16, 8, -2.F);
  fill(tree, 20, 20, -20, 2, -2.F);
  fill(tree, -30, -30, -30, 1, 2.F);
  tree.updateInnerOccupancy();
  tree.prune();
  ASSERT_TRUE(tree.write(path("blocks.ot")));
  expect_json({"info", path("blocks.ot")}, expected_info(tree));

  octomap::OcTree cube(1.0);
  fill(cube, 0, 0, 0, 64, -2.F);
  fill(cube, -2, -2, -2, 1, 2.F);
  fill(cube, 70, 70, 70, 1, 2.F);
  cube.updateInnerOccupancy();
  cube.prune();
  ASSERT_TRUE(cube.write(path("cube.ot")));
  expect_json({"info", path("cube.ot")}, {{"/frontiers", 6 * 64 * 64}});
}

TEST_F(InfoCastCommand, InfoIsReadable) {
  expect_answer({"info", path("map.bt")},
                {"map          " + path("map.bt") + " (OcTree)\n", "resolution   0.1 m\n", "bounds x     ",
                 " m, keys ", "voxels", "frontiers", "leaves", "inner nodes", "memory       tree "});
}

TEST_F(InfoCastCommand, InfoKnowsMapsWithoutVoxelsAndMapsWithAllOfThem) {
  octomap::OcTree empty(0.5);
  ASSERT_TRUE(empty.write(path("empty.ot")));
  expect_answer({"info", path("empty.ot")}, {"none: every voxel is unknown", "free         0 voxels"});
  expect_json({"info", path("empty.ot")}, {{"/bounds", nullptr}, {"/frontiers", 0}});

  const std::string header = "# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  write("all.ot", header + full_record(-1.F, 0));
  expect_json({"info", path("all.ot")},
              {{"/voxels/free", 281474976710656}, {"/voxels/unknown", 0}, {"/frontiers", 0}});
}

TEST_F(InfoCastCommand, InfoStaysQuickOnHugeBlocks) {
  // Four free eighths of the world that touch at edges only: 12 faces of 16.8 million bricks each.
  const std::string header = "# Octomap OcTree file\nid OcTree\nsize 5\nres 0.1\ndata\n";
  const std::string leaf = full_record(-1.F, 0);
  write("huge.ot", header + full_record(-1.F, 0x69) + leaf + leaf + leaf + leaf);
  const auto begin = std::chrono::steady_clock::now();
  expect_json({"info", path("huge.ot")}, {{"/voxels/free", 140737488355328},
                                          {"/voxels/unknown", 140737488355328},
                                          {"/frontiers", nullptr},
                                          {"/frontiers_note",
                                           "not counted: the surface of the map's large free "
                                           "blocks is too large"}});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  expect_answer({"info", path("huge.ot")}, {"frontiers    not counted"});
}

TEST_F(InfoCastCommand, LackOfMemoryIsCalledThat) {
  if (!frontlux::test::kLimitsAddresses) GTEST_SKIP() << kNoLimits;
  const std::string map = std::string(FRONTLUX_DATA_DIR) + "/maps/room_0.1m.bt";
  const std::vector<std::string> words = {"cast",        map,     "--from",   "0,0,1.2",
                                          "--direction", "1,0,0", "--caster", "embree"};
  const std::string hit = expect_answer(words, {"hit an occupied voxel"});
  int short_of_memory = 0;
  for (int kilobytes = 100000; kilobytes <= 420000; kilobytes += 40000) {
    SCOPED_TRACE(kilobytes);
    const Answer answer = run(words, "ulimit -v " + std::to_string(kilobytes) + ";");
    if (answer.code == 127) {  // the loader's
      expect_parts(answer.err, {"error while loading shared libraries"});
      continue;
    }
    if (answer.err.find("MPI_Init") != std::string::npos) continue;  // by Debian 13's Ipopt as it is loaded
    const bool has_enough = answer.code == 0;
    EXPECT_TRUE(has_enough || answer.code == 1) << answer.code;
    // A thread that cannot be had is called that.
    if (answer.err != "frontlux: pthread_create has failed: Resource temporarily unavailable\n") {
      EXPECT_EQ(answer.err, has_enough ? "" : "frontlux: not enough memory\n");
      short_of_memory += has_enough ? 0 : 1;
    }
    EXPECT_EQ(answer.out, has_enough ? hit : "");
  }
  EXPECT_GT(short_of_memory, 0);
}

TEST_F(InfoCastCommand, MapsThatDoNotFitIntoMemoryAreRefusedBeforeTheWorkBegins) {
  if (!frontlux::test::kLimitsAddresses) GTEST_SKIP() << kNoLimits;
  const std::string map = path("sparse.bt");
  frontlux::write_octree(*frontlux::test::make_sparse_tree(40),
                         map);  // the tree takes 64 MiB, the mirror 165
  // With what the command's libraries take, which depends on the system.
  int least = 50'000;  // [kB]
  const auto with = [](int limit) { return "ulimit -v " + std::to_string(limit) + ";"; };
  while (run({"--version"}, with(least)).code != 0 && least < 1'000'000) least += 10'000;
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"info", map},
           {"cast", map, "--from", "0,0,0.1", "--direction", "1,0,0"},
           {"render", map, "--robot", "uav", "--at", "3,3,3", "-o", path("x.csv")},
           {"plan", map, "--robot", "uav", "--from", "3,3,3,0", "--to", "4,4,4"},
           {"world", map},
           {"explore", map, "--start", "1,1,1", "-o", path("run")}}) {
    SCOPED_TRACE(words.front());
    expect_refused(words,
                   {map + ": its 64000 leaves would take ", " MiB of memory where ",
                    " are available; give a map of a coarser resolution"},
                   with(least + 200'000));
    expect_refused(words, {map + ": holds ", " nodes, which would take ", " MiB of memory where "},
                   with(least + 50'000));
  }
}

TEST_F(InfoCastCommand, CastSeesTheWall) {
  for (const std::string caster : kCasters) {
    SCOPED_TRACE(caster);
    const auto with = [&](const std::vector<std::string>& words) {
      return cast(joined(words, {"--caster", caster}));
    };
    expect_answer(with({"--from", "0.05,0.05,0.55", "--direction", "2,0,0"}),
                  {"hit an occupied voxel", "key 32772, 32768, 32773, occupied", "0.45, 0.05, 0.55 m"});
    expect_json(with({"--from", "0.05,0.05,0.55", "--to", "0.25,0.05,0.55"}),
                {{"/hit", true},
                 {"/stop", "occupied"},
                 {"/key", {32772, 32768, 32773}},
                 {"/state", "occupied"},
                 {"/end_m", {0.45, 0.05, 0.55}},
                 {"/entry_m", {0.4, 0.05, 0.55}},
                 {"/distance_m", 0.35},
                 {"/visible", true}});
    expect_json(with({"--from", "0.05,0.05,0.55", "--to", "0.65,0.05,0.55"}), {{"/visible", false}});
    expect_json(with({"--from", "0.05,0.35,0.35", "--to", "0.65,0.35,0.35"}), {{"/visible", true}});
    expect_answer(with({"--from", "0.05,0.05,0.55", "--direction", "1,0,0", "--range", "0.25"}),
                  {"nothing hit within --range", "key 32771, 32768, 32773, free"});
    expect_answer(with({"--from", "90,90,90", "--direction", "1,0,0"}), {"stopped by an unknown voxel"});
    expect_answer(with({"--from", "90,90,90", "--direction", "1,0,0", "--unknown", "pass", "--range", "1"}),
                  {"nothing hit within --range", "unknown"});
  }
  expect_answer(cast({"--from", "3000,90,90", "--direction", "1,0,0", "--unknown", "pass"}),
                {"end of the map's key range", "key 65535, "});
}

TEST_F(InfoCastCommand, CastCountsWhatItCrosses) {
  octomap::OcTree tree(kResolution);
  for (const int x : {0, 1, 5}) tree.updateNode(key(x, 0, 0), false);
  tree.updateNode(key(6, 0, 0), true);
  ASSERT_TRUE(tree.write(path("beam.ot")));
  for (const std::string caster : kCasters) {
    SCOPED_TRACE(caster);
    const auto count = [&](const std::vector<std::string>& words) {
      return joined({"cast", path("beam.ot"), "--from", "0.05,0.05,0.05", "--count", "--caster", caster},
                    words);
    };
    expect_answer(count({"--unknown", "pass", "--direction", "1,0,0"}),
                  {"crossed      3 unknown, 3 free, 0 occupied voxels (before this one)\n"});
    expect_answer(count({"--unknown", "pass", "--direction", "-1,0,0"}),
                  {"crossed      32768 unknown, 1 free, 0 occupied voxels (with this one)\n"});
    expect_json(count({"--to", "0.35,0.05,0.05", "--unknown", "pass"}),
                {{"/crossed", {{"unknown", 3}, {"free", 3}, {"occupied", 0}, {"stop", "occupied"}}},
                 {"/before_to", {{"unknown", 1}, {"free", 2}, {"occupied", 0}, {"stop", "reached"}}}});
    expect_answer(count({"--to", "0.35,0.05,0.05"}), {"before --to  0 unknown, 2 free, 0 occupied voxels (up "
                                                      "to the voxel that blocks the view)\n"});
  }
  EXPECT_EQ(run({"cast", path("beam.ot"), "--from", "0,0,0", "--to", "1,0,0"}).out.find("crossed"),
            std::string::npos);
}

TEST_F(InfoCastCommand, CastTakesNegativeNumbers) {
  const Answer first = run(cast({"--from=-0.45,-0.45,0.55", "--direction=-1,-.5,0"}));
  EXPECT_EQ(first.code, 0) << first.err;
  for (const auto& same : {cast({"--from", "-0.45,-0.45,0.55", "--direction", "-1,-.5,0"}),
                           cast({"--from", "-.45,-.45,+.55", "--direction", "-1,-5e-1,-0"})})
    EXPECT_EQ(run(same).out, first.out);
}

TEST_F(InfoCastCommand, RefusesWrongWords) {
  expect_refused({}, {"give a command; see frontlux --help"});
  expect_refused({"fly"}, {"unknown command 'fly'; see frontlux --help"});
  expect_refused({"--fast"}, {"unknown option '--fast'; see frontlux --help"});
  expect_refused({"info"}, {"MAP", "see frontlux info --help"});
  expect_refused({"info", path("map.bt"), "more"}, {"unexpected argument 'more'; see frontlux info --help"});
  expect_refused(cast({"--jsn"}),
                 {"unknown option '--jsn' (did you mean --json?); see frontlux cast --help"});
  expect_refused(cast({"--form", "1,2,3"}), {"unknown option '--form' (did you mean --from?)"});
  expect_refused(cast({"--dir=1,0,0"}), {"unknown option '--dir=1,0,0' (did you mean --direction?)"});
  expect_refused(cast({"--to-and-fro", "1,0,0"}), {"unknown option '--to-and-fro'; see"});
  expect_refused({"exlpore", "room"},
                 {"unknown command 'exlpore' (did you mean explore?); see frontlux --help"});
  expect_refused(cast({"--direction", "1,0,0"}), {"--from is required"});
  expect_refused(cast({"--from", "0,0,0"}), {"give --to or --direction"});
  expect_refused(cast({"--from", "0,0,0", "--to", "1,0,0", "--direction", "1,0,0"}),
                 {"--to excludes --direction; give only one of them"});
  expect_refused(cast({"--from", "0,0,0", "--from", "0,0,0", "--to", "1,0,0"}), {"--from"});
  expect_refused(cast({"--from", "0,0,0", "--to"}), {"--to"});
  expect_refused(cast({"--from", "0,0,0", "--to", "1,0,0", "--caster", "magic"}),
                 {"--caster: 'magic' is none of ", "embree, grid, octomap; see frontlux cast --help"});
  expect_refused(cast({"--from", "0,0,0", "--to", "1,0,0", "--unknown", "maybe"}),
                 {"--unknown: 'maybe' is none of block, pass"});
}

TEST_F(InfoCastCommand, RefusesWrongNumbers) {
  for (const std::string vector :
       {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "a,b,c", "1, 2, 3", "1;2;3", "1,2,nan", "inf,0,0",
        "-inf,0,0", "-nan,0,0", "1e399,0,0", "0x1,0,0", "1,2,3 "}) {
    const std::string told = ": '" + vector + "' is not three finite numbers; write x,y,z";
    expect_refused(cast({"--from", vector, "--direction", "1,0,0"}), {"--from" + told});
    expect_refused(cast({"--from", "0,0,0", "--direction", vector}), {"--direction" + told});
    expect_refused(cast({"--from", "0,0,0", "--to", vector}), {"--to" + told});
  }
  expect_refused(cast({"--from", "1e39,0,0", "--direction", "1,0,0"}), {"--from: '1e39,0,0' is too large"});
  for (const std::string range : {"0", "-1", "nan", "inf", "-inf", "1e999", "1m", "ten", "", "--json"})
    expect_refused(cast({"--from", "0,0,0", "--to", "1,0,0", "--range", range}),
                   {"--range: '" + range + "' is not a number above 0"});
  expect_refused(cast({"--from", "0,0,0", "--direction", "0,-0,0"}), {"--direction: 0, -0, 0 in single precision, which has no length"});
  expect_refused(cast({"--from", "1,0,0", "--to", "1,0,0"}), {"--to: 1, 0, 0 is the point of --from"});
}

TEST_F(InfoCastCommand, RefusesPointsOutsideTheMap) {
  const std::string range = "from -3276.8 m to below 3276.8 m";
  expect_refused(cast({"--from", "0,3276.8,0", "--direction", "1,0,0"}), {"--from: y = 3276.8 m", range});
  expect_refused(cast({"--from", "0,0,-3277", "--direction", "1,0,0"}), {"--from: z = -3277 m", range});
  expect_refused(cast({"--from", "0,0,0", "--to", "1e38,0,0"}), {"--to: x = 1e+38 m", range});
}

TEST_F(InfoCastCommand, RefusesWrongFiles) {
  write("foreign.bt", "hello\n");
  std::filesystem::copy_file(path("map.bt"), path("cut.bt"));
  std::filesystem::resize_file(path("cut.bt"), std::filesystem::file_size(path("cut.bt")) - 1);
  for (const std::string command : {"info", "cast"}) {
    const auto with = [&](const std::string& map) {
      std::vector<std::string> words = {command, map};
      if (command == "cast") words.insert(words.end(), {"--from", "0,0,0", "--to", "1,0,0"});
      return words;
    };
    expect_refused(with(path("none.bt")), {path("none.bt"), "no such file"});
    expect_refused(with(""), {"no such file"});
    expect_refused(with(folder_.string()), {folder_.string(), "directory"});
    expect_refused(with(path("foreign.bt")), {path("foreign.bt"), "does not begin with"});
    expect_refused(with(path("cut.bt")), {path("cut.bt"), "ends inside the tree", "byte"});
  }
}

}  // namespace
