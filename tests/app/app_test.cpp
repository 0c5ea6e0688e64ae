#include "support/command.hpp"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <random>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using frontlux::test::Answer;
using frontlux::test::content_of;

constexpr double kResolution = 0.1;
constexpr int kOrigin = 32768;

octomap::OcTreeKey key(int x, int y, int z) {
  const auto along = [](int i) { return static_cast<octomap::key_type>(kOrigin + i); };
  return {along(x), along(y), along(z)};
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

class AppTest : public testing::Test {
 protected:
  AppTest() : folder_(std::filesystem::temp_directory_path() / ("frontlux_app_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    octomap::OcTree tree(kResolution);
    furnish(tree);
    std::ofstream map(file("map.bt"), std::ios::binary);
    tree.writeBinary(map);
  }
  ~AppTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] Answer run(const std::vector<std::string>& words) const {
    return frontlux::test::run_frontlux(words, folder_);
  }

  [[nodiscard]] Answer cast(const std::vector<std::string>& words) const {
    std::vector<std::string> all = {"cast", file("map.bt")};
    all.insert(all.end(), words.begin(), words.end());
    return run(all);
  }

  static void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
    for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
  }

  static void expect_refusal(const Answer& answer, const std::vector<std::string>& parts) {
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    EXPECT_TRUE(answer.err.starts_with("frontlux: ")) << answer.err;
    EXPECT_EQ(answer.err.find('\n'), answer.err.size() - 1) << answer.err;
    expect_parts(answer.err, parts);
  }

  static void expect_answer(const Answer& answer, const std::vector<std::string>& parts) {
    EXPECT_EQ(answer.code, 0);
    EXPECT_EQ(answer.err, "");
    expect_parts(answer.out, parts);
  }

  std::filesystem::path folder_;
};

// What `frontlux info --json` says, voxel by voxel.
template <class Tree>
std::vector<std::string> expected_info(const Tree& tree) {
  enum { kUnknown, kFree, kOccupied };
  const auto state = [&](int x, int y, int z) {
    const auto* node = tree.search(key(x, y, z));
    return node == nullptr ? kUnknown : tree.isNodeOccupied(node) ? kOccupied : kFree;
  };
  constexpr int kFar = 40;
  std::array<int, 3> min{kFar, kFar, kFar}, max{-kFar, -kFar, -kFar};
  std::array<int, 3> count{};
  for (int x = -kFar; x <= kFar; ++x)
    for (int y = -kFar; y <= kFar; ++y)
      for (int z = -kFar; z <= kFar; ++z) {
        if (state(x, y, z) == kUnknown) continue;
        min = {std::min(min[0], x), std::min(min[1], y), std::min(min[2], z)};
        max = {std::max(max[0], x), std::max(max[1], y), std::max(max[2], z)};
      }
  int frontiers = 0;
  for (int x = min[0]; x <= max[0]; ++x)
    for (int y = min[1]; y <= max[1]; ++y)
      for (int z = min[2]; z <= max[2]; ++z) {
        ++count[static_cast<std::size_t>(state(x, y, z))];
        if (state(x, y, z) == kUnknown &&
            (state(x - 1, y, z) == kFree || state(x + 1, y, z) == kFree || state(x, y - 1, z) == kFree ||
             state(x, y + 1, z) == kFree || state(x, y, z - 1) == kFree || state(x, y, z + 1) == kFree))
          ++frontiers;
      }
  const auto triple = [](const std::array<int, 3>& k) {
    return "[" + std::to_string(k[0] + kOrigin) + ", " + std::to_string(k[1] + kOrigin) + ", " +
           std::to_string(k[2] + kOrigin) + "]";
  };
  const std::size_t leaves = tree.getNumLeafNodes();
  return {"\"tree\": \"" + tree.getTreeType() + "\"",
          "\"resolution_m\": 0.1",
          "\"min_key\": " + triple(min),
          "\"max_key\": " + triple(max),
          "\"voxels\": {\"occupied\": " + std::to_string(count[kOccupied]) + ", \"free\": " +
              std::to_string(count[kFree]) + ", \"unknown\": " + std::to_string(count[kUnknown]) + "}",
          "\"frontiers\": " + std::to_string(frontiers) + ",",
          "\"leaves\": " + std::to_string(leaves) + ",",
          "\"inner_nodes\": " + std::to_string(tree.size() - leaves) + ",",
          "\"memory_bytes\": {\"tree\": " + std::to_string(tree.memoryUsage())};
}

TEST_F(AppTest, InfoCountsEveryVoxel) {
  octomap::OcTree tree(kResolution);
  furnish(tree);
  expect_answer(run({"info", "--json", file("map.bt")}), expected_info(tree));
  octomap::ColorOcTree color(kResolution);
  furnish(color);
  color.updateNode(key(-30, 7, -9), true);
  ASSERT_TRUE(color.write(file("map.ot")));
  expect_answer(run({"info", "--json", file("map.ot")}), expected_info(color));
}

TEST_F(AppTest, InfoCountsFrontiersBesideLargeBlocks) {
  // Free blocks of 16 and 64 voxels, some next to each other, beside single voxels and what is unknown.
  octomap::OcTree tree(kResolution);
  const auto fill = [&](int x, int y, int z, int edge, float log_odds) {
    for (int i = 0; i < edge; ++i)
      for (int j = 0; j < edge; ++j)
        for (int k = 0; k < edge; ++k) tree.setNodeValue(key(x + i, y + j, z + k), log_odds, true);
  };
  fill(-16, -16, 0, 16, -2.F);
  fill(0, -16, 0, 16, -2.F);
  fill(0, 0, 0, 16, -2.F);
  fill(-16, 0, -16, 8, 2.F);
  fill(-8, 0, -16, 8, -2.F);
  fill(20, 20, -20, 2, -2.F);
  fill(-30, -30, -30, 1, 2.F);
  tree.updateInnerOccupancy();
  tree.prune();
  ASSERT_TRUE(tree.write(file("blocks.ot")));
  expect_answer(run({"info", "--json", file("blocks.ot")}), expected_info(tree));

  octomap::OcTree cube(1.0);
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y)
      for (int z = 0; z < 64; ++z) cube.setNodeValue(key(x, y, z), -2.F, true);
  cube.setNodeValue(key(-2, -2, -2), 2.F, true);
  cube.setNodeValue(key(70, 70, 70), 2.F, true);
  cube.updateInnerOccupancy();
  cube.prune();
  ASSERT_TRUE(cube.write(file("cube.ot")));
  expect_answer(run({"info", "--json", file("cube.ot")}), {"\"frontiers\": " + std::to_string(6 * 64 * 64)});
}

TEST_F(AppTest, InfoIsReadable) {
  const Answer answer = run({"info", file("map.bt")});
  expect_answer(answer,
                {"map          " + file("map.bt") + " (OcTree)\n", "resolution   0.1 m\n", "bounds x     ",
                 " m, keys ", "voxels", "frontiers", "leaves", "inner nodes", "memory       tree "});
}

std::string full_record(float log_odds, int child_mask) {
  std::string record(4, '\0');
  std::memcpy(record.data(), &log_odds, 4);
  return record + static_cast<char>(child_mask);
}

TEST_F(AppTest, InfoKnowsMapsWithoutVoxelsAndMapsWithAllOfThem) {
  octomap::OcTree empty(0.5);
  ASSERT_TRUE(empty.write(file("empty.ot")));
  expect_answer(run({"info", file("empty.ot")}), {"none: every voxel is unknown", "free         0 voxels"});
  expect_answer(run({"info", "--json", file("empty.ot")}), {"\"bounds\": null", "\"frontiers\": 0"});

  const std::string header = "# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  std::ofstream(file("all.ot"), std::ios::binary) << header << full_record(-1.F, 0);
  expect_answer(run({"info", "--json", file("all.ot")}),
                {"\"free\": 281474976710656, \"unknown\": 0", "\"frontiers\": 0"});
}

TEST_F(AppTest, InfoStaysQuickOnHugeBlocks) {
  // Four free eighths of the world that touch at edges only: 12 faces of 16.8 million bricks each.
  const std::string header = "# Octomap OcTree file\nid OcTree\nsize 5\nres 0.1\ndata\n";
  const std::string leaf = full_record(-1.F, 0);
  std::ofstream(file("huge.ot"), std::ios::binary)
      << header << full_record(-1.F, 0x69) << leaf << leaf << leaf << leaf;
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = run({"info", "--json", file("huge.ot")});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  expect_answer(answer, {"\"free\": 140737488355328, \"unknown\": 140737488355328", "\"frontiers\": null",
                         "not counted"});
}

TEST_F(AppTest, CastSeesTheWall) {
  for (const std::string caster : {"fast", "embree", "grid", "octomap"}) {
    SCOPED_TRACE(caster);
    expect_answer(cast({"--from", "0.05,0.05,0.55", "--direction", "2,0,0", "--caster", caster}),
                  {"hit an occupied voxel", "key 32772, 32768, 32773, occupied", "0.45, 0.05, 0.55 m"});
    expect_answer(cast({"--json", "--from", "0.05,0.05,0.55", "--to", "0.25,0.05,0.55", "--caster", caster}),
                  {"\"hit\": true", "\"stop\": \"occupied\"", "\"key\": [32772, 32768, 32773]",
                   "\"state\": \"occupied\"", "\"end_m\": [0.45, 0.05, 0.55]",
                   "\"entry_m\": [0.4, 0.05, 0.55]", "\"distance_m\": 0.35", "\"visible\": true"});
    expect_answer(cast({"--json", "--from", "0.05,0.05,0.55", "--to", "0.65,0.05,0.55", "--caster", caster}),
                  {"\"visible\": false"});
    expect_answer(cast({"--json", "--from", "0.05,0.35,0.35", "--to", "0.65,0.35,0.35", "--caster", caster}),
                  {"\"visible\": true"});
    expect_answer(
        cast({"--from", "0.05,0.05,0.55", "--direction", "1,0,0", "--range", "0.25", "--caster", caster}),
        {"nothing within --range", "key 32771, 32768, 32773, free"});
    expect_answer(cast({"--from", "90,90,90", "--direction", "1,0,0", "--caster", caster}),
                  {"stopped by an unknown voxel"});
    expect_answer(cast({"--from", "90,90,90", "--direction", "1,0,0", "--unknown", "pass", "--range", "1",
                        "--caster", caster}),
                  {"nothing within --range", "unknown"});
  }
  expect_answer(cast({"--from", "3000,90,90", "--direction", "1,0,0", "--unknown", "pass"}),
                {"end of the map's key range", "key 65535, "});
}

TEST_F(AppTest, CastCountsWhatItCrosses) {
  octomap::OcTree tree(kResolution);
  for (const int x : {0, 1, 5}) tree.updateNode(key(x, 0, 0), false);
  tree.updateNode(key(6, 0, 0), true);
  ASSERT_TRUE(tree.write(file("beam.ot")));
  const auto count = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = {"cast", file("beam.ot"), "--from", "0.05,0.05,0.05", "--count"};
    all.insert(all.end(), words.begin(), words.end());
    return run(all);
  };
  for (const std::string caster : {"fast", "embree", "grid", "octomap"}) {
    SCOPED_TRACE(caster);
    expect_answer(count({"--unknown", "pass", "--direction", "1,0,0", "--caster", caster}),
                  {"crossed      3 unknown, 3 free, 0 occupied voxels (before this one)\n"});
    expect_answer(count({"--unknown", "pass", "--direction", "-1,0,0", "--caster", caster}),
                  {"crossed      32768 unknown, 1 free, 0 occupied voxels (with this one)\n"});
    expect_answer(count({"--json", "--to", "0.35,0.05,0.05", "--unknown", "pass", "--caster", caster}),
                  {R"("crossed": {"unknown": 3, "free": 3, "occupied": 0, "stop": "occupied"})",
                   R"("before_to": {"unknown": 1, "free": 2, "occupied": 0, "stop": "reached"})"});
    expect_answer(
        count({"--to", "0.35,0.05,0.05", "--caster", caster}),
        {"on the way   0 unknown, 2 free, 0 occupied voxels (before the way to that of --to ends)\n"});
  }
  EXPECT_EQ(run({"cast", file("beam.ot"), "--from", "0,0,0", "--to", "1,0,0"}).out.find("crossed"),
            std::string::npos);
}

TEST_F(AppTest, CastTakesNegativeNumbers) {
  const Answer first = cast({"--from=-0.45,-0.45,0.55", "--direction=-1,-.5,0"});
  expect_answer(first, {"key "});
  EXPECT_EQ(cast({"--from", "-0.45,-0.45,0.55", "--direction", "-1,-.5,0"}).out, first.out);
  EXPECT_EQ(cast({"--from", "-.45,-.45,+.55", "--direction", "-1,-5e-1,-0"}).out, first.out);
}

TEST_F(AppTest, RefusesWrongWords) {
  expect_refusal(run({}), {"subcommand", "--help"});
  expect_refusal(run({"fly"}), {"'fly'", "--help"});
  expect_refusal(run({"--fast"}), {"'--fast'"});
  expect_refusal(run({"info"}), {"MAP"});
  expect_refusal(run({"info", file("map.bt"), "more"}), {"'more'"});
  expect_refusal(cast({"--form", "1,2,3"}), {"'--form'"});
  expect_refusal(cast({"--direction", "1,0,0"}), {"--from"});
  expect_refusal(cast({"--from", "0,0,0"}), {"--to or --direction"});
  expect_refusal(cast({"--from", "0,0,0", "--to", "1,0,0", "--direction", "1,0,0"}), {"--to or --direction"});
  expect_refusal(cast({"--from", "0,0,0", "--from", "0,0,0", "--to", "1,0,0"}), {"--from"});
  expect_refusal(cast({"--from", "0,0,0", "--to", "1,0,0", "--caster", "magic"}), {"magic", "embree"});
  expect_refusal(cast({"--from", "0,0,0", "--to", "1,0,0", "--unknown", "maybe"}), {"maybe", "pass"});
}

TEST_F(AppTest, RefusesWrongNumbers) {
  for (const std::string vector :
       {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "a,b,c", "1, 2, 3", "1;2;3", "1,2,nan", "inf,0,0",
        "-inf,0,0", "-nan,0,0", "1e39,0,0", "0x1,0,0", "1,2,3 "}) {
    expect_refusal(cast({"--from", vector, "--direction", "1,0,0"}), {"--from", "'" + vector + "'"});
    if (vector.empty()) continue;
    expect_refusal(cast({"--from", "0,0,0", "--direction", vector}), {"--direction", "'" + vector + "'"});
    expect_refusal(cast({"--from", "0,0,0", "--to", vector}), {"--to", "'" + vector + "'"});
  }
  for (const std::string range : {"0", "-1", "nan", "inf", "-inf", "1e999", "1m", "ten"})
    expect_refusal(cast({"--from", "0,0,0", "--to", "1,0,0", "--range", range}), {"--range", range});
  expect_refusal(cast({"--from", "0,0,0", "--direction", "0,-0,0"}), {"0,-0,0", "no length"});
  expect_refusal(cast({"--from", "1,0,0", "--to", "1,0,0"}), {"--to", "1,0,0"});
}

TEST_F(AppTest, RefusesPointsOutsideTheMap) {
  const std::string range = "from -3276.8 m to below 3276.8 m";
  expect_refusal(cast({"--from", "0,3276.8,0", "--direction", "1,0,0"}), {"--from: y = 3276.8 m", range});
  expect_refusal(cast({"--from", "0,0,-3277", "--direction", "1,0,0"}), {"--from: z = -3277 m", range});
  expect_refusal(cast({"--from", "0,0,0", "--to", "1e38,0,0"}), {"--to: x = 1e+38 m", range});
}

TEST_F(AppTest, RefusesWrongFiles) {
  for (const std::string command : {"info", "cast"}) {
    const auto with = [&](const std::string& path) {
      std::vector<std::string> words = {command, path};
      if (command == "cast") words.insert(words.end(), {"--from", "0,0,0", "--to", "1,0,0"});
      return run(words);
    };
    expect_refusal(with(file("none.bt")), {file("none.bt"), "no such file"});
    expect_refusal(with(""), {"no such file"});
    expect_refusal(with(folder_.string()), {folder_.string(), "directory"});
    std::ofstream(file("foreign.bt")) << "hello\n";
    expect_refusal(with(file("foreign.bt")), {file("foreign.bt"), "does not begin with"});
    std::filesystem::copy_file(file("map.bt"), file("cut.bt"),
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(file("cut.bt"), std::filesystem::file_size(file("cut.bt")) - 1);
    expect_refusal(with(file("cut.bt")), {file("cut.bt"), "ends inside the tree", "byte"});
  }
}

TEST_F(AppTest, HelpTeaches) {
  expect_answer(run({"--help"}), {"info", "cast", "Examples:", "Exit code"});
  expect_answer(run({"info", "--help"}), {"Example", "frontlux info building.bt"});
  expect_answer(run({"cast", "--help"}),
                {"Example", "frontlux cast building.bt --from", "--unknown", "--count"});
  expect_answer(run({"--version"}), {"frontlux "});
}

}  // namespace
