#include "report/report_folder.hpp"
#include "support/complaint.hpp"

#include <frontlux/report/robot_colors.hpp>

namespace frontlux::report {
namespace {

using planner::Recording;
using test::decode;
using test::Decoded;
using test::from_base64;
using test::inflated;
using test::packed_runs;
using ReportTest = test::ReportFolder;

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++found;
  return found;
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
    const auto& [step, known, contacts] = room().steps[s];
    EXPECT_EQ(reported["number"], step.number);
    EXPECT_EQ(reported["time"], step.time);
    EXPECT_GT(step.time, s > 0 ? room().steps[s - 1].step.time : 0.0);
    EXPECT_EQ(reported["frontiers"], step.frontiers);
    EXPECT_EQ(reported["unassigned"], step.unassigned);
    EXPECT_EQ(reported["abandoned"], step.abandoned);
    EXPECT_EQ(reported["rays"], step.rays);
    EXPECT_EQ(reported["contacts"], contacts);
    EXPECT_EQ(reported["seconds"].get<std::vector<double>>(),
              std::vector(step.seconds.begin(), step.seconds.end()));
    for (std::size_t r = 0; r < 2; ++r) {
      const auto& robot = reported["robots"][r];
      EXPECT_EQ(reported["known"][r], nlohmann::json({known[r].observable, known[r].bounding}));
      EXPECT_EQ(robot["state"], name_of(step.robots[r].goal.state));
      EXPECT_EQ(robot["reason"], step.robots[r].goal.reason);
      EXPECT_EQ(robot.contains("goal"), step.robots[r].goal.pose.has_value());
      EXPECT_EQ(robot["gain_predicted"], step.robots[r].gain_predicted);
      EXPECT_EQ(robot["gained"], step.robots[r].gained);
      EXPECT_EQ(robot["length"], step.robots[r].length);
    }
  }
}

TEST_F(ReportTest, TakesFromRunJsonWhatTheRecordingLacks) {
  Recording recording = room();
  recording.steps.resize(1);  // of many reports
  recording.end = "low_gain";
  recording.head.robots[1].robot.name = "fly\xff";
  const std::string ugv = recording.head.robots[0].robot.name, fly = "fly\xef\xbf\xbd";
  const nlohmann::json unseen = {{"in_view", 0.25}, {"narrow", 0.125}, {"hidden", 0}};
  const nlohmann::json map = {{"false_free", 0.5}, {"false_occupied", 0.0625}, {"surface_found", 1}};
  const nlohmann::json why = {{"narrow_by_m", 0.15}, {"in_view_then", 0.1}, {"without_min_height", 0.05}};
  const nlohmann::json whole = {
      {"world", recording.head.world},
      {"robots", {ugv, fly}},
      {"end", "low_gain"},
      {"steps", recording.steps.back().step.number},
      {"clearance_min_m", 0.125},
      {"separation_min_m", nullptr},
      {"contacts_in_free", 3},
      {"surface_out_of_bounds", 0.5},
      {"warnings", {"it ended; early", "it was late"}},
      {"unseen", unseen},
      {"unseen_why", {{ugv, {{"narrow_by_m", nullptr}, {"in_view_then", 0}}}, {fly, why}}},
      {"map", map},
      {"by_robot",
       {{ugv, {{"idle_s", 3.5}, {"held_back", 2}, {"goal", "no goal: \xe2\x80\xa6"}}},
        {fly, {{"idle_s", nullptr}, {"held_back", 0}, {"goal", "its first stop"}}}}}};
  const auto measured = [&](const std::string& text) {
    return decode(packed_runs(page_of({{"room", &recording, text}})).at(0)).facts["measured"];
  };
  EXPECT_EQ(measured(whole.dump()), (nlohmann::json{{"clearance_min_m", 0.125},
                                                    {"separation_min_m", nullptr},
                                                    {"contacts_in_free", 3},
                                                    {"surface_out_of_bounds", 0.5},
                                                    {"warnings", {"it ended; early", "it was late"}},
                                                    {"unseen", unseen},
                                                    {"map", map},
                                                    {"robots",
                                                     {{{"idle_s", 3.5},
                                                       {"held_back", 2},
                                                       {"narrow_by_m", nullptr},
                                                       {"in_view_then", 0},
                                                       {"without_min_height", nullptr},
                                                       {"goal", "no goal: \xe2\x80\xa6"}},
                                                      {{"idle_s", nullptr},
                                                       {"held_back", 0},
                                                       {"narrow_by_m", 0.15},
                                                       {"in_view_then", 0.1},
                                                       {"without_min_height", 0.05},
                                                       {"goal", "its first stop"}}}}}));
  nlohmann::json odd = whole;
  odd["by_robot"] = nlohmann::json::array({1});
  EXPECT_EQ(measured(odd.dump())["robots"][0]["idle_s"], nullptr);
  EXPECT_EQ(measured(odd.dump())["robots"][0]["goal"], "");
  // What an older frontlux did not write, and values that are none, are unknown.
  const std::array kNewer = {
      "contacts_in_free", "surface_out_of_bounds", "warnings", "unseen", "unseen_why", "map"};
  nlohmann::json older = whole;
  for (const char* name : kNewer) older.erase(name);
  for (auto& robot : older["by_robot"]) robot.erase("goal");
  std::vector<nlohmann::json> runs = {older};
  for (const nlohmann::json& value :
       {nlohmann::json(nullptr), nlohmann::json("text"), nlohmann::json({1, nullptr}),
        nlohmann::json({{"narrow", "much"}, {"false_free", nlohmann::json::object()}, {ugv, 1}})}) {
    runs.push_back(whole);
    for (const char* name : kNewer) runs.back()[name] = value;
    for (auto& robot : runs.back()["by_robot"]) robot["goal"] = value.is_string() ? nlohmann::json(1) : value;
  }
  for (const nlohmann::json& run : runs) {
    const nlohmann::json found = measured(run.dump());
    EXPECT_EQ(found["clearance_min_m"], 0.125) << run;
    EXPECT_TRUE(found["contacts_in_free"].is_null()) << run;
    EXPECT_EQ(found["warnings"], nlohmann::json::array()) << run;
    for (const char* name : {"unseen", "map"}) {
      EXPECT_EQ(found[name].size(), 3U) << run;
      for (const auto& part : found[name]) EXPECT_TRUE(part.is_null()) << name << run;
    }
    for (const auto& robot : found["robots"]) {
      EXPECT_EQ(robot["goal"], "") << run;
      for (const char* name : {"narrow_by_m", "in_view_then", "without_min_height"})
        EXPECT_TRUE(robot[name].is_null()) << name << run;
    }
    EXPECT_EQ(found["robots"][0]["held_back"], 2) << run;
  }
  odd = whole;
  odd["warnings"] = std::vector<std::string>(1000, "again");
  EXPECT_EQ(measured(odd.dump())["warnings"].size(), 100U);
  // Of another run, of another end of this one, damaged, and no run.json at all.
  nlohmann::json other = whole, longer = whole, words = whole;
  other["end"] = "stopped";
  longer["steps"] = recording.steps.back().step.number + 1;
  words["by_robot"][fly]["idle_s"] = "long";
  // As deep as a stranger likes.
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']'), all = whole.dump();
  const std::string name = "\"" + ugv + "\":";
  const std::size_t at = all.find(name) + name.size();
  const nlohmann::json robots =
      measured(all.substr(0, at) + deep + all.substr(all.find('}', at) + 1))["robots"];
  EXPECT_EQ(robots[0]["held_back"], nullptr);
  EXPECT_EQ(robots[1]["held_back"], 0);
  EXPECT_FALSE(measured("{\"coverage_observable\":" + deep + "," + all.substr(1)).is_null());
  for (const auto& [member, value] : whole.items()) {
    const std::string begin = "\"" + member + "\":", text = value.dump();
    const std::size_t place = all.find(begin + text);
    ASSERT_NE(place, std::string::npos) << member;
    measured(all.substr(0, place) + begin + deep + all.substr(place + begin.size() + text.size()));
  }
  for (const std::string& text :
       {other.dump(), longer.dump(), words.dump(), whole.dump().substr(1), std::string(), std::string("[]"),
        std::string("{}"), std::string(100'000, '[')})
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
