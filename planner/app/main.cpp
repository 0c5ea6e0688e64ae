#include "bad_input.hpp"
#include "commands/commands.hpp"
#include "interrupt.hpp"

#include <frontlux/machine.hpp>

#include <CLI/CLI.hpp>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <fcntl.h>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <unistd.h>
#include <utility>

namespace {

constexpr int kBadInput = 2, kFailure = 1, kInterrupted = 128 + 2;

// "--range METRES   Longest distance to a voxel's centre [10]", or "(required)".
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0 || option->get_type_name().empty()) return "";
    return " " + option->get_type_name();
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    if (option->get_required()) return option->get_description() + " (required)";
    const std::string value = option->get_default_str();
    return option->get_description() + (value.empty() ? "" : " [" + value + "]");
  }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
    for (std::size_t gap; (gap = help.find("\n\n\n")) != std::string::npos;) help.erase(gap, 1);
    return help;
  }
};

int complain(const std::string& message, int code) {
  std::cerr << "frontlux: " << message << '\n';
  return code;
}

// What is wrong with the words. CLI11 would rather name the option that a misspelt one leaves missing.
std::string describe(const CLI::ParseError& error, const CLI::App& app) {
  const auto strays = app.remaining(true);
  const auto commands = app.get_subcommands();
  if (strays.empty() && commands.empty()) return "give a command";
  if (strays.empty()) {
    const bool both = dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr;
    return error.what() + std::string(both ? "; give only one of them" : "");
  }
  const std::string& stray = strays.front();
  const char* kind = stray.starts_with("-") ? "unknown option '"
                     : commands.empty()     ? "unknown command '"
                                            : "unexpected argument '";
  return kind + stray + "'";
}

// What a wrong FRONTLUX_ISA makes of every command.
std::string instructions() {
  try {
    return frontlux::instruction_set_name();
  } catch (const std::runtime_error& error) {
    throw frontlux::app::BadInput(error.what());
  }
}

// Else the first file that is opened becomes the stream that came closed, and gets what is printed.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF && ::open("/dev/null", O_RDWR) != stream)
      std::_Exit(kFailure);
}

int run(int argc, const char* const* argv) {
  const std::string version =
      std::string("frontlux ").append(FRONTLUX_VERSION) + ", vector instructions: " + instructions();
  CLI::App app("Cast rays in OctoMap maps, make such maps, and let simulated robots explore.");
  app.name("frontlux");
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->label("SUBCOMMAND", "COMMAND");
  formatter->label("Positionals", "Arguments");
  app.formatter(formatter);
  app.set_version_flag("--version", version, "Print the version, and the vector instructions in use");
  app.set_help_flag("-h,--help", "Print this help");
  app.require_subcommand(1);
  app.footer(R"(Examples:
  frontlux info building.bt
  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10
  frontlux world station --seed 3 -o station.ply
  frontlux scan station --seed 3 -o station.bt
  frontlux explore station --seed 3 -o station_run
Run frontlux COMMAND --help for the options of a command. Lengths are in metres, angles in radians.
Exit codes: 0 success, 2 unusable input, 130 stopped by Ctrl-C, 1 any other failure.)");
  using namespace frontlux::app;
  for (const auto add :
       {add_info_command, add_cast_command, add_world_command, add_scan_command, add_map_command,
        add_plan_command, add_render_command, add_explore_command, add_report_command})
    add(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    app.exit(wish);
  } catch (const CLI::ParseError& error) {
    const auto commands = app.get_subcommands();
    const std::string command = commands.empty() ? "" : commands.front()->get_name() + " ";
    return complain(describe(error, app) + "; see frontlux " + command + "--help", kBadInput);
  }
  if (!std::cout.flush()) return complain("standard output cannot be written to", kFailure);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit fails, as on a full disk
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
    return complain("unknown error", kFailure);
  }
}
