// How good the paths of recorded robots were, in hindsight: against the shortest tour through the same stops
// when the map is known, and how much of them led to where the robot had been.

#include "options.hpp"
#include "table.hpp"
#include "tours/hindsight_tour.hpp"
#include "tours/recorded_paths.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/recorded_map.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/path_revisits.hpp>

#include <filesystem>
#include <iostream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

double revisited_part(std::span<const Eigen::Vector3d> places) {
  sim::PathRevisits path(places.front());
  for (const Eigen::Vector3d& place : places) path.go_to(place);
  return path.share();
}

void add_rows(Table& table, const std::filesystem::path& run) {
  const planner::Recording recording = planner::read_recording(run / "run.frontlux");
  const std::vector<RecordedPath> paths = recorded_paths(recording, run / "events.csv");
  planner::RecordedMap map(recording.head.resolution);
  for (const planner::RecordedStep& step : recording.steps) map.apply(step);
  for (std::size_t r = 0; r < paths.size(); ++r) {
    const planner::Robot& robot = recording.head.robots[r].robot;
    const auto& [places, stops] = paths[r];
    const HindsightTour tour = hindsight_tour(robot.travel, map.grid(), recording.head.bounds, places, stops);
    double length = 0.0;
    for (const planner::RecordedStep& step : recording.steps) length += step.step.robots[r].length;
    table.add_row({run.string(), robot.name, format("%.1f", length), std::to_string(tour.cells.size() - 1),
                   format("%.1f", tour.in_order), format("%.1f", tour.length),
                   tour.length > 0.0 ? format("%.2f", length / tour.length) : "-",
                   format("%.3f", revisited_part(places))});
  }
}

}  // namespace

int run(int argc, char** argv) {
  const ToursOptions options = read_tours_options(argc, argv);
  Table table;
  table.add_columns(
      "", {"run", "robot", "path [m]", "stops", "in order [m]", "hindsight [m]", "ratio", "revisited"});
  for (const std::filesystem::path& run : options.runs) {
    try {
      add_rows(table, run);
    } catch (const std::invalid_argument& error) {
      fail(run / "run.frontlux", error.what(), "explore anew");
    }
  }
  std::cout << table.text();
  return 0;
}

}  // namespace frontlux::bench
