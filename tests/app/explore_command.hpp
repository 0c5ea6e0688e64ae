#pragma once

#include "planner/exploration/team_in_world.hpp"
#include "support/command_test.hpp"

#include <frontlux/planner/recording.hpp>

#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

namespace frontlux::test {

namespace fs = std::filesystem;

inline constexpr const char* kSteps = "4";

inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) c == ',' ? cells.emplace_back() : cells.back() += c;
  return cells;
}

inline std::vector<std::vector<std::string>> table_of(const fs::path& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(content_of(csv));
  for (std::string line; std::getline(lines, line);) rows.push_back(cells_of(line));
  return rows;
}

/// steps.csv without the times that the program took.
inline std::vector<std::vector<std::string>> timeless(const fs::path& csv) {
  auto rows = table_of(csv);
  if (rows.empty()) return rows;
  const std::vector<std::string> header = rows.front();
  for (auto& row : rows)
    for (std::size_t i = header.size(); i-- > 0;)
      if (header[i].ends_with("_s") && header[i] != "time_s" && i < row.size())
        row.erase(row.begin() + static_cast<std::ptrdiff_t>(i));
  return rows;
}

class ExploreCommand : public CommandTest {
 protected:
  ExploreCommand() : CommandTest("explore") {}

  /// As CommandTest's, on a machine of any speed: one that plans more slowly than the clock charges is
  /// warned.
  std::string expect_answer(const std::vector<std::string>& words, const std::vector<std::string>& parts = {},
                            const std::string& before = "") const {
    const Answer answer = run(words, before);
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::istringstream lines(answer.err);
    for (std::string line; std::getline(lines, line);)
      EXPECT_TRUE(line.starts_with("warning: 99 % of the plannings took up to ")) << line;
    expect_parts(answer.out, parts);
    return answer.out;
  }

  /// The room in four steps of Alg. 1.
  [[nodiscard]] Answer explore(const std::string& output) const {
    return run({"room", "--lockstep", "--max-steps", kSteps, "-o", path(output)});
  }
  void expect_explored(const std::string& output, const std::vector<std::string>& more = {}) const {
    expect_answer(
        joined({"room", "--lockstep", "--max-steps", kSteps, "-o", path(output), "--report", "off"}, more));
  }
  void expect_resumed(const std::string& output, const std::vector<std::string>& more = {}) const {
    expect_answer(joined({"--report", "off", "--resume", path(output)}, more));
  }

  /// The words for a quick run: two UAVs of few pixels.
  [[nodiscard]] std::vector<std::string> quick(const std::string& seconds) const {
    std::string robots;
    for (const char* name : {"one", "two"})
      robots += (robots.empty() ? "" : ", ") + (R"({"name": ")" + std::string(name) + R"(", "motion": "space",
        "body": {"kind": "box", "size_m": [0.7, 0.7, 0.5]},
        "limits": {"speed_m_s": 2, "acceleration_m_s2": 3, "yaw_rate_deg_s": 90},
        "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72, "range_m": 6, "columns": 48,
                   "rows": 36, "rate_hz": 8}})");
    return {"--task", write("quick.json", R"({"world": "room", "robots": [)" + robots + "]}"), "--stop-time",
            seconds};
  }
  [[nodiscard]] std::vector<std::string> quick(const std::string& output, const std::string& seconds) const {
    return joined(quick(seconds), {"--report", "off", "-o", path(output)});
  }

  [[nodiscard]] nlohmann::json json_in(const std::string& output) const {
    return nlohmann::json::parse(content_of(path(output + "/run.json")));
  }

  /// All but the times is that of another run.
  void expect_same_runs(const std::string& a, const std::string& b) const {
    SCOPED_TRACE(a + " and " + b);
    EXPECT_GT(content_of(path(a + "/map.ot")).size(), 1000U);
    for (const char* file : {"/map.ot", "/map.bt", "/paths.csv"})
      EXPECT_TRUE(content_of(path(a + file)) == content_of(path(b + file))) << file;
    EXPECT_EQ(timeless(path(a + "/steps.csv")), timeless(path(b + "/steps.csv")));
    const planner::Recording x = planner::read_recording(path(a + "/run.frontlux")),
                             y = planner::read_recording(path(b + "/run.frontlux"));
    EXPECT_EQ(x.end, y.end);
    EXPECT_FALSE(x.truncated || y.truncated);
    ASSERT_EQ(x.steps.size(), y.steps.size());
    for (std::size_t i = 0; i < x.steps.size(); ++i) {
      expect_same(x.steps[i].step, y.steps[i].step);
      EXPECT_EQ(x.steps[i].known, y.steps[i].known);
      EXPECT_EQ(x.steps[i].contacts, y.steps[i].contacts);
    }
    const nlohmann::json p = json_in(a), q = json_in(b);
    for (const char* name :
         {"end", "steps", "coverage_observable", "coverage_box", "path_length_m", "contacts", "held_back"})
      EXPECT_EQ(p.at(name), q.at(name)) << name;
  }

  /// Starts the command and waits until it has printed so many steps.
  [[nodiscard]] pid_t start_and_wait(const std::vector<std::string>& words, int steps,
                                     User user = kSelf) const {
    fs::remove(path("out"));
    const pid_t child = start(joined({FRONTLUX_COMMAND, "explore"}, words), folder_, user);
    const std::string last = "step " + std::to_string(steps) + ":";
    for (int i = 0; i < 6000 && content_of(path("out")).find(last) == std::string::npos; ++i) {
      siginfo_t ended{};
      if (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
          ended.si_pid == child)
        break;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return child;
  }
};

}  // namespace frontlux::test
