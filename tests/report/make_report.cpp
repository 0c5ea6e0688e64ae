// For the test in a browser, and for looks: make_report FOLDER STEPS [NAME=][+]WORLD[/PIECES]... explores the
// worlds and writes FOLDER/report.html of all runs, and of each, from 0, FOLDER/<number>/run.frontlux and the
// columns of a steps.csv that follow from it. A + is for the UAV alone. A name goes wherever a name can go.
// Each step but the first is cut into so many pieces, as if robots had been in motion.
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
  out << "step,time_s,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,"
         "abandoned,"
         "length_m,travelled_m,gain_predicted,gained,frontiers_s,caster_s,goals_s,paths_s,optimization_s,"
         "planning_s\n";
  std::vector<double> travelled(head.robots.size());
  for (const auto& [step, known, contacts] : recording.steps) {
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
      out << step.number << ',' << step.time << ',' << head.robots[r].robot.name << ','
          << of(observable, head.observable) << ',' << of(bounding, head.bounding) << ','
          << of(known[r].observable, head.observable) << ',' << of(known[r].bounding, head.bounding) << ','
          << step.frontiers << ',' << step.unassigned << ',' << step.abandoned << ',' << robot.length << ','
          << travelled[r] << ',' << robot.gain_predicted << ',' << robot.gained;
      for (std::size_t phase = 0; phase + 1 < step.seconds.size(); ++phase) out << ',' << step.seconds[phase];
      out << ',' << step.planning_seconds() << '\n';
    }
  }
}

// Of `pieces` parts of a list, the one with this number.
template <class Element>
std::vector<Element> part_of(const std::vector<Element>& list, std::size_t piece, std::size_t pieces) {
  const auto at = [&](std::size_t p) {
    return list.begin() + static_cast<std::ptrdiff_t>(list.size() * p / pieces);
  };
  return {at(piece), at(piece + 1)};
}

// Each robot plans in every other piece, and takes the voxels that count as known in the order of their keys.
Recording in_pieces(const Recording& recording, std::size_t pieces) {
  Recording cut = recording;
  cut.steps = {recording.steps.front()};
  cut.head.options = R"({"lockstep": false})";
  for (std::size_t s = 1; s < recording.steps.size(); ++s)
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const auto& before = recording.steps[s - 1];
      auto recorded = recording.steps[s];
      auto& step = recorded.step;
      const double done = static_cast<double>(piece + 1) / static_cast<double>(pieces);
      step.number = cut.steps.size();
      step.time = before.step.time + done * (step.time - before.step.time);
      for (double& seconds : step.seconds) seconds /= static_cast<double>(pieces);
      for (std::size_t r = 0; r < step.robots.size(); ++r) {
        auto& robot = step.robots[r];
        const bool plans = piece % step.robots.size() == r;
        robot.planned.resize(robot.travelled);
        robot.planned = part_of(robot.planned, piece, pieces);
        robot.travelled = robot.planned.size();
        robot.length /= static_cast<double>(pieces);
        robot.changed = part_of(robot.changed, piece, pieces);
        if (!plans) {
          robot.path = frontlux::planner::PathOutcome::kInPlace;
          robot.gain_predicted = 0;
          robot.image.clear();
        }
        const auto between = [&](std::uint64_t from, std::uint64_t to) {
          return from + static_cast<std::uint64_t>(done * static_cast<double>(to - from));
        };
        auto& known = recorded.known[r];
        known = {between(before.known[r].observable, known.observable),
                 between(before.known[r].bounding, known.bounding)};
      }
      cut.steps.push_back(std::move(recorded));
    }
  return cut;
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
    const std::size_t slash = world.find('/');
    recordings.push_back(frontlux::test::explored_run(world.substr(0, slash), std::stoi(argv[2]), alone));
    if (slash != std::string::npos)
      recordings.back() = in_pieces(recordings.back(), std::stoul(world.substr(slash + 1)));
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
