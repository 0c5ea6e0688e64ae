// `frontlux render` from the outside: its files against brute force, and what it refuses.

#include "app/paper_robot.hpp"
#include "octomap/quiet_octomap.hpp"
#include "planner/goal/goal_room.hpp"
#include "support/command_test.hpp"
#include "support/giant_leaf.hpp"
#include "support/tree_state.hpp"

#include <octomap/OcTree.h>

namespace frontlux::test {
namespace {

class RenderCommand : public CommandTest {
 protected:
  RenderCommand() : CommandTest("render"), room_(34, 8, 5) {
    room_.clear(17, 17, 2, 3);
    octomap::OcTree tree(0.3);
    for_each_key(room_.bounds(), [&](const VoxelKey& key) {
      const Occupancy state = room_.grid.at(key);
      if (state != Occupancy::kUnknown) tree.updateNode(tree_key(key), state == Occupancy::kOccupied);
    });
    std::ofstream map(path("room.bt"), std::ios::binary);
    tree.writeBinary(map);
  }

  [[nodiscard]] std::vector<std::string> words(const std::string& robot, const std::string& at,
                                               const std::string& output,
                                               const std::vector<std::string>& more = {}) const {
    return joined({path("room.bt"), "--robot", robot, "--at", at, "-o", path(output)}, more);
  }

  GoalRoom room_;
};

constexpr const char* kStart = "5.25,5.25,0.75";

std::vector<std::vector<double>> table_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "key_x,key_y,key_z,x,y,z,distance,gain,standard_error,quality,hits,yaw");
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(std::stod(cell));
    EXPECT_EQ(rows.back().size(), 12U);
  }
  return rows;
}

TEST_F(RenderCommand, TableAgreesWithBruteForce) {
  const auto caster = make_grid_ray_caster(room_.grid);
  const planner::Robot robot = planner::ugv();
  const KeyBox bounds = room_.grid.known_bounds().value();
  planner::TravelCorridor corridor(robot.travel, room_.grid.lattice(), bounds);
  corridor.update({room_.grid}, room_.key(17, 17, 2));
  const FrontierSet set(room_.grid, bounds);
  const std::vector<VoxelKey> frontiers(set.keys().begin(), set.keys().end());
  const auto assigned = naive_assigned(*caster, 0.3, frontiers, corridor.cells(), robot.view);
  ASSERT_GT(assigned.size(), 10U);

  std::string first;
  for (const char* used : {"grid", "embree", "fast"}) {
    const std::string out = expect_answer(words("ugv", kStart, "room.csv", {"--caster", used}));
    const std::string csv = content_of(path("room.csv"));
    if (first.empty()) first = csv;
    EXPECT_EQ(csv, first);
    expect_parts(out, {std::to_string(frontiers.size()) + ", " + std::to_string(assigned.size()) +
                       " of them assigned to the ugv"});
  }
  const auto rows = table_of(first);
  ASSERT_EQ(rows.size(), corridor.cells().size());
  double most = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const VoxelKey& cell = corridor.cells()[i];
    const auto& row = rows[i];
    EXPECT_EQ(row[0], cell.x);
    EXPECT_EQ(row[1], cell.y);
    EXPECT_EQ(row[2], cell.z);
    EXPECT_NEAR(row[3], room_.grid.lattice().center(cell.x), 1e-6);
    EXPECT_EQ(row[6], corridor.distance(cell).value());
    const auto gain = static_cast<double>(naive_seen(*caster, 0.3, cell, assigned, robot.view).size());
    EXPECT_EQ(row[7], gain);
    EXPECT_EQ(row[8], 0.0);
    // Eq. 1, and less in proportion for what is nearer than 4 m.
    EXPECT_NEAR(row[9], gain * std::exp(-0.1386 * row[6]) * std::min(1.0, row[6] / 4.0), 1e-9);
    EXPECT_EQ(row[10], gain);
    most = std::max(most, gain);
  }
  EXPECT_GT(most, 5.0);
}

TEST_F(RenderCommand, PicturesArePngsWideEnoughAndTheSameEachTime) {
  for (const std::string mode : {"default", "paper"})
    for (const std::string robot : {"ugv", "uav"}) {
      const std::string at = robot == "ugv" ? kStart : "5.25,5.25,1.35";
      std::string first;
      for (int i = 0; i < 2; ++i) {
        expect_answer(words(robot, at, "room.png", {"--mode", mode}), {"goal         "});
        const std::string png = content_of(path("room.png"));
        expect_png(png, 900, 600);
        if (i == 0) first = png;
        EXPECT_EQ(png, first);
      }
    }
}

TEST_F(RenderCommand, PicturesAreVectorsToo) {
  for (const std::string ending : {".svg", ".pdf"}) {
    const std::string file = "room" + ending;
    expect_answer(words("ugv", kStart, file, {"--show", "layer"}), {"goal         "});
    const std::string picture = content_of(path(file));
    expect_parts(picture, {ending == ".svg" ? "</svg>" : "%%EOF"});
    expect_answer(words("ugv", kStart, file, {"--show", "layer"}));
    EXPECT_TRUE(content_of(path(file)) == picture) << file;
  }
}

TEST_F(RenderCommand, PointsHoldAllCells) {
  for (const char* file : {"room.csv", "room.ply"}) expect_answer(words("uav", "5.25,5.25,1.35", file));
  const auto rows = table_of(content_of(path("room.csv")));
  const std::string ply = content_of(path("room.ply"));
  expect_parts(ply, {"element vertex " + std::to_string(rows.size()) + "\n"});
  const std::size_t body = ply.find("end_header\n") + 11;
  constexpr std::size_t kRow = 8 * 4 + 4 + 3;
  ASSERT_EQ(ply.size() - body, rows.size() * kRow);
  for (std::size_t i = 0; i < rows.size(); i += 13) {
    float numbers[8];
    std::memcpy(numbers, ply.data() + body + i * kRow, sizeof numbers);
    for (int c = 0; c < 7; ++c)
      EXPECT_EQ(numbers[c], static_cast<float>(rows[i][static_cast<std::size_t>(3 + c)])) << c;
    EXPECT_EQ(numbers[7], static_cast<float>(rows[i][11]));
  }
}

TEST_F(RenderCommand, TakesARobotFromAFile) {
  for (const std::string robot : {"ugv", "uav"}) {
    const std::string at = robot == "ugv" ? kStart : "5.25,5.25,1.65";
    expect_answer(words(robot, at, "word.csv"), {});
    expect_answer(words(write(robot + ".json", test::paper_robot(robot)), at, "file.csv"), {});
    EXPECT_EQ(content_of(path("file.csv")), content_of(path("word.csv")));
  }
}

TEST_F(RenderCommand, RefusesGiantLeavesBeforeTheWorkBegins) {
  for (unsigned depth = 2; depth < 7; ++depth)
    for (const std::string robot : {"ugv", "uav"}) {
      SCOPED_TRACE(std::to_string(depth) + " " + robot);
      const std::string map = write("giant.bt", giant_leaf(depth));
      ASSERT_LT(content_of(map).size(), 120U);
      const std::vector<std::string> words = {map, "--robot", robot, "--at", "3,3,3", "-o", path("x.csv")};
      const std::vector<std::string> any =
          robot == "ugv" ? std::vector<std::string>{"--any-ground"} : std::vector<std::string>{};
      expect_refused(joined(words, any), {map + ": ", "with --bounds"}, "ulimit -t 3;");
      expect_answer(joined(joined(words, any), {"--bounds", "-1,-1,-1,5,5,5"}), {"goal         "});
    }
}

TEST_F(RenderCommand, RefusesWhatItCannotWorkWith) {
  const std::string map = path("room.bt"), out = path("x.png");
  const auto refuse = [&](const std::string& robot, const std::string& at,
                          const std::vector<std::string>& more, const std::vector<std::string>& parts) {
    expect_refused(words(robot, at, "x.png", more), parts);
  };
  refuse("ugv", "nan,0,0", {}, {"--at: 'nan,0,0' is not three finite numbers"});
  refuse("ugv", "1,2", {}, {"--at: '1,2' is not three finite numbers"});
  refuse("ugv", "1e9,0,0", {}, {"--at: 1e+09, 0, 0", "key range"});
  refuse("boat", kStart, {}, {"--robot: 'boat' is none of ugv, uav, and no file"});
  expect_refused(words("ugv", kStart, "x.jpg"),
                 {"--output", "x.jpg does not end in .png or .svg or .pdf or .ply or .csv"});
  expect_refused(words("ugv", kStart, "no/x.png"), {"--output", "there is no folder"});
  expect_refused(words("ugv", kStart, "x.csv", {"--show", "layer"}), {"--show: "});
  for (const std::string samples : {"0", "x", "1.5", ""})
    refuse("uav", kStart, {"--samples", samples}, {"--samples: '" + samples + "' is not", ", or all"});
  refuse("uav", kStart, {"--seed", "-1"}, {"--seed", "'-1'"});
  refuse("ugv", kStart, {"--samples", "5"}, {"--samples: of the ugv all frontiers are counted, not drawn"});
  refuse("ugv", kStart, {"--seed", "5"}, {"--seed: all frontiers are counted, not drawn"});
  refuse("uav", kStart, {"--samples", "all", "--seed", "5"}, {"--seed: all frontiers are counted"});
  refuse("ugv", kStart, {"--mode", "fast"}, {"--mode", "fast"});
  refuse("ugv", kStart, {"--caster", "gpu"}, {"--caster", "gpu"});
  refuse("ugv", kStart, {"--floor", "1"}, {"--floor: the ugv stays on the ground"});
  refuse("uav", kStart, {"--any-ground"}, {"--any-ground: the uav does not drive"});
  refuse("ugv", kStart, {"--bounds", "0,0,0,1,1"}, {"--bounds: '0,0,0,1,1' is not six finite numbers"});
  refuse("ugv", kStart, {"--bounds", "50,50,0,60,60,1"}, {"--bounds: no voxel within is known"});
  refuse("ugv", kStart, {"--bounds", "1,1,1,0,0,0"},
         {"--bounds: the box goes from 1 m to 0 m along x: give the lower corner first"});
  refuse("uav", kStart, {"--floor", "inf"}, {"--floor: 'inf' is not a finite number"});
  refuse("uav", "5.25,5.25,0.45", {}, {"--at", "below its minimum height"});
  refuse("ugv", "5.25,5.25,-0.15", {}, {"--at", "occupied voxel"});
  refuse("ugv", "50,5,0.75", {}, {"--at", "outside the bounds"});
  for (const std::string& file : {path("none.bt"), write("broken.bt", "# Octomap OcTree binary file\n")})
    expect_refused({file, "--robot", "ugv", "--at", kStart, "-o", out}, {file});
  octomap::OcTree full(0.3);
  for_each_key({room_.key(0, 0, -1), room_.key(7, 7, 5)},
               [&](const VoxelKey& key) { full.updateNode(tree_key(key), key.z < Lattice::kOrigin); });
  {
    std::ofstream stream(path("full.bt"), std::ios::binary);
    full.writeBinary(stream);
  }
  expect_refused({path("full.bt"), "--robot", "ugv", "--at", "1.05,1.05,0.75", "-o", out},
                 {"full.bt", "the map has no frontiers"});
}

}  // namespace
}  // namespace frontlux::test
