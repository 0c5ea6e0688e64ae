#pragma once

#include "app/explore_command.hpp"

#include <frontlux/planner/recording.hpp>

namespace frontlux::test {

/// A CSV file by its columns' names.
class Table {
 public:
  explicit Table(const fs::path& csv) : rows_(table_of(csv)) {}

  [[nodiscard]] std::size_t size() const { return rows_.size() - 1; }
  [[nodiscard]] const std::string& text(std::size_t row, const std::string& column) const {
    const auto& header = rows_.at(0);
    return rows_.at(row + 1).at(static_cast<std::size_t>(std::ranges::find(header, column) - header.begin()));
  }
  [[nodiscard]] double number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
  }
  [[nodiscard]] Eigen::Vector3d point(std::size_t row, const std::string& before,
                                      const std::string& behind) const {
    return {number(row, before + "x" + behind), number(row, before + "y" + behind),
            number(row, before + "z" + behind)};
  }
  /// All but one column.
  [[nodiscard]] std::vector<std::vector<std::string>> without(const std::string& column) const {
    auto rows = rows_;
    const auto place = std::ranges::find(rows_.at(0), column) - rows_.at(0).begin();
    for (auto& row : rows) row.erase(row.begin() + place);
    return rows;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Runs in motion.
class ExploreMotion : public ExploreCommand {
 protected:
  /// All but the times that it took is that of another run, to the last bit.
  void expect_same_motions(const std::string& a, const std::string& b) const {
    expect_same_runs(a, b);
    EXPECT_GT(content_of(path(a + "/motion.csv")).size(), 1000U);
    EXPECT_TRUE(content_of(path(a + "/motion.csv")) == content_of(path(b + "/motion.csv")));
    EXPECT_GT(content_of(path(a + "/tours.csv")).size(), 100U);
    EXPECT_TRUE(content_of(path(a + "/tours.csv")) == content_of(path(b + "/tours.csv")));
    EXPECT_EQ(Table(path(a + "/events.csv")).without("planning_s"),
              Table(path(b + "/events.csv")).without("planning_s"));
    const nlohmann::json x = json_in(a), y = json_in(b);
    for (const char* name : {"time_s", "auc", "explored_m3", "clearance_min_m", "separation_min_m",
                             "contacts", "contacts_in_free", "by_robot", "lockstep", "latency_s"})
      EXPECT_EQ(x.at(name), y.at(name)) << name;
    for (const std::string& run : {a, b}) expect_planning_times(run);
  }

  /// Of a run without bumpers in the folder "run", in which no body has touched a surface.
  [[nodiscard]] Table motions_without_contact(std::vector<std::string> words) const {
    words.insert(words.end(), {"--bumper", "off", "--report", "off", "--force", "-o", path("run")});
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_NE(answer.out.find("contacts     0"), std::string::npos) << answer.out;
    return Table(path("run/motion.csv"));
  }

  /// Adds a box to an OBJ file, or a ramp whose top has another height at its low x.
  static void add_prism(std::ostream& obj, int& vertices, const Eigen::Vector3d& low,
                        const Eigen::Vector3d& high, double top_at_low_x) {
    for (const double x : {low.x(), high.x()})
      for (const double y : {low.y(), high.y()})
        for (const double z : {low.z(), x == low.x() ? top_at_low_x : high.z()})
          obj << "v " << x << " " << y << " " << z << "\n";
    for (const auto& face :
         {std::array{1, 2, 4, 3}, {5, 7, 8, 6}, {1, 5, 6, 2}, {3, 4, 8, 7}, {1, 3, 7, 5}, {2, 6, 8, 4}}) {
      obj << "f";
      for (const int corner : face) obj << " " << vertices + corner;
      obj << "\n";
    }
    vertices += 8;
  }

  /// Wires of a millimetre stand in a row across a room: beams pass them by, and bodies do not.
  [[nodiscard]] std::string wires() const {
    std::ostringstream obj;
    int vertices = 0;
    const auto add_box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
      add_prism(obj, vertices, low, high, high.z());
    };
    add_box({-4.0, -2.5, 0.0}, {4.0, 2.5, 3.0});
    for (double y = -2.2; y < 2.4; y += 0.6) add_box({0.3, y, 0.0}, {0.301, y + 0.001, 3.0});
    return write("wires.obj", obj.str());
  }
  /// A UAV's file, with four scans a second.
  [[nodiscard]] std::string slow_camera() const {
    return write("robot.json", R"({"name": "uav", "motion": "space", "body": {"kind": "box",
    "size_m": [0.7, 0.7, 0.5]}, "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72,
    "range_m": 6, "columns": 32, "rows": 24, "rate_hz": 4}})");
  }

 private:
  // events.csv and the recording tell the same times, also of plannings before the run was resumed.
  void expect_planning_times(const std::string& output) const {
    const planner::Recording recording = planner::read_recording(path(output + "/run.frontlux"));
    const Table events(path(output + "/events.csv"));
    for (std::size_t i = 0; i < events.size(); ++i)
      EXPECT_EQ(events.number(i, "planning_s"), recording.steps.at(i + 1).step.planning_seconds())
          << output << ", step " << i + 1;
  }
};

}  // namespace frontlux::test
