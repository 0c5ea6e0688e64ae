// Writes a report of a made-up run: make_report WORLD STEPS FILE [NAME...]. For looks, not for truth.
#include "made_up_run.hpp"

#include <frontlux/report/report.hpp>

#include <cstdlib>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 4) return EXIT_FAILURE;
  const auto recording = frontlux::test::made_up_run(argv[1], std::stoi(argv[2]));
  std::vector<frontlux::report::ReportedRun> runs = {{argv[1], &recording}};
  for (int i = 4; i < argc; ++i) runs.push_back({argv[i], &recording});
  frontlux::report::write_report(argv[3], runs, "0.1.0");
}
