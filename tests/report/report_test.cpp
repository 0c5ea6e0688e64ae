#include "report/explored_run.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"

#include <frontlux/planner/recorded_map.hpp>
#include <frontlux/report/report.hpp>
#include <frontlux/report/robot_colors.hpp>

#include <nlohmann/json.hpp>

#include <string_view>
#include <zlib.h>

namespace frontlux::report {
namespace {

using planner::Recording;

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Bit by bit, from a table that is looked through: slow, and unlike what it judges.
std::string from_base64(std::string_view text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value{};
  for (std::size_t i = 0; i < digits.size(); ++i)
    value.at(static_cast<unsigned char>(digits[i])) = static_cast<int>(i);
  std::string bytes;
  unsigned bits = 0, held = 0;
  for (const char c : text) {
    if (c == '=') break;
    EXPECT_NE(digits.find(c), std::string::npos);
    held = held << 6U | static_cast<unsigned>(value.at(static_cast<unsigned char>(c)));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(held >> bits & 0xFFU);
  }
  return bytes;
}

std::string inflated(std::string_view bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit(&stream), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  std::array<char, 1 << 16> buffer;
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = buffer.size();
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(buffer.data(), buffer.size() - stream.avail_out);
  }
  EXPECT_EQ(state, Z_STREAM_END);
  inflateEnd(&stream);
  return out;
}

// The texts of the runs in a page.
std::vector<std::string> packed_runs(const std::string& page) {
  const std::string begin = "<script type=\"text/plain\" class=\"run\">", end = "</script>";
  std::vector<std::string> runs;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    runs.push_back(page.substr(at, page.find(end, at) - at));
  }
  return runs;
}

// Reads what the page reads.
struct Reader {
  std::string bytes;
  std::size_t at = 0;

  std::uint8_t u8() { return static_cast<std::uint8_t>(bytes.at(at++)); }
  std::uint64_t count() {
    std::uint64_t number = 0;
    for (unsigned shift = 0;; shift += 7) {
      const std::uint64_t byte = u8();
      number |= (byte & 0x7FU) << shift;
      if (byte < 0x80) return number;
    }
  }
  std::int64_t difference() {
    const std::uint64_t number = count();
    return static_cast<std::int64_t>(number / 2) * (number % 2 != 0 ? -1 : 1) -
           static_cast<std::int64_t>(number % 2);
  }
  std::vector<VoxelKey> keys(std::size_t size) {
    std::vector<VoxelKey> list(size);
    for (const auto axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
      std::int64_t key = 0;
      for (VoxelKey& voxel : list) voxel.*axis = static_cast<std::uint16_t>(key += difference());
    }
    return list;
  }
  float f32() {
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= std::uint32_t{u8()} << 8 * i;
    return std::bit_cast<float>(bits);
  }
};

struct Decoded {
  nlohmann::json facts;
  Reader data;
};

Decoded decode(const std::string& packed) {
  const std::string bytes = inflated(from_base64(packed));
  std::uint32_t length = 0;
  for (unsigned i = 0; i < 4; ++i) length |= std::uint32_t{static_cast<unsigned char>(bytes.at(i))} << 8 * i;
  return {nlohmann::json::parse(bytes.substr(4, length)), {bytes.substr(4 + length)}};
}

class ReportTest : public test::FolderTest {
 protected:
  std::string page_of(const std::vector<ReportedRun>& runs) {
    write_report(folder_ / "report.html", runs, "1.2.3");
    return test::content_of(folder_ / "report.html");
  }
  static const Recording& room() {
    static const Recording recording = test::explored_run("room", 5);
    return recording;
  }
};

using Cells = std::vector<planner::RenderedCell>;
using Changes = std::map<VoxelKey, Occupancy>;

Changes read_changes(Reader& data) {
  Changes changes;
  for (std::uint64_t chunks = data.count(); chunks > 0; --chunks) {
    const std::uint64_t x = data.count(), y = data.count(), z = data.count();
    std::uint64_t local = 0;
    for (std::uint64_t voxels = data.count(); voxels > 0; --voxels) {
      const std::uint64_t change = data.count();
      local += change / 4;
      EXPECT_LT(local, 32U * 32U * 32U);
      const VoxelKey key{static_cast<std::uint16_t>(32 * x + local % 32),
                         static_cast<std::uint16_t>(32 * y + local / 32 % 32),
                         static_cast<std::uint16_t>(32 * z + local / 1024)};
      EXPECT_TRUE(changes.emplace(key, static_cast<Occupancy>(change % 4)).second);
    }
  }
  return changes;
}

void expect_image(Reader& data, std::vector<planner::RenderedCell> cells) {
  ASSERT_EQ(data.count(), cells.size());
  if (cells.empty()) return;
  std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::tie(a.cell.z, a.cell.y, a.cell.x) < std::tie(b.cell.z, b.cell.y, b.cell.x);
  });
  const double gain = data.f32(), quality = data.f32();
  const auto by = [](auto member) {
    return [member](const auto& a, const auto& b) { return a.*member < b.*member; };
  };
  using Cell = planner::RenderedCell;
  EXPECT_EQ(gain, static_cast<float>(std::max_element(cells.begin(), cells.end(), by(&Cell::gain))->gain));
  EXPECT_EQ(quality,
            static_cast<float>(std::max_element(cells.begin(), cells.end(), by(&Cell::quality))->quality));
  for (const auto axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    std::int64_t key = 0;
    for (const Cell& cell : cells) {
      key += data.difference();
      ASSERT_EQ(key, cell.cell.*axis);
    }
  }
  // A byte's step, and half of it for rounding; the quality's is on a scale of square roots.
  for (const Cell& cell : cells) EXPECT_NEAR(data.u8() / 255.0 * gain, cell.gain, 0.51 / 255.0 * gain);
  for (const Cell& cell : cells)
    EXPECT_NEAR(data.u8() / 255.0, quality > 0 ? std::sqrt(cell.quality / quality) : 0.0, 0.51 / 255.0);
}

TEST_F(ReportTest, VoxelsImagesAndPathsAreThoseOfTheRecording) {
  Decoded run = decode(packed_runs(page_of({{"room", &room()}})).at(0));
  planner::RecordedMap map(room().head.resolution);
  Changes shown;
  std::size_t images = 0, reassigned = 0;
  for (const planner::RecordedStep& recorded : room().steps) {
    map.apply(recorded);
    for (const planner::RobotStep& robot : recorded.step.robots) {
      for (const auto& [key, state] : read_changes(run.data)) shown[key] = state;
      expect_image(run.data, robot.image);
      images += robot.image.empty() ? 0 : 1;
      ASSERT_EQ(run.data.count(), robot.planned.size());
      ASSERT_EQ(run.data.count(), robot.travelled);
      for (const planner::Pose& pose : robot.planned) {
        for (const double coordinate : pose.position)
          EXPECT_EQ(run.data.f32(), static_cast<float>(coordinate));
        EXPECT_EQ(run.data.f32(), static_cast<float>(pose.yaw));
      }
      EXPECT_EQ(run.data.count(), 0U) << "in lock-step there are no tours";
      EXPECT_EQ(run.data.count(), 0U) << "and no trajectories";
      ASSERT_EQ(run.data.count(), robot.reassigned.size());
      EXPECT_EQ(run.data.keys(robot.reassigned.size()), robot.reassigned);
      reassigned += robot.reassigned.size();
    }
    std::array<std::uint64_t, 3> counted{};
    for (const auto& [key, state] : shown) {
      ASSERT_EQ(map.grid().at(key), state);
      ++counted.at(static_cast<std::size_t>(state));
    }
    EXPECT_EQ(counted[1], map.grid().count()[1]);
    EXPECT_EQ(counted[2], map.grid().count()[2]);
  }
  EXPECT_EQ(run.data.at, run.data.bytes.size());
  EXPECT_GT(images, 2U);
  EXPECT_GT(reassigned, 100U);
  EXPECT_GT(shown.size(), 10'000U);
}

TEST_F(ReportTest, ToursAreThoseOfTheRecording) {
  Recording recording = room();
  recording.steps.resize(1);
  for (planner::RobotStep& robot : recording.steps[0].step.robots) {
    robot.changed.clear();
    robot.image.clear();
    robot.planned.clear();
    robot.travelled = 0;
    robot.reassigned = {{5, 6, 7}, {5, 65535, 0}, {6, 1, 2}};
  }
  recording.steps[0].step.robots[0].trajectory = {{{1.0, 2.0, 0.5}, 0.1}, {{-3.0, 2.5, 0.5}, 0.2}};
  recording.steps[0].step.robots[1].tour = {{{{1.5, -2.0, 3.25}, 0.5}, 3, 400},
                                            {{{0.1, 0.2, 0.3}, -4.0}, 1, 10}};
  Reader data = decode(packed_runs(page_of({{"room", &recording}})).at(0)).data;
  for (const planner::RobotStep& robot : recording.steps[0].step.robots) {
    for (int nothing = 0; nothing < 4; ++nothing) ASSERT_EQ(data.count(), 0U);
    ASSERT_EQ(data.count(), robot.tour.size());
    for (const planner::PlannedStop& stop : robot.tour) {
      for (const double coordinate : stop.pose.position)
        EXPECT_EQ(data.f32(), static_cast<float>(coordinate));
      EXPECT_EQ(data.f32(), static_cast<float>(stop.pose.yaw));
      EXPECT_EQ(data.count(), stop.clusters);
      EXPECT_EQ(data.count(), stop.frontiers);
    }
    ASSERT_EQ(data.count(), robot.trajectory.size());
    for (const planner::Pose& pose : robot.trajectory)
      for (const double coordinate : pose.position) EXPECT_EQ(data.f32(), static_cast<float>(coordinate));
    ASSERT_EQ(data.count(), robot.reassigned.size());
    EXPECT_EQ(data.keys(robot.reassigned.size()), robot.reassigned);
  }
  EXPECT_EQ(data.at, data.bytes.size());
}

TEST_F(ReportTest, OfManyImagesSomeAreShown) {
  Recording recording = room();
  const auto with_image =
      std::find_if(room().steps.begin(), room().steps.end(),
                   [](const planner::RecordedStep& step) { return !step.step.robots[0].image.empty(); });
  ASSERT_NE(with_image, room().steps.end());
  recording.steps.assign(1001, *with_image);
  recording.steps[0].step.robots[0].image.clear();
  recording.steps[7].step.robots[1].image = with_image->step.robots[0].image;
  Decoded run = decode(packed_runs(page_of({{"room", &recording}})).at(0));
  std::array<std::vector<std::size_t>, 2> shown;
  for (std::size_t s = 0; s < recording.steps.size(); ++s)
    for (std::size_t r = 0; r < 2; ++r) {
      read_changes(run.data);
      const bool here = run.data.bytes.at(run.data.at) != 0;
      if (here) shown.at(r).push_back(s);
      expect_image(run.data, here ? recording.steps[s].step.robots[r].image : Cells{});
      const std::uint64_t poses = run.data.count();
      run.data.count();  // of them, those that it reached
      run.data.at += 16 * poses;
      EXPECT_EQ(run.data.count(), 0U);  // no tour
      EXPECT_EQ(run.data.count(), 0U);  // no trajectory
      run.data.keys(run.data.count());
    }
  EXPECT_EQ(run.data.at, run.data.bytes.size());
  // Of a thousand, every third one.
  ASSERT_EQ(shown[0].size(), 334U);
  for (std::size_t i = 0; i < shown[0].size(); ++i) EXPECT_EQ(shown[0][i], 1 + 3 * i);
  EXPECT_EQ(shown[1], std::vector<std::size_t>{7});
}

// A robot has one colour, alone and in any team, and no two of a team have the same as long as there are
// enough.
TEST(RobotColors, GoByIdentity) {
  const auto named = [](planner::RobotDescription description, const std::string& name) {
    description.robot.name = name;
    return description;
  };
  const planner::RobotDescription ground = planner::ugv_description(), air = planner::uav_description();
  const auto colors_of = [](const std::vector<planner::RobotDescription>& team) {
    std::vector<std::string> colors;
    for (const RobotColor& color : robot_colors(team)) {
      EXPECT_NE(color.light, color.dark);
      colors.emplace_back(color.light);
    }
    return colors;
  };
  const std::string uav = colors_of({air})[0], ugv = colors_of({ground})[0];
  EXPECT_NE(uav, ugv);
  EXPECT_EQ(colors_of({ground, air}), (std::vector{ugv, uav}));
  const auto three = colors_of({named(air, "uav1"), ground, named(air, "uav2")});
  EXPECT_EQ(three[0], uav);
  EXPECT_EQ(three[1], ugv);
  EXPECT_EQ(colors_of({named(air, "uav2")})[0], three[2]);
  EXPECT_EQ(colors_of({named(air, "uav2"), named(air, "uav1")}), (std::vector{three[2], uav}));
  const auto named_alike = colors_of({named(air, "heron"), named(air, "kite"), named(air, "uav2")});
  EXPECT_EQ(std::set(named_alike.begin(), named_alike.end()).size(), 3U);
  EXPECT_EQ(named_alike[0], uav);
  EXPECT_EQ(colors_of(std::vector(40, air)).size(), 40U);
  EXPECT_EQ(colors_of({named(air, "uav99999999999999999999"), named(air, ""), named(air, "0")}).size(), 3U);
}

TEST_F(ReportTest, NumbersAreThoseOfTheRecording) {
  const nlohmann::json facts = decode(packed_runs(page_of({{"a \"room\"", &room()}})).at(0)).facts;
  EXPECT_EQ(facts["name"], "a \"room\"");
  EXPECT_EQ(facts["written_by"], "1.2.3");
  EXPECT_EQ(facts["world"], "room");
  EXPECT_EQ(facts["end"], room().end.value());
  EXPECT_EQ(facts["resolution"], 0.3);
  EXPECT_EQ(facts["observable"], room().head.observable);
  EXPECT_EQ(facts["bounding"], room().head.bounding);
  EXPECT_EQ(nlohmann::json::parse(facts["options"].get<std::string>())["path"]["spacing_m"], 1.2);
  ASSERT_EQ(facts["robots"].size(), 2U);
  EXPECT_EQ(facts["robots"][0]["plane"], true);
  EXPECT_EQ(facts["robots"][0]["shape"], "spinning");
  EXPECT_EQ(facts["robots"][1]["shape"], "pyramid");
  EXPECT_EQ(facts["robots"][1]["colors"][0], robot_colors(room().head.robots)[1].light);
  EXPECT_EQ(facts["robots"][1]["columns"], 160);
  EXPECT_EQ(facts["phases"],
            nlohmann::json({"frontiers", "caster", "goals", "paths", "optimization", "moving"}));
  ASSERT_EQ(facts["steps"].size(), room().steps.size());
  for (std::size_t s = 0; s < room().steps.size(); ++s) {
    const auto& reported = facts["steps"][s];
    const auto& [step, known, collisions] = room().steps[s];
    EXPECT_EQ(reported["number"], step.number);
    EXPECT_EQ(reported["time"], step.time);
    EXPECT_GT(step.time, s > 0 ? room().steps[s - 1].step.time : 0.0);
    EXPECT_EQ(reported["frontiers"], step.frontiers);
    EXPECT_EQ(reported["unassigned"], step.unassigned);
    EXPECT_EQ(reported["abandoned"], step.abandoned);
    EXPECT_EQ(reported["rays"], step.rays);
    EXPECT_EQ(reported["collisions"], collisions);
    EXPECT_EQ(reported["seconds"].get<std::vector<double>>(),
              std::vector(step.seconds.begin(), step.seconds.end()));
    for (std::size_t r = 0; r < 2; ++r) {
      const auto& robot = reported["robots"][r];
      EXPECT_EQ(reported["known"][r], nlohmann::json({known[r].observable, known[r].bounding}));
      EXPECT_EQ(robot["state"], name_of(step.robots[r].goal.state));
      EXPECT_EQ(robot["reason"], step.robots[r].goal.reason);
      EXPECT_EQ(robot.contains("goal"), step.robots[r].goal.pose.has_value());
      EXPECT_EQ(robot["gain_tangent"], step.robots[r].gain_tangent);
      EXPECT_EQ(robot["gain_predicted"], step.robots[r].gain_predicted);
      EXPECT_EQ(robot["gained"], step.robots[r].gained);
      EXPECT_EQ(robot["length"], step.robots[r].length);
      EXPECT_EQ(robot["assigned"], step.robots[r].goal.assigned);
    }
  }
}

TEST_F(ReportTest, TakesFromRunJsonWhatTheRecordingLacks) {
  Recording recording = room();
  recording.end = "low_gain";
  recording.head.robots[1].robot.name = "fly\xff";
  const nlohmann::json whole = {{"end", "low_gain"},
                                {"steps", recording.steps.back().step.number},
                                {"clearance_min_m", 0.125},
                                {"separation_min_m", nullptr},
                                {"by_robot",
                                 {{recording.head.robots[0].robot.name, {{"idle_s", 3.5}, {"held_back", 2}}},
                                  {"fly\xef\xbf\xbd", {{"idle_s", "long"}, {"held_back", 0}}}}}};
  const auto measured = [&](const std::string& text) {
    return decode(packed_runs(page_of({{"room", &recording, text}})).at(0)).facts["measured"];
  };
  EXPECT_EQ(measured(whole.dump()), (nlohmann::json{{"clearance_min_m", 0.125},
                                                    {"separation_min_m", nullptr},
                                                    {"idle", {3.5, nullptr}},
                                                    {"held_back", {2, 0}}}));
  // Of another run, of another end of this one, and no run.json at all.
  nlohmann::json other = whole, longer = whole, odd = whole;
  other["end"] = "stopped";
  longer["steps"] = recording.steps.back().step.number + 1;
  odd["by_robot"] = nlohmann::json::array({1});
  EXPECT_EQ(measured(odd.dump())["idle"], nlohmann::json({nullptr, nullptr}));
  // As deep as a stranger likes.
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']'), all = whole.dump();
  const std::string name = "\"" + recording.head.robots[0].robot.name + "\":";
  const std::size_t at = all.find(name) + name.size();
  EXPECT_EQ(measured(all.substr(0, at) + deep + all.substr(all.find('}', at) + 1))["held_back"],
            nlohmann::json({nullptr, 0}));
  for (const std::string& text : {other.dump(), longer.dump(), whole.dump().substr(1), std::string(),
                                  std::string("[]"), std::string("{}"), std::string(100'000, '[')})
    EXPECT_TRUE(measured(text).is_null()) << text.substr(0, 40);
  recording.end.reset();
  EXPECT_TRUE(measured(whole.dump()).is_null()) << "it goes on";
}

TEST_F(ReportTest, NoNameBecomesMarkup) {
  const std::string evil = "</script></title><img src=x onerror=alert(1)>&\"'\x01\xff<!--";
  Recording recording = room();
  recording.head.world = recording.head.options = evil;
  recording.end = evil;
  recording.head.robots[0].robot.name = evil;
  recording.steps[1].step.robots[0].goal.reason = evil;
  const std::string plain = page_of({{"plain", &room()}}), page = page_of({{evil, &recording}});
  EXPECT_EQ(count(page, "<img"), 0U);
  for (const std::string_view mark : {"<script", "</script", "</title", "<!--"})
    EXPECT_EQ(count(page, mark), count(plain, mark)) << mark;
  EXPECT_NE(page.find("<title>&lt;/script&gt;&lt;/title&gt;&lt;img src=x"), std::string::npos);
  // The text is all there, inside, except for the byte that is not UTF-8.
  const std::string bytes = inflated(from_base64(packed_runs(page).at(0)));
  EXPECT_EQ(count(bytes, "</script></title><img src=x onerror=alert(1)>&\\\"'\\u0001\xef\xbf\xbd<!--"), 6U);
}

TEST_F(ReportTest, NumbersThatAreNoneDoNoHarm) {
  Recording recording = room();
  const double nan = std::nan("");
  recording.steps[2].step.seconds[2] = nan;
  recording.steps[2].step.robots[0].length = HUGE_VAL;
  for (auto& cell : recording.steps[2].step.robots[0].image) cell.gain = cell.quality = nan;
  const Decoded run = decode(packed_runs(page_of({{"room", &recording}})).at(0));
  EXPECT_TRUE(run.facts["steps"][2]["seconds"][2].is_null());
  EXPECT_TRUE(run.facts["steps"][2]["robots"][0]["length"].is_null());
}

TEST_F(ReportTest, TheSameRunsGiveTheSameBytes) {
  const std::string once = page_of({{"a", &room()}, {"b", &room()}});
  EXPECT_EQ(once, page_of({{"a", &room()}, {"b", &room()}}));
  EXPECT_EQ(packed_runs(once).size(), 2U);
  EXPECT_NE(once.find("<title>a, b - frontlux</title>"), std::string::npos);
}

TEST_F(ReportTest, AsksNoHostForAnything) {
  const std::string page = page_of({{"room", &room()}});
  EXPECT_NE(page.find("default-src 'none'; script-src 'sha256-"), std::string::npos);
  for (const std::string_view link : {"<link", "src=\"http", "href=\"http", "@import", "url(http"})
    EXPECT_EQ(count(page, link), 0U) << link;
  EXPECT_EQ(count(page, "@@"), 0U) << "a mark was not filled in";
}

TEST_F(ReportTest, WrongCallsAndFilesAreRefused) {
  Recording robotless = room(), stepless = room();
  robotless.head.robots.clear();
  stepless.steps.clear();
  Recording lacking = room();
  lacking.steps[1].known.pop_back();
  EXPECT_REFUSED(page_of({}));
  EXPECT_REFUSED(page_of({{"none", nullptr}}));
  for (const Recording* bad : {&robotless, &lacking, &stepless}) EXPECT_REFUSED(page_of({{"bad", bad}}));
  const std::vector<ReportedRun> runs = {{"room", &room()}};
  test::expect_complaint<std::runtime_error>(
      [&] { write_report(folder_ / "nowhere" / "report.html", runs, "1"); }, {"nowhere"});
}

}  // namespace
}  // namespace frontlux::report
