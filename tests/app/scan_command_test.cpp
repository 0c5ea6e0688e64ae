#include "support/command_test.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <octomap/OcTree.h>
#include <sys/stat.h>

namespace frontlux::sim {
namespace {

using test::content_of;

class ScanCommand : public test::CommandTest {
 protected:
  ScanCommand() : CommandTest("scan") { std::filesystem::create_directory(folder_ / "maps"); }
  [[nodiscard]] std::string map(const std::string& name) const { return (folder_ / "maps" / name).string(); }
};

TEST_F(ScanCommand, MapsARoomTwiceTheSame) {
  const auto words = [&](const std::string& output) {
    return std::vector<std::string>{"room",      "--sweep", "5",  "--noise",  "0.01",
                                    "--dropout", "0.1",     "-o", map(output)};
  };
  expect_answer(words("a.ot"), {"world        room\n", "scans        ", "free         ", "occupied     ",
                                "unknown      ", "% of the observable space", "right        ",
                                "ugv          starts at", "uav          starts at"});
  expect_answer(words("b.ot"));
  EXPECT_TRUE(content_of(map("a.ot")) == content_of(map("b.ot")));
  EXPECT_EQ(std::get<std::shared_ptr<octomap::OcTree>>(read_octree(map("a.ot")))->getResolution(), 0.3);
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--seed", "2"}, {"--stray", "0.01"}, {"--sensor-model", "cautious"}}) {
    expect_answer(test::joined(words("b.ot"), other));
    EXPECT_FALSE(content_of(map("a.ot")) == content_of(map("b.ot"))) << other[0];
  }
}

TEST_F(ScanCommand, LooksFromThePosesOfAFile) {
  const World world = make_world("room", 1);
  const std::string start = std::to_string(world.start->x()) + ", " + std::to_string(world.start->y());
  const std::string poses =
      write("poses.csv", "x,y,z,yaw\n# the start\n" + start + ",1,0\n\n" + start + ",1.5,3.1\n");
  expect_answer({"room", "--poses", poses, "-o", map("both.bt")}, {"scans        4\n"});
  expect_answer({"room", "--poses", poses, "--robot", "uav", "-o", map("one.bt")}, {"scans        2\n"});
  expect_answer(
      {"room", "--poses", poses, "--robot", FRONTLUX_DATA_DIR "/robots/uav.json", "-o", map("file.bt")});
  EXPECT_EQ(content_of(map("file.bt")), content_of(map("one.bt")));
}

TEST_F(ScanCommand, RefusesPosesByLine) {
  const auto with = [&](const std::string& text) {
    return std::vector<std::string>{"room", "--poses", write("poses.csv", text), "-o", map("no.bt")};
  };
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"1,2\n", "line 1: has 2 fields instead of 4"},
           {"x,y,z,yaw\n8,8,1,nan\n", "line 2: 'nan' is no finite number"},
           {"8.4,8.3,1,0\n\n8,8,1,east\n", "line 3: 'east' is no finite number"},
           {"8.4,8.3,1,0\n8.4,8.3,99,0\n", "line 2: the sensor at 8.4, 8.3, 99 m is outside"},
           {"8.4,8.3,1,0\n8.4,8.3,-0.1,0\n", "line 2: the sensor at 8.4, 8.3, -0.1 m is in a wall"},
           {"8.4,8.3,1e999,0\n", "line 1"},
           {"# nothing\n", "holds no pose"},
           {"", "holds no pose"}})
    expect_refused(with(text), {path("poses.csv"), part});
  expect_refused({"room", "--poses", path("none.csv"), "-o", map("no.bt")}, {path("none.csv")});
  expect_refused({"room", "--poses", folder_.string(), "-o", map("no.bt")}, {folder_.string()});
  expect_refused({"room", "--poses", path("none.csv"), "--sweep", "-o", map("no.bt")}, {"--sweep"});
}

TEST_F(ScanCommand, RefusesWhatItCannotUse) {
  const auto expect = [&](const std::vector<std::string>& words, const std::vector<std::string>& parts) {
    expect_refused(test::joined(words, {"-o", map("no.bt")}), parts);
  };
  expect({}, {"WORLD"});
  expect({"attic"}, {"'attic'", "room"});
  expect({path("none.ply")}, {path("none.ply")});
  expect({folder_.string()}, {folder_.string()});
  expect({"room", "--resolution", "0"}, {"--resolution", "0"});
  expect({"room", "--resolution", "1e-9"}, {"--resolution", "1e-9"});
  expect({"room", "--resolution", "0.003"}, {"too many"});
  expect({"room", "--sweep", "0"}, {"--sweep", "0"});
  expect({"room", "--sweep", "-1"}, {"--sweep", "-1"});
  expect({"room", "--sweep", "wide"}, {"--sweep", "wide"});
  expect(
      {"room", "--resolution", "0.1", "--sweep", "0.02"},
      {"room: sweep: a spacing of 0.02 m means looking at ", " places, more than 262144", "give a larger"});
  expect({"room", "--robot", "tank"}, {"--robot", "'tank'"});
  expect({"room", "--noise", "-1"}, {"--noise", "-1"});
  expect({"room", "--noise", "nan"}, {"--noise", "nan"});
  expect({"room", "--dropout", "1.5"}, {"--dropout", "1.5"});
  expect({"room", "--poses", write("poses.csv", "8.45,8.35,1.5,0\n"), "--dropout", "1"},
         {"the scans make no voxel free or occupied"});
  expect({"room", "--seed", "x"}, {"--seed", "'x'"});
  expect({"room", "--start", "99,0,0"}, {"--start", "99"});
  expect({"room", "--start", "-0.1,6,1"}, {"room", "solid"});
  write_ply(path("whole.ply"), make_world("room", 1).mesh);
  expect({path("whole.ply")}, {"whole.ply", "--start"});
  // In the wall, 2 cm from its surface.
  expect({path("whole.ply"), "--start", "0.02,6,1"}, {"whole.ply", "in a wall: triangle"});
  expect({write("half.ply", content_of(path("whole.ply")).substr(0, 5000)), "--start", "6,3,1"},
         {"half.ply"});
  expect({path("whole.ply"), "--start", "8000,8000,100", "--scale", "1000"},
         {"too many: a map holds at most 536800000 of a mesh so small"});
}

TEST_F(ScanCommand, RefusesOutputsBeforeItScans) {
  expect_refused({"station", "-o", map("map.txt")}, {"--output", "map.txt"});
  expect_refused({"station", "-o", path("no/folder/map.bt")}, {"--output", "no/folder"});
  std::filesystem::create_directories(path("folder.bt"));
  expect_refused({"station", "-o", path("folder.bt")}, {"--output", "folder.bt", "folder"});
  ASSERT_EQ(mkfifo(path("pipe.bt").c_str(), 0600), 0);
  expect_refused({"station", "-o", path("pipe.bt")}, {"--output", "pipe.bt", "not a regular file"});
  expect_refused({"station"}, {"--output"});
  std::filesystem::copy_file(std::filesystem::path(FRONTLUX_DATA_DIR) / "maps/room_0.2m.ot", path("room.ot"));
  expect_refused({path("room.ot"), "--start", "6,3,1", "-o", path("room.ot")},
                 {"--output", "is what is read: " + path("room.ot")});
  expect_refused({path("room.ot"), "--start", "6,3,1", "--seed", "2", "-o", path("new.bt")},
                 {"--seed: " + path("room.ot") + " is not a built-in world"});
  const std::string robot = write("robot.bt", content_of(FRONTLUX_DATA_DIR "/robots/uav.json"));
  expect_refused({"room", "--robot", robot, "-o", robot}, {"--output", "is what is read: " + robot});
}

TEST_F(ScanCommand, WritesNothingWhenStopped) {
  const pid_t child =
      test::start({FRONTLUX_COMMAND, "scan", "station", "--sweep", "1", "-o", map("stopped.bt")}, folder_);
  ASSERT_GT(child, 0);
  sleep(3);
  kill(child, SIGINT);
  const int status = test::status_of(child);
  // Before the first scan the signal ends the program by itself, which a shell reports as 130 as well.
  EXPECT_TRUE(test::exit_code(status) == 130 || (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT))
      << status;
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "maps"));
}

struct Kept {
  const char* file;
  std::vector<std::string> words;
};

// The commands of data/README.md.
TEST_F(ScanCommand, MakesTheMapsThatAreKept) {
  const std::vector<Kept> all = {
      {"room_0.05m.bt", {"room", "--resolution", "0.05", "--robot", "uav", "--sweep", "6"}},
      {"room_0.1m.bt", {"room", "--resolution", "0.1", "--sweep", "4"}},
      {"room_0.2m.ot", {"room", "--resolution", "0.2", "--sweep", "4", "--noise", "0.02"}},
      {"storage_0.2m.bt", {"storage", "--resolution", "0.2", "--sweep", "5"}},
      {"storage_0.3m.bt", {"storage", "--resolution", "0.3", "--sweep", "5"}},
      {"maze_0.3m.bt", {"maze", "--resolution", "0.3", "--robot", "ugv", "--sweep", "6"}},
  };
  for (const Kept& kept : all) {
    expect_answer(test::joined(kept.words, {"-o", map(kept.file)}));
    EXPECT_TRUE(content_of(map(kept.file)) ==
                content_of(std::filesystem::path(FRONTLUX_DATA_DIR) / "maps" / kept.file))
        << kept.file << " is not what the command makes now";
  }
}

}  // namespace
}  // namespace frontlux::sim
