// For the test in a browser, and for looks: make_report FOLDER STEPS [NAME=][+]WORLD... explores the worlds
// and writes FOLDER/report.html of all runs, and of each, from 0, FOLDER/<number>/run.frontlux and the
// columns of a steps.csv that follow from it. A + is for the UAV alone. A name goes wherever a name can go.
#include "report/explored_run.hpp"

#include <frontlux/report/report.hpp>

#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

using frontlux::planner::Recording;

void write_numbers(const std::filesystem::path& file, const Recording& recording) {
  const auto& head = recording.head;
  std::ofstream out(file);
  out.precision(17);
  out << "step,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,"
         "abandoned,"
         "length_m,travelled_m,gain_predicted,gained,frontiers_s,caster_s,goals_s,paths_s,optimization_s,"
         "planning_s\n";
  std::vector<double> travelled(head.robots.size());
  for (const auto& [step, known, collisions] : recording.steps) {
    std::uint64_t observable = 0, bounding = 0;
    for (const auto& part : known) {
      observable += part.observable;
      bounding += part.bounding;
    }
    const auto of = [](std::uint64_t part, std::uint64_t all) {
      return static_cast<double>(part) / static_cast<double>(all);
    };
    for (std::size_t r = 0; r < head.robots.size(); ++r) {
      const auto& robot = step.robots[r];
      travelled[r] += robot.length;
      out << step.number << ',' << head.robots[r].robot.name << ',' << of(observable, head.observable) << ','
          << of(bounding, head.bounding) << ',' << of(known[r].observable, head.observable) << ','
          << of(known[r].bounding, head.bounding) << ',' << step.frontiers << ',' << step.unassigned << ','
          << step.abandoned << ',' << robot.length << ',' << travelled[r] << ',' << robot.gain_predicted
          << ',' << robot.gained;
      for (std::size_t phase = 0; phase + 1 < step.seconds.size(); ++phase) out << ',' << step.seconds[phase];
      out << ',' << step.planning_seconds() << '\n';
    }
  }
}

void record(const std::filesystem::path& folder, const Recording& recording) {
  std::filesystem::create_directories(folder);
  frontlux::planner::RecordingWriter writer(folder / "run.frontlux", recording.head);
  for (const auto& step : recording.steps) writer.write(step);
  writer.write_end(*recording.end);
  write_numbers(folder / "steps.csv", recording);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return EXIT_FAILURE;
  const std::filesystem::path folder = argv[1];
  std::deque<Recording> recordings;
  std::deque<std::string> names;
  std::vector<frontlux::report::ReportedRun> runs;
  for (int i = 3; i < argc; ++i) {
    std::string world = argv[i];
    const std::size_t split = world.rfind('=');
    const bool named = split != std::string::npos;
    std::string name = named ? world.substr(0, split) : world;
    if (named) world.erase(0, split + 1);
    const bool alone = world[0] == '+';
    if (alone) world.erase(0, 1);
    recordings.push_back(frontlux::test::explored_run(world, std::stoi(argv[2]), alone));
    if (named) {
      recordings.back().head.world = name;
      for (auto& description : recordings.back().head.robots) description.robot.name = name;
    }
    record(folder / std::to_string(i - 3), recordings.back());
    names.push_back(std::move(name));
    runs.push_back({names.back(), &recordings.back()});
  }
  frontlux::report::write_report(folder / "report.html", runs, "0.1.0");
}
