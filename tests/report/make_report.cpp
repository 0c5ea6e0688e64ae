// Writes a report, for looks: make_report FILE STEPS WORLD...; a world with a + in front is for the UAV
// alone.
#include "explored_run.hpp"

#include <frontlux/report/report.hpp>

#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 4) return EXIT_FAILURE;
  std::deque<frontlux::planner::Recording> recordings;
  std::vector<frontlux::report::ReportedRun> runs;
  for (int i = 3; i < argc; ++i) {
    const std::string world = argv[i];
    const bool alone = world[0] == '+';
    recordings.push_back(
        frontlux::test::explored_run(alone ? world.substr(1) : world, std::stoi(argv[2]), alone));
    runs.push_back({alone ? "uav alone" : "team", &recordings.back()});
  }
  frontlux::report::write_report(argv[1], runs, "0.1.0");
}
