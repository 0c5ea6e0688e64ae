#include "bad_input.hpp"
#include "commands/commands.hpp"
#include "help.hpp"
#include "interrupt.hpp"
#include "terminal.hpp"

#include <frontlux/io/spelling.hpp>
#include <frontlux/machine.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <fcntl.h>
#include <iostream>
#include <iterator>
#include <memory>
#include <new>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace {

constexpr int kBadInput = 2, kFailure = 1;

int complain(const std::string& message, int code) {
  std::cerr << frontlux::app::in_red("frontlux: " + frontlux::app::on_one_line(message), STDERR_FILENO)
            << '\n';
  return code;
}

// " (did you mean --seed?)", if that can be told.
std::string suggestion(const std::string& misspelt, const std::vector<std::string>& words) {
  const auto meant = frontlux::io::meant_by(misspelt, words);
  return meant ? " (did you mean " + *meant + "?)" : "";
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names{"help"};
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string unknown_command(const std::string& name, const CLI::App& app) {
  return "unknown command '" + name + "'" + suggestion(name, command_names(app));
}

// What is wrong with the words. CLI11 would rather name the option that a misspelt one leaves missing.
std::string describe(const CLI::ParseError& error, const CLI::App& app) {
  const auto strays = app.remaining(true);
  const auto commands = app.get_subcommands();
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
    return error.what() + std::string("; give true or false");  // all but flags are read by ourselves
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && strays.empty()) {
    const std::string what = error.what();
    return what + (what.find("At Most 1") != std::string::npos ? "; give the option once" : "");
  }
  if (strays.empty() && commands.empty()) return "give a command";
  if (strays.empty()) {
    const bool both = dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr;
    return error.what() + std::string(both ? "; give only one of them" : "");
  }
  const std::string& stray = strays.front();
  if (stray.starts_with("-")) {
    const std::string name = stray.substr(0, stray.find('='));
    return "unknown option '" + stray + "'" +
           suggestion(name, frontlux::app::option_names(commands.empty() ? app : *commands.front()));
  }
  return commands.empty() ? unknown_command(stray, app) : "unexpected argument '" + stray + "'";
}

// What a wrong FRONTLUX_ISA makes of every command.
std::string instructions() {
  try {
    return frontlux::instruction_set_name();
  } catch (const std::runtime_error& error) {
    throw frontlux::app::BadInput(error.what());
  }
}

// Else the first file that is opened becomes the stream that came closed, and gets what is printed. Writing
// to a standard output that came closed fails all the same.
void open_standard_streams() {
  for (const auto& [stream, how] :
       {std::pair(STDIN_FILENO, O_RDONLY), {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF && ::open("/dev/null", how) != stream)
      std::_Exit(kFailure);
}

void prepare_process() {
  open_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit fails, as on a full disk
  std::signal(SIGPIPE, SIG_IGN);  // so does one to a pipe that nobody reads any more
}

// Before the libraries begin: Debian 13's Ipopt starts MPI when it is loaded, which opens files, and writes
// to them.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
[[gnu::section(".preinit_array"), gnu::used]] void (*const kBeforeLibraries)() = &prepare_process;
#endif

int run(int argc, const char* const* argv) {
  const std::string version =
      std::string("frontlux ").append(FRONTLUX_VERSION) + ", vector instructions: " + instructions();
  CLI::App app("Cast rays in OctoMap maps, make such maps, and let simulated robots explore.");
  app.name("frontlux");
  const auto formatter = std::make_shared<frontlux::app::HelpFormatter>();
  formatter->label("SUBCOMMAND", "COMMAND");
  formatter->label("Positionals", "Arguments");
  app.formatter(formatter);
  app.set_version_flag("-V,--version", version, "Print the version, and the vector instructions in use");
  app.set_help_flag("-h,--help", "Print this help");
  app.set_help_all_flag("--help-all", "Print help with the rare options too");
  formatter->hide(app.add_option(
                         "--manual",
                         [&app](const CLI::results_t& words) -> bool {
                           frontlux::app::check_name("--manual", words.front(), "DIR");
                           frontlux::app::write_manual(app, words.front());
                           throw CLI::Success();
                         },
                         "Write man pages and a completion of commands for bash into this folder")
                      ->type_name("DIR"));
  app.require_subcommand(1);
  app.footer(R"(Examples:
  frontlux info building.bt
  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10
  frontlux world station --seed 3 -o station.ply
  frontlux scan station --seed 3 -o station.bt
  frontlux explore station --seed 3 -o station_run
frontlux help COMMAND, or frontlux COMMAND --help, prints the options of a command; --help-all adds the rare ones.
Lengths are in metres, angles on the command line and in tables in radians, in task and robot files in degrees.
Exit codes: 0 success, 2 unusable input, 130 stopped by Ctrl-C or SIGTERM, 1 any other failure. An exploration that
ended by itself has success even if it ended badly: see "warnings" in its run.json.)");
  using namespace frontlux::app;
  for (const auto add :
       {add_info_command, add_cast_command, add_world_command, add_scan_command, add_map_command,
        add_plan_command, add_render_command, add_explore_command, add_report_command})
    add(app);
  // CLI11 takes the last word first.
  std::vector<std::string> words(std::reverse_iterator(argv + argc),
                                 std::reverse_iterator(argv + std::min(argc, 1)));
  // It would take the word behind `--team=` for its value.
  for (auto word = words.begin(); word != words.end(); ++word)
    if (word->size() > 3 && word->starts_with("--") && word->find('=') == word->size() - 1) {
      word->pop_back();
      word = words.insert(word, "") + 1;
    }
  if (!words.empty() && words.back() == "help") {
    words.back() = "--help";
    if (words.size() > 1) {
      const std::string& command = words[words.size() - 2];
      const auto names = command_names(app);
      if (std::find(names.begin(), names.end(), command) == names.end())
        return complain(unknown_command(command, app) + "; see frontlux --help", kBadInput);
      std::swap(words[words.size() - 1], words[words.size() - 2]);
    }
  }
  try {
    app.parse(words);
  } catch (const CLI::Success& wish) {  // --help, --version
    app.exit(wish);
  } catch (const CLI::ParseError& error) {
    const auto commands = app.get_subcommands();
    const std::string command = commands.empty() ? "" : commands.front()->get_name() + " ";
    return complain(describe(error, app) + "; see frontlux " + command + "--help", kBadInput);
  }
  if (!std::cout.flush())
    return complain(std::string("standard output ") +
                        (is_open_to_write(STDOUT_FILENO) ? "cannot be written to" : "is closed"),
                    kFailure);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  prepare_process();
  frontlux::app::end_at_interrupts();
  try {
    return run(argc, argv);
  } catch (const frontlux::app::BadInput& error) {
    return complain(error.what(), kBadInput);
  } catch (const frontlux::app::Interrupted& stop) {
    return complain(stop.what(), frontlux::app::kInterruptedCode);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory", kFailure);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailure);
  } catch (...) {
    return complain("unknown error", kFailure);
  }
}
