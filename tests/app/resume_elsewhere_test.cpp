// A run is continued from any folder, with files of any name.

#include "app/explore_command.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/mesh_file.hpp>

namespace frontlux::sim {
namespace {

namespace fs = std::filesystem;
using test::content_of;

class ResumeElsewhere : public test::ExploreCommand {
 protected:
  ResumeElsewhere() {
    fs::create_directories(path("here/worlds"));
    fs::create_directory(path("there"));
    const World room = make_world("room", 1);
    write_ply(path("here/worlds/room.ply"), room.mesh);
    std::ostringstream at;
    at << room.start->x() << ',' << room.start->y() << ',' << room.start->z();
    start_ = at.str();
  }
  [[nodiscard]] std::string in(const std::string& folder) const {
    return "cd " + test::quoted(path(folder)) + ";";
  }
  [[nodiscard]] std::vector<std::string> words(const std::string& world) const {
    return {world,         "--start", start_,     "--ground", "off", "--lockstep",
            "--max-steps", "1",       "--report", "off",      "-o",  path("run")};
  }
  const std::vector<std::string> resume_ = {"--resume", path("run"), "--max-steps", "2", "--report", "off"};
  std::string start_;
};

bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t more = first < 0x80                    ? 0
                             : first >= 0xC2 && first < 0xE0 ? 1
                             : first >= 0xE0 && first < 0xF0 ? 2
                             : first >= 0xF0 && first < 0xF5 ? 3
                                                             : 4;
    if (more == 4 || i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0U) != 0x80U) return false;
    i += more + 1;
  }
  return true;
}

TEST_F(ResumeElsewhere, FindsTheWorldWhereItWas) {
  expect_answer(words("worlds/room.ply"), {}, in("here"));
  expect_answer(resume_, {"steps        2\n"}, in("there"));
  // All of it was moved.
  fs::rename(path("here"), path("moved"));
  expect_answer(resume_, {}, in("moved"));
  expect_refused(resume_,
                 {"--resume: there is no file " + path("here/worlds/room.ply"), "worlds/room.ply", "--world"},
                 in("there"));
  expect_answer(test::joined(resume_, {"--world", path("moved/worlds/room.ply")}), {}, in("there"));
  expect_refused(test::joined(resume_, {"--world", path("none.ply")}), {path("none.ply"), "no such file"});
  expect_refused({"room", "--world", "x.ply", "-o", path("new")}, {"--world", "--resume"});
  // Its file got another name; the report still has all that only run.json tells.
  fs::rename(path("moved/worlds/room.ply"), path("moved/worlds/other.ply"));
  expect_answer({"--resume", path("run"), "--max-steps", "3", "--report", "off", "--world",
                 path("moved/worlds/other.ply")});
  const test::Answer report = test::run_frontlux({"report", path("run")}, folder_);
  EXPECT_EQ(report.code, 0) << report.err;
  EXPECT_EQ(report.err, "");
}

TEST_F(ResumeElsewhere, LeavesBuiltInWorldsAlone) {
  expect_answer({"room", "--lockstep", "--max-steps", "1", "--report", "off", "-o", path("run")});
  fs::create_directory(path("there/room"));
  expect_answer(resume_, {}, in("there"));
  expect_refused(test::joined(resume_, {"--world", path("here/worlds/room.ply")}),
                 {"--world: the run is in the built-in world room"});
}

TEST_F(ResumeElsewhere, KeepsNamesByteForByte) {
  const std::string name = "r\xFF\xC3 %41#?o.ply";
  fs::rename(path("here/worlds/room.ply"), path("here/worlds/" + name));
  expect_answer(words("worlds/" + name), {}, in("here"));
  expect_answer(resume_, {"steps        2\n"}, in("there"));
  fs::rename(path("run"), path("run\xFE"));
  const test::Answer made = test::run_frontlux({"report", path("run\xFE"), "--png"}, folder_);
  EXPECT_EQ(made.code, 0) << made.err;
  const std::string html = content_of(path("run\xFE/report.html"));
  EXPECT_GT(html.size(), 1000U);
  EXPECT_TRUE(is_utf8(html));
  EXPECT_TRUE(is_utf8(content_of(path("run\xFE/run.json"))));
}

}  // namespace
}  // namespace frontlux::sim
