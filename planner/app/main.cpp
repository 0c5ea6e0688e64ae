#include "bad_input.hpp"
#include "commands/cast_command.hpp"
#include "commands/explore_command.hpp"
#include "commands/info_command.hpp"
#include "explore/interrupt.hpp"
#include "commands/map_command.hpp"
#include "commands/plan_command.hpp"
#include "commands/render_command.hpp"
#include "commands/report_command.hpp"
#include "commands/scan_command.hpp"
#include "commands/world_command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr int kBadInput = 2, kFailure = 1, kInterrupted = 128 + 2;

// CLI11 takes "-.5,1,2" and "-inf" for options of their own: bind such words to the option before them.
std::vector<std::string> words_of(int argc, const char* const* argv) {
  constexpr std::array<std::string_view, 25> kNumeric = {
      "--from",   "--to",         "--direction",    "--range",  "--start",   "--ground",     "--scale",
      "--seed",   "--resolution", "--bounds",       "--at",     "--yaw",     "--iterations", "--min-height",
      "--floor",  "--noise",      "--dropout",      "--sweep",  "--epsilon", "--max-steps",  "--threads",
      "--lambda", "--advance",    "--min-distance", "--samples"};
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool bound = !words.empty() && word.size() > 1 && word[0] == '-' && word[1] != '-' &&
                       std::find(kNumeric.begin(), kNumeric.end(), words.back()) != kNumeric.end();
    if (bound)
      words.back().append("=").append(word);
    else
      words.emplace_back(word);
  }
  return words;
}

int complain(const std::string& message, int code) {
  std::cerr << "frontlux: " << message << '\n';
  return code;
}

int run(int argc, const char* const* argv) {
  CLI::App app("Makes OctoMap maps, asks what can be seen in them, and lets robots explore.");
  app.name("frontlux");
  app.set_version_flag("--version", std::string("frontlux ") + FRONTLUX_VERSION, "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  frontlux info building.bt\n"
      "  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10\n"
      "  frontlux world station --seed 3 -o station.ply\n"
      "  frontlux scan station --seed 3 -o station.bt\n"
      "  frontlux explore station --seed 3 -o station_run\n"
      "Each command's --help says more. Lengths are in metres. Exit code: 0 if the question was answered,\n"
      "2 if the input was not usable, 130 after Ctrl-C, 1 if anything else went wrong.");
  frontlux::app::add_info_command(app);
  frontlux::app::add_cast_command(app);
  frontlux::app::add_world_command(app);
  frontlux::app::add_scan_command(app);
  frontlux::app::add_map_command(app);
  frontlux::app::add_plan_command(app);
  frontlux::app::add_render_command(app);
  frontlux::app::add_explore_command(app);
  frontlux::app::add_report_command(app);
  try {
    auto words = words_of(argc, argv);
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    app.parse(std::move(words));
  } catch (const CLI::Success& wish) {  // --help, --version
    app.exit(wish);
  } catch (const CLI::ParseError& error) {
    // CLI11 would rather name the option that a misspelt one leaves missing.
    const auto strange = app.remaining(true);
    const std::string what =
        strange.empty() ? error.what() : "'" + strange.front() + "' is no option or command that fits here";
    return complain(what + "; see frontlux --help", kBadInput);
  }
  if (!std::cout.flush()) return complain("standard output cannot be written to", kFailure);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const frontlux::app::BadInput& error) {
    return complain(error.what(), kBadInput);
  } catch (const frontlux::app::Interrupted& stop) {
    return complain(stop.what(), kInterrupted);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory", kFailure);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailure);
  } catch (...) {
    return complain("something unknown went wrong", kFailure);
  }
}
